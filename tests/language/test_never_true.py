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
