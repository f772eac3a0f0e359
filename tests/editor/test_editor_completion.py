"""What is offered while a text is being typed: the `|` is the cursor."""

from __future__ import annotations

import pytest

from cleancli.editor.completion import MARKS, completions
from cleancli.editor.context import context
from support.editor_texts import DOMAIN, PROBLEM, SCENE, marked

PAID = ["reward", "cost"]
SYMBOLS = ["dirt", "near", "traversal", "size", "weight"]
FAR = "functions { far(?a - area): 0..9 [static] }"
RULE = DOMAIN[: DOMAIN.index("  rule join_two")]


SECTIONS = ["discount", "domain", "goal", "horizon", "init", "objects", "planner"]


def offered(name: str, text: str) -> list[str]:
    asked, offset, library = marked(name, text)
    return [completion.text for completion in completions(asked, offset, library)]


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("rule r: |", ["push", "join"]),
        ("rule r: pu|", ["push", "join"]),
        ("rule r: join(|", ["?a"]),
        ("rule r: join(?a, |", ["?b"]),
        ("rule r: join(?a, ?b) { |", ["then", "when", "with"]),
        ("rule r: push(?a) { when |", [*SYMBOLS, "?a", "exists", "forall", "not"]),
        ("rule r: push(?a) { when dirt(|", ["?a"]),
        ("rule r: push(?a) { when (dirt(?a) |", ["or"]),
        ("rule r: push(?a) { when (dirt(?a) or |", [*SYMBOLS, "?a", "not"]),
        ("rule r: push(?a) { when traversal(?a, |", ["?a", "bin"]),
        ("rule r: push(?a) { when size(?a) |", ["then", "with"]),
        ("rule r: push(?a) { when size(?a) = |", ["small", "medium", "big"]),
        ("rule r: push(?a) { when weight(?a) >= |", ["small", "large"]),
        ("rule r: push(?a) { then |", ["rest"]),
        ("rule r: push(?a) { then 0.5 [|", ["fixed", "prior", "seen"]),
        ("rule r: push(?a) { then 0.5: |", [*SYMBOLS, *PAID, "forall", "if", "noise", "not", "nothing"]),
        ("rule r: push(?a) { then 0.5: dirt(?a), |", [*SYMBOLS, *PAID, "forall", "if", "not"]),
        ("rule r: push(?a) { then 0.5: size(?a) := |", ["small", "medium", "big"]),
        ("rule r: push(?a) { then 0.5: forall ?m - |", ["place", "area", "container"]),
        ("rule r: push(?a) { then 0.5: forall ?m - area: near(?a, |", ["?a", "?m"]),
        ("rule r: push(?a) { then 0.5: forall ?m - area => dirt(?m) 0.1: dirt(|", ["?a"]),
        ("predicates { wet(?a - |", ["place", "area", "container"]),
        ("predicates { wet(?a ?b - area) [|", ["static", "symmetric"]),
        ("actions { wipe(?a - area) [duration = 3 |", ["s"]),
        ("actions { wipe(?a - area) [duration = 3 s [|", ["fixed", "prior", "seen"]),
        ("actions { wipe(?a - area) [duration = 3 s [seen 2, prior 4 |", ["s"]),
        ("actions { wipe(?a - area) [duration = 3 s [seen 2], |", ["cost", "duration"]),
        (f"{FAR} actions {{ wipe(?a - area) [cost = |", ["far"]),
        (f"{FAR} actions {{ wipe(?a - area) [cost = 1/2 + 0.5 * |", ["far"]),
        (f"{FAR} actions {{ rub(?c - area) wipe(?a ?b - area) [duration = 2 s, cost = far(|", ["?a", "?b"]),
        (f"{FAR} actions {{ wipe(?a - area) [cost = far(?a), |", ["cost", "duration"]),
        (f"{FAR} rule r: push(?a) {{ then 1: reward += |", ["far"]),
        (f"{FAR} rule r: push(?a) {{ then 1: reward -= 1/2 + 0.5 * |", ["far"]),
        (f"{FAR} rule r: push(?a) {{ then 0.5: dirt(?a), cost += 2 * far(?a) + |", ["far"]),
        (f"{FAR} rule r: push(?a) {{ with ?b - area: near(?a, ?b) then 1: cost += far(|", ["?a", "?b"]),
        (f"{FAR} rule r: push(?a) {{ then 1: far(?a) += |", []),
        ("functions { wet(?a - area): 0..3 [|", ["static"]),
        ("learned { |", ["estimator", "m", "match", "forgetting", "experience"]),
        ("learned { m = 10 es|", ["estimator", "m", "match", "forgetting", "experience"]),
        ("learned { m = |", []),
        ("learned { match = |", ["shared", "strict"]),
        ("learned { m = 10 estimator = |", ["decreasing_m", "m", "fitted_m", "likelihood"]),
        ('learned { experience "x" [|', ["sha256"]),
        ('learned { experience "x" [sha256 = "9f86d081884c7d65", |', ["transitions"]),
        ("rule r: push(?a) [|", ["fixed"]),
        ("rule r: push(?a) { with ?b - area: near(?b, |", ["?a", "?b"]),
        ("rule r: push(?a) { when forall ?b - area: near(?a, |", ["?a", "?b"]),
        (
            "rule r: push(?a) { with ?b ?c - area: near(?b, ?c) then 0.5: dirt(?b) 0.1: dirt(|",
            ["?a", "?b", "?c"],
        ),
        (
            "rule r: push(?a) { with ?b - area: dirt(?b) then 1: forall ?c - area => dirt(?c) 0: dirt(|",
            ["?a", "?b"],
        ),
        ("parameters { often = 0.5 } rule r: push(?a) { then |", ["often", "rest"]),
        ("derived { beside(?a ?b - area) := closure |", SYMBOLS),
        ("reward { |", ["dirty_areas", "cost", "decrease", "duration", "goal"]),
        ("reward { decrease(|", ["dirty_areas"]),
        ("derived { n := |", ["count"]),
        ("rule broken: ( { { ] \n } rule r: push(?a) { when size(?a) = |", ["small", "medium", "big"]),
    ],
)
def test_in_a_domain(typed: str, expected: list[str]) -> None:
    found = offered("tables.nid", f"{RULE}  {typed}")
    assert [text for text in found if text in expected] == expected
    assert set(found) == set(expected)


