"""What is told where a goal was not reached (docs/planning.md), of problems of any size."""

from __future__ import annotations

from pathlib import Path

import pytest

import cleancli
from cleancli.api.goals import HOPELESS, first_and_longer, is_hopeless
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


@pytest.mark.parametrize(("facts", "hopeless"), [("", True), ("lamp(s0)", False)])
@pytest.mark.parametrize("horizon", ["4", "unlimited"])
def test_a_goal_that_what_is_static_rules_out_is_out_of_reach(
    horizon: str, facts: str, hopeless: bool
) -> None:
    """Grounded, nothing is left of such a goal: it is told as any other that no action leads to."""
    domain = (
        "domain lamps { types { switch } predicates { on(?s - switch)  lamp(?s - switch) [static] }"
        " actions { press(?s - switch) } rule press: press(?s) { then 0.5: on(?s) rest: nothing }"
        " reward { goal } }"
    )
    problem = (
        f"problem p {{ domain = lamps objects {{ s0 s1 - switch }} init {{ {facts} }}"
        f" goal {{ on(s0), lamp(s0) }} horizon = {horizon} }}"
    )
    plan = cleancli.plan(domain, problem, seed=1, samples=50)
    simulated = cleancli.simulate(domain, problem, seed=1, episodes=2, samples=50)
    assert (plan.hopeless, simulated.hopeless) == (hopeless, hopeless)
    for told in (str(plan), str(simulated)):
        assert (HOPELESS.partition(":")[0] in told) is hopeless
    loaded = load_domain(Source("d", domain))
    assert is_hopeless(loaded, load_problem(Source("p", problem), loaded)) is hopeless


def test_of_a_problem_that_is_too_large_to_be_grounded_nothing_is_told() -> None:
    """A run of it, which grounds nothing, has ended and is to say how."""
    domain, problem = switches(100, "on(s0), not hot()")
    with pytest.raises(Refused):
        ground(domain, problem)
    assert is_hopeless(domain, problem) is False


def test_the_longer_horizon_is_twice_as_long() -> None:
    assert first_and_longer(*switches(2, "on(s0)"), 100) == (20, 40)


KILN = """
domain kiln {
  predicates { fired() cracked() sold() }
  actions    { fire() sell() }
  rule fire: fire() { when not fired(), not cracked()  then 0.5: fired() rest: cracked() }
  rule sell: sell() { when fired()  then 1: sold() }
  reward { 1 * goal }
}
"""
POT = "problem pot { domain = kiln goal { sold() } horizon = 4 }"
NO_LONGER = "the goal can no longer be reached, whatever is done"


def test_a_run_in_a_dead_end_says_so(tmp_path: Path) -> None:
    """docs/execution.md: a cracked pot is never sold, and one that is fired may be."""
    for cracks in (True, False):
        world = KILN.replace("0.5", "0.0001" if cracks else "0.9999")
        for most in (1, 9):
            run = cleancli.execute(
                KILN, POT, world=world, seed=1, max_actions=most, planner="exact", runs=tmp_path, video=False
            )
            assert run.clean == (not cracks and most == 9)
            assert (NO_LONGER in str(run)) == cracks
            assert HOPELESS not in str(run)


@pytest.mark.parametrize("planner", ["exact", ("prada", "exact")])
def test_episodes_that_were_given_up_in_a_dead_end_are_counted(planner: str | tuple[str, ...]) -> None:
    """docs/simulation.md: all that end without the goal, here, since nothing mends a crack."""
    done = cleancli.simulate(KILN, POT, planner=planner, episodes=20, seed=1)
    for summary, rows in zip(done.planners, done.episodes, strict=True):
        cracked = sum(not row.success for row in rows)
        assert 0 < cracked < 20
        line = f"{summary.planner}: of {cracked} episodes that it gave up, {cracked} had come where the goal"
        assert line in str(done)
    mended = KILN.replace("rest: cracked() }", "rest: nothing }")
    assert "no longer" not in str(cleancli.simulate(mended, POT, planner=planner, episodes=20, seed=1))
