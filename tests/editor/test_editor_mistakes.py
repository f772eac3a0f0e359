"""An unsaved text is checked like a file, and a problem against the domain as it stands in the editor."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.editor.library import Library, document
from cleancli.editor.mistakes import mistakes
from cleancli.language.diagnostics.diagnostic import Source
from support.editor_texts import DOMAIN, FOLDER, OPEN, PROBLEM, SCENE, SHIPPED, opened


def found(name: str, text: str, library: Library = OPEN) -> list[tuple[str, str]]:
    """Code of each mistake of a text, and what stands at its place."""
    path = str(FOLDER / name)
    asked = document(Source(path, text))
    result = mistakes(asked, Library({**library.open, path: text}))
    return [(d.code, "" if d.span is None else text[d.span.start : d.span.end]) for d in result]


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: p.stem)
def test_shipped_files_have_none(path: Path) -> None:
    asked = Library().document(path)
    assert asked is not None
    assert mistakes(asked, Library()) == ()


def test_open_files_have_none() -> None:
    for name in ("tables.nid", "two.nid", "little.nid"):
        assert mistakes(opened(name), OPEN) == ()


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        (
            "tables.nid",
            DOMAIN.replace("0.9: not", "0.9 not").replace("dirt(?x), size", "dirt(?y), size"),
            [("E204", "?y"), ("E104", "not")],
        ),
        ("two.nid", PROBLEM.replace("dirt(a2)", "dirt(a3)"), [("E205", "a3")]),
        ("two.nid", PROBLEM.replace("= tables", "= tabels"), [("E001", "tabels")]),
        ("two.nid", PROBLEM.replace("domain  = tables", ""), [("E407", "two")]),
        ("little.nid", SCENE.replace("10 cm", "10 s"), [("E503", "10 s")]),
        ("new.nid", "", [("E105", "")]),
        ("new.nid", "domian x {}", [("E105", "domian")]),
    ],
)
def test_mistakes_are_at_their_places(name: str, text: str, expected: list[tuple[str, str]]) -> None:
    assert found(name, text) == expected


def test_a_problem_says_that_its_domain_is_wrong() -> None:
    spoilt = Library({**OPEN.open, str(FOLDER / "tables.nid"): DOMAIN.replace("0.9:", "0.8:")})
    ((code, place),) = found("two.nid", PROBLEM, spoilt)
    assert (code, place) == ("E301", "tables")


def test_open_text_counts_and_not_the_file(tmp_path: Path) -> None:
    (tmp_path / "tables.nid").write_text(DOMAIN, encoding="utf-8")
    (tmp_path / "two.nid").write_text(PROBLEM, encoding="utf-8")
    typed = Library({str(tmp_path / "tables.nid"): DOMAIN.replace("near(", "close(")})
    asked = typed.document(tmp_path / "two.nid")
    assert asked is not None
    assert [d.code for d in mistakes(asked, Library())] == []
    assert [d.code for d in mistakes(asked, typed)] == ["E203"]


def test_a_domain_beside_the_problem_comes_before_the_shipped_one(tmp_path: Path) -> None:
    problem = PROBLEM.replace("= tables", "= cleaning")
    (tmp_path / "two.nid").write_text(problem, encoding="utf-8")
    asked = Library().document(tmp_path / "two.nid")
    assert asked is not None
    shipped = Library().domain_of(asked)
    assert shipped is not None
    assert shipped.path in SHIPPED
    elsewhere = Library({"/elsewhere/cleaning.nid": DOMAIN}).domain_of(asked)
    assert elsewhere is not None
    assert elsewhere.source.path == "/elsewhere/cleaning.nid"
    (tmp_path / "cleaning.nid").write_text(DOMAIN, encoding="utf-8")
    beside = Library({"/elsewhere/cleaning.nid": DOMAIN}).domain_of(asked)
    assert beside is not None
    assert beside.path == tmp_path / "cleaning.nid"
