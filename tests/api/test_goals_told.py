"""What is told where a goal was not reached (docs/planning.md), of problems of any size."""

from __future__ import annotations

import pytest

from cleancli.api.goals import first_and_longer, is_hopeless
from cleancli.compiler.ground import ground
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain, Problem

DOMAIN = """
domain switches {
  types { switch }
  predicates { on(?s - switch)  hot() }
  actions { press(?a ?b ?c ?d ?e ?f - switch) }
  rule press: press(?a, ?b, ?c, ?d, ?e, ?f) { then 0.5: on(?a), hot() 0.5: nothing }
  reward { goal }
}
"""


def switches(number: int, goal: str) -> tuple[Domain, Problem]:
    domain = load_domain(Source("switches.nid", DOMAIN))
    objects = " ".join(f"s{each}" for each in range(number))
    parts = f"objects {{ {objects} - switch }} init {{ }} goal {{ {goal} }} horizon = 20"
    return domain, load_problem(Source("p.nid", f"problem p {{ domain = switches {parts} }}"), domain)


@pytest.mark.parametrize(("goal", "hopeless"), [("on(s0), not hot()", True), ("on(s0)", False)])
def test_a_goal_that_no_action_leads_to_is_known(goal: str, hopeless: bool) -> None:
    assert is_hopeless(*switches(2, goal)) is hopeless


def test_of_a_problem_that_is_too_large_to_be_grounded_nothing_is_told() -> None:
    """A run of it, which grounds nothing, has ended and is to say how."""
    domain, problem = switches(100, "on(s0), not hot()")
    with pytest.raises(Refused):
        ground(domain, problem)
    assert is_hopeless(domain, problem) is False


def test_the_longer_horizon_is_twice_as_long() -> None:
    assert first_and_longer(*switches(2, "on(s0)"), 100) == (20, 40)
