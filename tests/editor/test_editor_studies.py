"""Studies are completed, explained and checked while they are typed: the `|` is the cursor."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.editor.completion import completions
from cleancli.editor.hover import hover
from cleancli.editor.library import Document, Library, document
from cleancli.editor.mistakes import mistakes
from cleancli.editor.symbols import symbols
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.resources import shipped_names
from cleancli.study.schema import AXES, COMPARED, INNER, OF_ROWS, OWN, keys_of

STUDY = """study s {
  scene    = two_groups
  strategy = plan_1, reactive
  part rags { rag { width = 8 cm, 12 cm } }
  compare one { claim = 2  first { strategy = plan_1 } second { strategy = reactive } }
}
"""


def asked(text: str) -> tuple[Document, int]:
    offset = text.index("|")
    return document(Source("s.nid", text.replace("|", "", 1))), offset


def offered(text: str) -> set[str]:
    found, offset = asked(text)
    return {completion.text for completion in completions(found, offset, Library())}


TOP = {*OWN, *AXES, *INNER[""]}


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("study s { |", TOP),
        ("study s { runs = 3 |", TOP),
        ("study s { scene = |", set(shipped_names("problems"))),
        ("study s { scene = two_groups, |", set(shipped_names("problems"))),
        ("study s { studies = |", set(shipped_names("studies"))),
        ("study s { domain = |", set(shipped_names("domains"))),
        (
            "study s { strategy = |",
            {"plan_1", "plan_2", "plan_3", "plan_all", "determinized", "explore", "reactive", "wipe", "tsp"},
        ),
        ("study s { estimator = none, |", {"none", "decreasing_m", "m", "fitted_m", "likelihood"}),
        ("study s { simulator = |", {"physics", "stand_in"}),
        ("study s { rag { |", {"width", "grasp"}),
        ("study s { rag { width = 8 cm, 12 |", {"cm", "mm", "m", "width", "grasp"}),
        ("study s { robot { drive = gantry, |", {"gantry", "wam", "reem"}),
        ("study s { part one { |", {*AXES, *INNER["part"]}),
        ("study s { part one { rag { |", {"width", "grasp"}),
        ("study s { part one { } compare two { |", {*COMPARED, *AXES, *OF_ROWS, *INNER["compare"], "part"}),
        ("study s { compare two { first { |", {*keys_of("first"), *INNER["first"]}),
        ("study s { part one { } part two { } compare three { part = |", {"one", "two"}),
        ("study s { compare two { expect = |", {"less", "more", "equal"}),
        ("study s { camera { at = (0 cm, |", set()),
    ],
)
def test_what_is_offered(typed: str, expected: set[str]) -> None:
    found = offered(typed + " }" * (typed.count("{") - typed.count("}")))
    words = {"part", "compare", "x"}  # of the language: `x` stands between the sides of a picture
    assert found - words == expected - words


@pytest.mark.parametrize(
    ("at", "told"),
    [
        ("scen|e    =", "what is carried out"),
        ("str|ategy = plan_1, r", "`plan_2`"),
        ("wid|th = 8", "the rag's width"),
        ("cla|im", "the paper's claim"),
        ("first { str|ategy", "who decides"),
    ],
)
def test_what_a_key_means_is_told(at: str, told: str) -> None:
    text = STUDY.replace(at.replace("|", ""), at, 1)
    found, offset = asked(text)
    shown = hover(found, offset, Library())
    assert shown is not None
    assert told in shown.text


def test_mistakes_are_told_and_a_study_without_any_has_none() -> None:
    assert mistakes(document(Source("s.nid", STUDY)), Library()) == ()
    wrong = document(Source("s.nid", STUDY.replace("strategy = reactive", "strategy = wipe")))
    assert [found.code for found in mistakes(wrong, Library())] == ["E521"]


def test_the_outline_lists_its_sections() -> None:
    (entry,) = symbols(document(Source("s.nid", STUDY)))
    assert (entry.name, entry.detail) == ("s", "study")
    assert [inner.name for inner in entry.entries] == ["part", "compare"]


def test_files_beside_a_study_are_offered(tmp_path: Path) -> None:
    (tmp_path / "own_table.nid").write_text("scene own_table { }", encoding="utf-8")
    (tmp_path / "own_rules.nid").write_text("domain own_rules { }", encoding="utf-8")
    text = "study s { scene = | }"
    found = document(Source(str(tmp_path / "s.nid"), text.replace("|", "")))
    names = {completion.text for completion in completions(found, text.index("|"), Library())}
    assert "own_table" in names
    assert "own_rules" not in names
