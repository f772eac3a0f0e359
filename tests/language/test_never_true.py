"""W402: what a problem's rules and goal ask for, and no fact and no rule makes true (docs/diagnostics.md)."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import checked_problem, load_domain

TEXT = """domain d {
  types { area }
  predicates { dirt(?a - area)  wet(?a - area)  near(?a ?b - area) }
  functions { load(?a - area): 0..3  size(?a - area): small < medium < big }
  derived { dirty := count ?a - area: dirt(?a) }
  actions { wipe(?a - area) }
  rule wiped: wipe(?a) { when dirt(?a)%s then 0.5: not dirt(?a)%s  rest: nothing }
  reward { decrease(dirty) }
}"""
FACTS = "dirt(a), load(a) = 0, load(b) = 0, size(a) = small, size(b) = small"


def warned(when: str = "", then: str = "", facts: str = "", goal: str = "") -> list[str]:
    domain = load_domain(Source("d.nid", TEXT % (when, then)))
    inside = f"objects {{ a b - area }} init {{ {FACTS}{facts} }} {goal}"
    found = checked_problem(Source("p.nid", f"problem p {{ domain = d {inside} }}"), domain).diagnostics
    return [f"{d.message} {d.help}" for d in found if d.code == "W402"]


@pytest.mark.parametrize(
    ("when", "then", "facts"),
    [
        ("", "", ""),
        (", not wet(?a)", "", ""),
        (", wet(?a)", ", not wet(?a)", ", wet(b)"),
        (", wet(?a)", ", wet(?a)", ""),
        (", wet(?a)", ", forall ?b - area: near(?a, ?b) => wet(?b)", ", near(a, b)"),
        (", load(?a) = 3", ", load(?a) += 1", ""),
        (", load(?a) = 3", ", load(?a) := 3", ""),
        (", size(?a) = big", ", size(?a) := big", ""),
        (", size(?a) < big", "", ""),
        (", not exists ?b - area: wet(?b)", "", ""),
        (", forall ?b - area: not wet(?b)", "", ""),
    ],
)
def test_what_can_come_about_is_no_warning(when: str, then: str, facts: str) -> None:
    assert warned(when, then, facts) == []


@pytest.mark.parametrize(
    ("when", "then", "shown"),
    [
        (", wet(?a)", "", "wet(?a)"),
        (", wet(?a)", ", not wet(?a)", "wet(?a)"),
        (", load(?a) = 3", ", load(?a) := 2", "load(?a) = 3"),
        (", size(?a) > small", "", "size(?a)"),
        (", exists ?b - area: (near(?a, ?b), dirt(?b))", "", "near(?a, ?b)"),
    ],
)
def test_what_a_rule_asks_for_in_vain_is_told(when: str, then: str, shown: str) -> None:
    (told,) = warned(when, then)
    assert told.startswith(f"`{shown}")
    assert "asked for by the rule `wiped`" in told


def test_a_goal_asks_too_and_each_asker_is_named_once() -> None:
    (told,) = warned(", wet(?a)", goal="goal { wet(a), wet(b) }")
    assert told.endswith("asked for by the rule `wiped`, the goal")
    (told,) = warned(goal="goal { load(a) = 2 }")
    assert told.endswith("asked for by the goal")
    assert warned(goal="goal { not dirt(a) }") == []


KINDS = """domain d {
  types { shirt }
  predicates { clean(?s - shirt)  delicate(?s - shirt)%s  near(?a ?b - shirt) [static] }
  functions { size(?s - shirt): small < medium < big [static] }
  derived { left := count ?s - shirt: not clean(?s) }
  actions { scrub(?s - shirt)  fold(?s - shirt) }
  rule gently: scrub(?s) { when delicate(?s) then 0.5: clean(?s) rest: nothing }
  rule harshly: scrub(?s) { when not delicate(?s) then 0.9: clean(?s) rest: nothing }
  rule fold_small: fold(?s) { when size(?s) = small, clean(?s) then 0.8: not clean(?s) rest: nothing }
  rule fold_big: fold(?s) { when size(?s) = %s, near(?s, ?s) then 0.8: not clean(?s) rest: nothing }
  reward { decrease(left) }
}"""


def kinds(static: str = " [static]", big: str = "big", init: str = "size(a) = small", goal: str = "") -> str:
    """What is said never to hold, of a problem with one shirt."""
    domain = load_domain(Source("d.nid", KINDS % (static, big)))
    text = f"problem p {{ domain = d objects {{ a - shirt }} init {{ {init} }} {goal} }}"
    found = checked_problem(Source("p.nid", text), domain).diagnostics
    return ", ".join(d.message.split("`")[1] for d in found if d.code == "W402")


def test_kinds_of_objects_that_a_problem_lacks_are_no_mistake_where_rules_tell_them_apart() -> None:
    """A rule for the shirts that there are stands beside each rule for those that there are not. Where one
    stands alone, where the symbol is not static, and in a goal it is told as before."""
    assert kinds() == "near(?a, ?b)"
    assert kinds(init="size(a) = small, near(a, a), delicate(a)") == ""
    assert kinds(init="size(a) = medium, near(a, a)") == "size(?s) = big, size(?s) = small"
    assert kinds(static="", init="size(a) = small, near(a, a)") == "delicate(?s)"
    assert kinds(init="size(a) = small, near(a, a)", goal="goal { delicate(a) }") == "delicate(?s)"