def test_between_sections() -> None:
    found = offered("tables.nid", f"{RULE}\n  |\n}}\n")
    assert found == sorted(found)
    assert {"rule", "reward", "default", "actions"} <= set(found)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("= tables", "= |", ["cleaning", "piles", "sweeping", "tables", "wiping_ink"]),
        ("a1 a2 - area", "a1 a2 - |", ["place", "area", "container"]),
        ("near(a1, a2)", "near(a1, |)", ["a1", "a2"]),
        ("near(a1, a2)", "|", SYMBOLS),
        ("weight(a1) = small", "weight(a1) = |", ["small", "large"]),
        ("\n  horizon =", "\n  planner { |\n  horizon =", ["name", "samples", "seed"]),
        ("\n  horizon =", "\n  planner { name = |\n  horizon =", []),
        ("1 + dirty_areas", "1 + |", ["dirty_areas"]),
        ("\n  horizon = 1 + dirty_areas", "\n  |", SECTIONS),
    ],
)
def test_in_a_problem(old: str, new: str, expected: list[str]) -> None:
    found = offered("two.nid", PROBLEM.replace(old, new))
    assert found[: len(expected)] == expected
    assert found[len(expected) :] in ([], SECTIONS)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("width = 10 cm", "|", {"grasp", "width"}),
        ("width = 10 cm", "grasp = |", {"wide"}),
        ("width = 10 cm", "width = 10 |", {"cm", "mm", "m"}),
        ("radius = 2 cm", "|", {"count", "at", "radius"}),
        ("domain = tables", "domain = |", {"tables", "cleaning"}),
        ("dirt   { group", "dirt   { | group", {"group", "scattered"}),
        ("domain = tables", "|", {"domain", "seed", "surface", "rag", "dirt"}),
    ],
)
def test_in_a_scene(old: str, new: str, expected: set[str]) -> None:
    assert expected <= set(offered("little.nid", SCENE.replace(old, new)))


def test_nothing_is_offered_in_comments() -> None:
    assert offered("tables.nid", DOMAIN.replace("the easy one", "the easy |")) == []


def test_what_is_typed_so_far_is_replaced() -> None:
    asked, offset, library = marked("tables.nid", f"{RULE}  rule r: push(?abc) {{ when dirt(?ab|")
    (only,) = completions(asked, offset, library)
    assert (only.text, only.start) == ("?abc", offset - 3)


def test_offers_tell_what_they_are() -> None:
    asked, offset, library = marked("tables.nid", f"{RULE}  rule r: push(?a) {{ when ne|")
    (near,) = (found for found in completions(asked, offset, library) if found.text == "near")
    assert near.detail == "predicate near(?a ?b - area) [symmetric]"
    assert near.about == "two areas\nside by side"


def test_marks_are_those_that_the_checker_takes() -> None:
    marks = {word for words in MARKS.values() for word in words}
    assert marks == {"cost", "duration", "static", "symmetric"}


def test_context_of_an_empty_text() -> None:
    place = context("", 0)
    assert place is not None
    assert place.accepted == frozenset({"DOMAIN", "PROBLEM", "SCENE", "STUDY"})
