"""E604 for instances that are few and long: just as many literals and effects as fit, and one fewer."""

from __future__ import annotations

import pytest

from cleancli.compiler import ground as ground_module
from cleancli.compiler import grounding_size, partial_evaluation
from cleancli.compiler.ground import ground
from cleancli.language.diagnostics.refused import Refused
from support import from_text

TEXT = """domain d {
  types { area }
  predicates { dirt(?a - area)  wet(?a - area)  near(?a ?b - area) }
  derived {
    dirty := count ?a - area: dirt(?a)
    beset(?a - area) := exists ?b - area: (near(?a, ?b), dirt(?b))
    doubly(?a - area) := beset(?a), exists ?b - area: (wet(?b), near(?b, ?a))
  }
  actions { wipe(?a - area)  link(?a ?b - area) }
  rule wiped: wipe(?a) { when dirt(?a)%s then 0.5: not dirt(?a)%s  0.25: wet(?a)%s  rest: noise }
  rule linked: link(?a, ?b) { when wet(?a) then 1: near(?a, ?b) }
  reward { decrease(dirty) }
}"""
AREAS = "objects { a b c d - area } init { dirt(a), dirt(b), dirt(c), wet(d) }"
FORALL = ", forall ?m - area: near(?a, ?m) => wet(?m)"


@pytest.mark.parametrize(
    ("when", "first", "second", "each"),
    [
        ("", FORALL, "", 4),
        ("", FORALL, FORALL, 8),
        ("", FORALL.replace("?m", "?k"), FORALL, 8),
        (", exists ?m - area: near(?a, ?m)", "", "", 4),
        (", exists ?m ?k - area: (near(?m, ?k), dirt(?k))", "", "", 16),
        (", exists ?m - area: (near(?a, ?m), wet(?m))", FORALL, "", 8),
        (", beset(?a)", "", "", 5),
        (", doubly(?a)", "", "", 10),
    ],
)
def test_parts_are_counted(
    when: str, first: str, second: str, each: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    checked = from_text.checked(TEXT % (when, first, second), AREAS)
    monkeypatch.setattr(grounding_size, "PART_LIMIT", 4 * each)
    ground(*checked)
    monkeypatch.setattr(grounding_size, "PART_LIMIT", 4 * each - 1)
    with pytest.raises(Refused) as refused:
        ground(*checked)
    (said,) = refused.value.diagnostics
    assert said.code == "E604"
    assert f"up to {4 * each:,} literals and effects" in said.message


def test_a_rule_without_such_parts_is_not_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grounding_size, "PART_LIMIT", 0)
    ground(*from_text.checked(TEXT % ("", "", ""), AREAS))


