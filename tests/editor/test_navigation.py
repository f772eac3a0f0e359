"""Going to declarations and uses, and renaming, across a domain and its problems."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.editor.hover import hover
from cleancli.editor.library import Library
from cleancli.editor.mistakes import mistakes
from cleancli.editor.navigation import CannotRename, definition, references, rename
from cleancli.language.diagnostics.text_edit import apply_edits
from support.editor_texts import DOMAIN, FOLDER, OPEN, PROBLEM, at, opened

TABLES, TWO = str(FOLDER / "tables.nid"), str(FOLDER / "two.nid")


@pytest.mark.parametrize(
    ("name", "mark", "target", "declaration"),
    [
        ("two.nid", "|near(a1", "tables.nid", "|near(?a ?b"),
        ("two.nid", "size(a1) = |small", "tables.nid", "size(?a - area): |small"),
        ("two.nid", "weight(a1) = |small", "tables.nid", "weight(?a - area): |small"),
        ("two.nid", "near(|a1", "two.nid", "{ |a1"),
        ("two.nid", "= |tables", "tables.nid", "domain |tables"),
        ("two.nid", "- |area", "tables.nid", "|area - place"),
        ("little.nid", "= |tables", "tables.nid", "domain |tables"),
        (
            "tables.nid",
            "size(?x) = small\n    then 0.65 [prior 0.6, seen 14]: not dirt(|?x",
            "tables.nid",
            "|?x)",
        ),
        ("tables.nid", "decrease(|dirty", "tables.nid", "|dirty_areas :="),
        ("tables.nid", "rule join_two: |join", "tables.nid", "|join(?a ?b"),
    ],
)
def test_definition(name: str, mark: str, target: str, declaration: str) -> None:
    asked, offset = at(name, mark)
    span = definition(asked, offset, OPEN)
    place, start = at(target, declaration)
    assert span is not None
    assert (span.path, span.start) == (place.source.path, start)


def test_references_with_and_without_the_declaration() -> None:
    asked, offset = at("tables.nid", "|near(?a ?b")
    spans = references(asked, offset, OPEN)
    assert [span.path for span in spans] == [TABLES, TABLES, TWO]
    assert len(references(asked, offset, OPEN, declaration=False)) == 2


@pytest.mark.parametrize(
    ("name", "mark", "new", "sizes"),
    [
        ("two.nid", "|near(a1", "beside", {TABLES: 2, TWO: 1}),
        ("tables.nid", "size(?x) = |small", "tiny", {TABLES: 2, TWO: 1}),
        ("tables.nid", "|bin -", "sink", {TABLES: 2, TWO: 1}),
        ("two.nid", "near(|a1", "a9", {TWO: 6}),
        ("two.nid", "- |area", "spot", {TABLES: 9, TWO: 1}),
        ("tables.nid", "push(|?x)", "?y", {TABLES: 6}),
        ("tables.nid", "push(|?x)", "y", {TABLES: 6}),
        ("tables.nid", "rule |join_two", "join_both", {TABLES: 1}),
        ("tables.nid", "decrease(|dirty", "how_much", {TABLES: 2, TWO: 1}),
    ],
)
def test_what_is_renamed_still_means_the_same(name: str, mark: str, new: str, sizes: dict[str, int]) -> None:
    asked, offset = at(name, mark)
    edits = rename(asked, offset, new, OPEN)
    assert {path: len(changes) for path, changes in edits.items()} == sizes
    texts = {path: apply_edits(text, edits.get(path, ())) for path, text in OPEN.open.items()}
    renamed = Library(texts)
    for path in texts:
        document = renamed.document(path)
        assert document is not None
        assert mistakes(document, renamed) == ()
        old = OPEN.document(path)
        assert old is not None
        assert len(document.names) == len(old.names)


@pytest.mark.parametrize(
    ("name", "mark", "new", "reason"),
    [
        ("two.nid", "|near(a1", "dirt", "already a symbol `dirt`"),
        ("two.nid", "|near(a1", "dirty_areas", "already a count `dirty_areas`"),
        ("tables.nid", "push(|?x)", "?m", "already a variable `m`"),
        ("tables.nid", "size(?x) = |small", "big", "already a value `big`"),
        ("tables.nid", "|bin -", "a1", "already an object `a1`"),
        ("two.nid", "near(|a1", "bin", "already an object `bin`"),
        ("two.nid", "|near(a1", "when", "word of the language"),
        ("two.nid", "|near(a1", "2b", "no name"),
        ("two.nid", "|near(a1", "?b", "no name"),
        ("two.nid", "= |tables", "desks", "only what"),
        ("little.nid", "|width", "breadth", "only what"),
    ],
)
def test_renames_that_would_spoil_a_text_are_refused(name: str, mark: str, new: str, reason: str) -> None:
    asked, offset = at(name, mark)
    with pytest.raises(CannotRename, match=reason):
        rename(asked, offset, new, OPEN)


def test_a_value_may_be_called_like_that_of_another_function() -> None:
    asked, offset = at("tables.nid", "size(?x) = |small")
    assert rename(asked, offset, "large", OPEN)


def test_what_is_shipped_is_not_changed_from_a_users_problem(tmp_path: Path) -> None:
    problem = tmp_path / "mine.nid"
    problem.write_text(PROBLEM.replace("= tables", "= cleaning"), encoding="utf-8")
    asked = Library().document(problem)
    assert asked is not None
    with pytest.raises(CannotRename, match="shipped domain `cleaning`"):
        rename(asked, asked.source.text.index("near("), "beside", Library())


def test_an_undeclared_name_leads_nowhere() -> None:
    library = Library({**OPEN.open, TWO: PROBLEM.replace("near(", "nearr(")})
    asked = library.document(TWO)
    assert asked is not None
    offset = asked.source.text.index("nearr")
    assert definition(asked, offset, library) is None
    with pytest.raises(CannotRename, match="not declared"):
        rename(asked, offset, "beside", library)


def test_problems_in_the_editors_folders_are_found(tmp_path: Path) -> None:
    for folder, name, text in (
        ("a", "tables.nid", DOMAIN),
        ("b/c", "two.nid", PROBLEM.replace("tables", "t")),
    ):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / name).write_text(text, encoding="utf-8")
    (tmp_path / "b/c/tables.nid").symlink_to(tmp_path / "a/tables.nid")
    (tmp_path / "a/near_by.nid").write_text(PROBLEM, encoding="utf-8")
    library = Library({}, (tmp_path,))
    domain = library.document(tmp_path / "a/tables.nid")
    assert domain is not None
    assert [user.path.name for user in library.users_of(domain, library.roots)] == ["near_by.nid"]
    assert opened("tables.nid").kind == "domain"


def test_renames_reach_the_editors_folders_and_hover_tells_of_problems_beside_the_domain(
    tmp_path: Path,
) -> None:
    for name in ("a/tables.nid", "a/beside.nid", "b/c/far.nid"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        text = DOMAIN if name == "a/tables.nid" else PROBLEM
        (tmp_path / name).write_text(text, encoding="utf-8")
    opened = {str(tmp_path / "a/tables.nid"): DOMAIN}
    for roots, reached in (((), {"tables", "beside"}), ((tmp_path,), {"tables", "beside", "far"})):
        library = Library(opened, roots)
        domain = library.document(tmp_path / "a/tables.nid")
        assert domain is not None
        assert {Path(path).stem for path in rename(domain, DOMAIN.index("near("), "by", library)} == reached
        told = hover(domain, DOMAIN.index("push_small"), library)
        assert told is not None
        assert "`beside.nid`: " in told.text
        assert "far.nid" not in told.text
