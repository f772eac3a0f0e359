"""Files that a domain includes belong to it: names, mistakes and renames reach them, open or not."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.editor.colours import colours
from cleancli.editor.completion import completions
from cleancli.editor.context import open_string
from cleancli.editor.hover import hover
from cleancli.editor.library import Document, Library, document
from cleancli.editor.mistakes import mistakes
from cleancli.editor.navigation import CannotRename, definition, references, rename
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.text_edit import apply_edits
from support.editor_texts import DOMAIN, PROBLEM

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


@pytest.mark.parametrize("include_outside", [None, False, True])
def test_a_file_from_outside_is_renamed_only_where_that_is_allowed(
    include_outside: bool | None, tmp_path: Path
) -> None:
    files = library(tmp_path)
    top = tmp_path / "top" / "tables.nid"
    top.parent.mkdir()
    top.write_text(TABLES.replace("base.nid", "../base.nid"), encoding="utf-8")
    files = Library() if include_outside is None else Library(include_outside=include_outside)
    asked = held(files, top)
    offset = asked.source.text.index("near(")
    assert [found.code for found in mistakes(asked, files)] == ([] if include_outside else ["E109"])
    if include_outside:
        assert str(tmp_path / "base.nid") in rename(asked, offset, "beside", files)
    else:
        with pytest.raises(CannotRename, match="not declared"):
            rename(asked, offset, "beside", files)


def test_a_rename_edits_a_file_that_two_others_include_once(tmp_path: Path) -> None:
    files = library(tmp_path)
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "base.nid").write_text(BASE, encoding="utf-8")
    for name in ("left", "right"):
        text = f'domain {name} {{ include "sub/../sub/base.nid" }}'
        (tmp_path / f"{name}.nid").write_text(text, encoding="utf-8")
    text = TABLES.replace('include "base.nid"', 'include "left.nid" include "right.nid"')
    (tmp_path / "tables.nid").write_text(text, encoding="utf-8")
    far, below = held(files, tmp_path / "tables.nid"), held(files, tmp_path / "sub" / "base.nid")
    edits = rename(far, text.index("near("), "beside", files)
    assert rename(below, BASE.index("near("), "beside", Library({}, (tmp_path,))).keys() == edits.keys()
    assert {path: len(done) for path, done in edits.items()} == {
        str(tmp_path / "sub" / "base.nid"): 1,
        str(tmp_path / "tables.nid"): 1,
        str(tmp_path / "two.nid"): 1,
    }


@pytest.mark.parametrize(
    ("typed", "inside"),
    [
        ('include "', ("include", "")),
        ('domain d { include "a#b/', ("include", "a#b/")),
        ('include # "no"\n "x', ("include", "x")),
        ('# include "a', None),
        ('include "a"', None),
        ('include "a\n', None),
        ('"', ("", "")),
    ],
)
def test_whether_a_string_is_open(typed: str, inside: tuple[str, str] | None) -> None:
    assert open_string(typed) == inside


def test_words_in_a_path_are_no_names() -> None:
    text = 'domain base {\n  include "base.nid"\n}\n'
    asked = document(Source("/nowhere/base.nid", text))
    found = [(text[c.start : c.end], c.type) for c in colours(asked, Library())]
    assert found == [
        ("domain", "keyword"),
        ("base", "namespace"),
        ("include", "keyword"),
        ('"base.nid"', "string"),
    ]
    for offset in range(text.index('"base') + 1, text.index('.nid"')):
        assert not [c for c in completions(asked, offset, Library()) if c.kind is None]


def test_nothing_is_offered_behind_a_slash() -> None:
    text = "domain d {\n  rule r: a() { then 1/"
    assert completions(document(Source("/nowhere/d.nid", text)), len(text), Library()) == ()


def test_a_domain_does_not_include_itself(tmp_path: Path) -> None:
    files = library(tmp_path)
    asked = held(files, tmp_path / "tables.nid")
    assert [each.path.name for each in files.included(asked)] == ["base.nid"]
    assert files.included(held(files, tmp_path / "base.nid")) == ()
    (tmp_path / "base.nid").write_text(BASE.replace("{\n", '{\n  include "tables.nid"\n', 1))
    files = Library({})
    assert [each.path.name for each in files.included(held(files, tmp_path / "tables.nid"))] == ["base.nid"]