@pytest.mark.parametrize(("most", "refused"), [(16, False), (15, True)])
@pytest.mark.parametrize("quantifier", ["forall ?m ?n", "exists ?m ?n", "not exists ?m ?n"])
def test_a_goal_is_counted(
    quantifier: str, most: int, refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """25 variables of two objects filled memory before anything was said."""
    goal = f" goal {{ wet(a), {quantifier} - area: near(?m, ?n) }}"
    checked = from_text.checked(TEXT % ("", "", ""), AREAS + goal)
    monkeypatch.setattr(grounding_size, "PART_LIMIT", most)
    if not refused:
        ground(*checked)
        return
    with pytest.raises(Refused) as said:
        ground(*checked)
    (found,) = said.value.diagnostics
    assert found.code == "E604"
    assert "the goal of `p` asks for 16 bindings of one quantifier" in found.message


@pytest.mark.parametrize(
    ("when", "effect", "goal", "parts"),
    [
        ("", "", "", 20),
        ("", "", "goal { wet(a) }", 20),
        ("", "", "goal { forall ?m ?n - area: near(?m, ?n) }", 20 + 16),
        ("", FORALL, "", 20 + 4 * 4),
        (", doubly(?a)", "", "", 20 + 4 * 10),
    ],
)
def test_parts_of_a_task_are_counted_before_it_is_made(when: str, effect: str, goal: str, parts: int) -> None:
    """Four instances of `wiped`, sixteen of `linked`; and 4 * 4 literals of `beset`, 4 * 9 of `doubly`."""
    checked = from_text.checked(TEXT % (when, effect, ""), f"{AREAS} {goal}")
    assert grounding_size.most_parts(*checked) == parts + 4 * 4 + 4 * 9


def test_parts_under_many_conditions_count_for_more() -> None:
    """Seven conditions divide each of four instances into 128 cases: its eight parts count 13 times."""
    names = [f"p{number}" for number in range(7)]
    predicates = " ".join(f"{name}(?a - area)" for name in names)
    effects = ", ".join(f"if {name}(?a) => not {name}(?a)" for name in names)
    text = f"""domain d {{ types {{ area }} predicates {{ dirt(?a - area) wet(?a - area) {predicates} }}
        derived {{ dirty := count ?a - area: dirt(?a) }}
        actions {{ wipe(?a - area) }}
        rule wiped: wipe(?a) {{ then 0.5: {effects} rest: nothing }}
        reward {{ decrease(dirty) }} }}"""
    few = text.replace(effects, "if p0(?a) => not p0(?a)")
    assert grounding_size.most_parts(*from_text.checked(few, AREAS)) == 4 * (1 + 1)
    assert grounding_size.most_parts(*from_text.checked(text, AREAS)) == 4 * (1 + 7) * (1 + 12)


@pytest.mark.parametrize(("most", "refused"), [(20, False), (19, True)])
def test_just_as_many_groundings_as_fit(most: int, refused: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Four of `wiped` and sixteen of `linked`."""
    checked = from_text.checked(TEXT % ("", "", ""), AREAS)
    monkeypatch.setattr(grounding_size, "RULE_LIMIT", most)
    if not refused:
        ground(*checked)
        return
    with pytest.raises(Refused) as said:
        ground(*checked)
    assert [d.code for d in said.value.diagnostics] == ["E604"]
    assert "rule `linked` has 16 groundings of 20 in all, about 0.0 GB;" in said.value.diagnostics[0].message


def test_groundings_are_counted_exactly_where_that_is_quick() -> None:
    domain, problem = from_text.checked(TEXT % ("", "", ""), AREAS)
    assert [
        (each.name, each.count, each.exact) for each in grounding_size.count_groundings(domain, problem)
    ] == [
        ("wiped", 4, True),
        ("linked", 16, True),
    ]


BLAMED = """domain d {
  types { area; tool }
  constants { rag - tool }
  predicates { dirt(?a - area)  near(?a ?b - area) [static]  fits(?t - tool, ?a - area) [static] }
  derived { dirty := count ?a - area: dirt(?a) }
  actions { wipe(?a ?b ?c - area)  use(?t - tool, ?a - area)  pause() }
  rule wiped: wipe(?a, ?b, ?c) { when %s then 0.5: not dirt(?a) rest: noise }
  rule used: use(?t, ?a) { when dirt(?a), fits(?t, ?a) then 0.5: not dirt(?a) rest: noise }
  reward { decrease(dirty) }
}"""
SOME = """objects { a b c d - area  mop - tool }
  init { dirt(a), near(a, b), near(b, c), near(a, c), fits(rag, a), fits(mop, b) }"""


@pytest.mark.parametrize(
    ("when", "number", "blame"),
    [
        ("dirt(?a)", 64, "no fact restricts `?a`: 4 objects fit"),
        ("near(?a, ?b)", 12, "no fact restricts `?c`: 4 objects fit"),
        ("near(?a, ?b), near(?b, ?c)", 1, "`near(?a, ?b)` holds in 3 ways"),
        ("near(?a, ?b), near(?c, ?b), fits(rag, ?a)", 3, "`near(?a, ?b)` holds in 3 ways"),
        ("near(?a, ?b), fits(mop, b), dirt(?c)", 12, "no fact restricts `?c`: 4 objects fit"),
        ("near(?a, ?b), fits(rag, b)", 0, ""),
    ],
)
def test_what_leaves_most_groundings_is_blamed(when: str, number: int, blame: str) -> None:
    text = BLAMED.replace("rag - tool", "rag mop - tool b - area") % when
    inside = SOME.replace("a b c d - area  mop - tool", "a c d - area")
    first, second = grounding_size.count_groundings(*from_text.checked(text, inside))
    assert (first.count, first.exact, first.blame) == (number, True, blame)
    assert (second.name, second.count) == ("used", 2)


@pytest.mark.parametrize(("tools", "blame"), [(2, "`?a`: 4 objects fit"), (6, "`?t`: 6 objects fit")])
def test_of_several_that_no_fact_restricts_the_one_with_most_objects_is_blamed(
    tools: int, blame: str
) -> None:
    text = (BLAMED % "dirt(?a)").replace("when dirt(?a), fits(?t, ?a) then", "when dirt(?a) then")
    more = " ".join(f"t{number}" for number in range(tools - 1))
    inside = f"objects {{ a b c d - area  {more} - tool }} init {{ dirt(a) }}"
    used = grounding_size.count_groundings(*from_text.checked(text, inside))[1]
    assert (used.count, used.blame) == (4 * tools, f"no fact restricts {blame}")


def test_all_cases_together_have_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten areas have a case each of `exists`: fewer than an instance may have, and more than all may."""
    text = TEXT % (", exists ?m - area: (dirt(?m), ?m != ?a)", "", "")
    checked = from_text.checked(text, AREAS)
    monkeypatch.setattr(ground_module, "RULE_LIMIT", 10)
    monkeypatch.setattr(grounding_size, "RULE_LIMIT", 100)
    with pytest.raises(Refused) as refused:
        ground(*checked)
    (said,) = refused.value.diagnostics
    assert said.code == "E605"
    assert said.label.endswith("cases of rule `wiped`")


@pytest.mark.parametrize("place", ["count", "goal"])
def test_a_closure_of_too_many_paths_says_where(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(partial_evaluation, "STEP_LIMIT", 3)
    text = TEXT.replace("dirty :=", "linked(?a ?b - area) := closure near  dirty :=") % ("", "", "")
    goal = " goal { linked(a, d) }" if place == "goal" else ""
    if place == "count":
        text = text.replace("  dirty :=", "  far := count ?a ?b - area: linked(?a, ?b)  dirty :=")
    with pytest.raises(Refused) as refused:
        ground(*from_text.checked(text, AREAS + goal))
    (said,) = refused.value.diagnostics
    assert said.code == "E606"
    assert place in f"{said.message} {said.label} {said.help}"


@pytest.mark.parametrize(
    ("condition", "number", "blame"),
    [
        ("dirt(?a)", 64, "no fact restricts `?a`: 4 objects fit"),
        ("near(?a, ?b), dirt(?c)", 12, "no fact restricts `?c`: 4 objects fit"),
        ("near(?a, ?b), near(?b, ?c)", 1, "`near(?a, ?b)` holds in 3 ways"),
    ],
)
def test_a_count_has_no_more_bindings_than_fit(
    condition: str, number: int, blame: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = BLAMED.replace("derived {", f"derived {{ many := count ?a ?b ?c - area: {condition}")
    text = text % "dirt(?a), near(?a, ?b), near(?b, ?c)"
    checked = from_text.checked(text, SOME)
    ground(*checked)
    monkeypatch.setattr(grounding_size, "RULE_LIMIT", max(number - 1, 4))
    if number <= 4:
        ground(*checked)
        return
    with pytest.raises(Refused) as refused:
        ground(*checked)
    (said,) = refused.value.diagnostics
    assert said.code == "E604"
    assert said.message.startswith(f"the count `many` has {number} groundings, ")
    assert said.label == blame
