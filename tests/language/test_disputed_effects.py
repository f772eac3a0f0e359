"""W301, an effect that changes nothing: not where another effect of the outcome may be about the same, and
just where E309 takes an outcome with the effect for one without it."""

from __future__ import annotations

import itertools

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import checked_domain

DOMAIN = """domain d {
  types { area }
  predicates { dirt(?a - area) mark(?a - area) }
  functions { load(?a - area): 0..3 }
  derived { n := count ?a - area: dirt(?a) }
  actions { go(?a ?b - area) }
  rule r: go(?a, ?b) { when %s then 0.4: %s 0.6: %s }
  reward { decrease(n) }
}
"""


@pytest.mark.parametrize(
    ("condition", "effects", "idle"),
    [
        ("dirt(?a), not mark(?b)", "mark(?a), not mark(?b)", 0),  # they conflict where ?a = ?b
        ("dirt(?a), load(?b) = 3", "load(?b) := 3, load(?a) += 1", 0),
        ("dirt(?a), load(?b) = 3", "load(?b) := 3, load(?a) := 1", 0),
        ("dirt(?a), not mark(?b)", "not mark(?a), not mark(?b)", 1),
        ("dirt(?a), not mark(?b)", "not dirt(?b), not mark(?b)", 1),
        ("dirt(?a), load(?b) = 3", "load(?b) := 3, mark(?a)", 1),
    ],
)
def test_an_effect_is_idle_only_where_no_other_is_about_the_same(
    condition: str, effects: str, idle: int
) -> None:
    found = checked_domain(Source("d.nid", DOMAIN % (condition, effects, "not dirt(?a)")))
    assert [each.code for each in found.diagnostics].count("W301") == idle


CONDITIONS = (
    "dirt(?a), load(?b) = 3",
    "dirt(?a), load(?b) >= 3, mark(?b)",
    "dirt(?a), ?a = ?b, load(?a) = 3, not mark(?a)",
    "dirt(?a), load(?b) <= 2, load(?b) >= 2, not mark(?b)",
    "dirt(?a), load(?a) = 0, load(?b) = 0",
)
EFFECTS = (
    "load(?b) := 3",
    "load(?b) := 2",
    "load(?b) += 1",
    "load(?a) -= 1",
    "mark(?b)",
    "not mark(?b)",
    "forall ?m - area: mark(?m) => load(?m) := 3",
    "forall ?m - area: dirt(?m) => load(?m) += 1",
    "forall ?m - area: dirt(?m) => mark(?m)",
)


@pytest.mark.parametrize("condition", CONDITIONS)
def test_an_idle_effect_is_one_that_an_outcome_may_leave_out(condition: str) -> None:
    answers = []
    for effect, *others in itertools.permutations(EFFECTS, 3):
        if effect.startswith("forall") or others != sorted(others):
            continue
        rest = ", ".join(("not dirt(?a)", *others))
        text = DOMAIN % (condition, f"{effect}, {rest}", rest)
        found = checked_domain(Source("d.nid", text)).diagnostics
        codes = [each.code for each in found]
        shifts = effect[-3:] == "= 1" and any(each[-3:] == "= 1" for each in others)
        if "E308" in codes or shifts:  # shifts may make up for each other
            continue
        idle = [text[each.span.start : each.span.end] for each in found if each.code == "W301" and each.span]
        assert (effect in idle) == ("E309" in codes), (effect, others)
        answers.append(effect in idle)
    assert {True, False} == set(answers)
