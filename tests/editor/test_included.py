"""Files that a domain includes belong to it: names, mistakes and renames reach them, open or not."""

from __future__ import annotations

from pathlib import Path

import pytest
from texts import DOMAIN, PROBLEM

from cleancli.editor.hover import hover
from cleancli.editor.library import Document, Library
from cleancli.editor.mistakes import mistakes
from cleancli.editor.navigation import definition, references, rename
from cleancli.language.edit import apply_edits

_START, _END = DOMAIN.index("  types"), DOMAIN.index("  actions")
BASE = "domain base {\n" + DOMAIN[_START:_END] + "}\n"
TABLES = 'domain tables {\n  include "base.nid"\n' + DOMAIN[_END:]


def library(folder: Path, **changed: str) -> Library:
    """The three files on disk, and some of them changed in the editor."""
    for name, text in (("base", BASE), ("tables", TABLES), ("two", PROBLEM)):
        (folder / f"{name}.nid").write_text(text, encoding="utf-8")
    return Library({str(folder / f"{name}.nid"): text for name, text in changed.items()})


def held(files: Library, path: Path) -> Document:
    found = files.document(path)
    assert found is not None
    return found


@pytest.mark.parametrize("name", ["tables.nid", "two.nid"])
def test_what_is_included_is_declared(name: str, tmp_path: Path) -> None:
    files = library(tmp_path)
    assert mistakes(held(files, tmp_path / name), files) == ()


def test_definition_and_hover_lead_into_the_included_file(tmp_path: Path) -> None:
    files = library(tmp_path)
    asked = held(files, tmp_path / "tables.nid")
    offset = TABLES.index("near(")
    target = definition(asked, offset, files)
    assert target is not None
    assert (target.path, target.start) == (str(tmp_path / "base.nid"), BASE.index("near("))
    shown = hover(asked, offset, files)
    assert shown is not None
    assert "side by side" in shown.text


@pytest.mark.parametrize(("name", "text"), [("base", BASE), ("tables", TABLES), ("two", PROBLEM)])
def test_a_rename_reaches_all_files_from_each(name: str, text: str, tmp_path: Path) -> None:
    files = library(tmp_path)
    asked = held(files, tmp_path / f"{name}.nid")
    assert len(references(asked, text.index("near("), files)) == 3
    edits = rename(asked, text.index("near("), "beside", files)
    texts = {path: apply_edits(held(files, Path(path)).source.text, done) for path, done in edits.items()}
    assert {Path(path).name for path in texts} == {"base.nid", "tables.nid", "two.nid"}
    renamed = Library(texts)
    for path in texts:
        if not path.endswith("base.nid"):
            assert mistakes(held(renamed, Path(path)), renamed) == ()


def test_a_mistake_of_an_open_included_file_stands_at_the_include(tmp_path: Path) -> None:
    files = library(tmp_path, base=BASE.replace("near(?a ?b - area)", "near(?a ?b - arae)"))
    found = mistakes(held(files, tmp_path / "tables.nid"), files)
    places = [TABLES[d.span.start : d.span.end] for d in found if d.span is not None]
    assert [d.code for d in found] == ["E201"]
    assert places == ['include "base.nid"']
    assert found[0].message.startswith("in `base.nid`: ")
