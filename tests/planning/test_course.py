"""The course of a policy's plan: what each action comes to on it, by docs/planning.md."""

from __future__ import annotations

import pytest

from cleancli.compiler.fluents import Fluent, values_of
from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import successors
from cleancli.language.model import Value
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options, Plan
from cleancli.planning.registry import PLANNERS
from cleancli.simulation.symbolic_world import changing_facts
from support.from_text import task
from support.shipped import shipped_domain, shipped_problem

LAMP = """
domain lamp {
  types      { lamp }
  predicates { lit(?l - lamp) broken(?l - lamp) }
  derived    { dark := count ?l - lamp: not lit(?l) }
  actions    { light(?l - lamp) }
  rule light_it: light(?l) {
    when not lit(?l), not broken(?l)
    then 0.3: lit(?l)
         0.1: broken(?l)
         rest: nothing
  }
  reward { decrease(dark) }
}
"""

POLISH = """
domain polish {
  types      { area }
  predicates { dirt(?a - area)  big(?a - area)  done(?a - area) }
  derived    { left := count ?a - area: not done(?a) }
  actions    { clean(?a - area)  polish(?a - area) }
  rule small: clean(?a) { when dirt(?a), not big(?a) then 1: not dirt(?a) }
  rule large: clean(?a) { when dirt(?a), big(?a) then 0.5: not dirt(?a) 0.5: nothing }
  rule polish: polish(?a) { when not dirt(?a), not done(?a) then 1: done(?a), big(?a) }
  reward     { decrease(left) }
}
"""


def planned(planner: str, inside: str) -> Plan:
    return PLANNERS[planner](prepare(task(LAMP, inside)), Options(samples=200, seed=1))


@pytest.mark.parametrize("planner", ["exact", "prada+", "uct"])
def test_what_fails_and_is_tried_again_goes_on_from_what_it_came_to(planner: str) -> None:
    """The likeliest result of lighting a lamp is that it stays dark."""
    plan = planned(planner, "objects { a b - lamp } init { } horizon = 9")
    lit = [action.objects[0] for action in plan.actions]
    assert sorted(lit) == ["a", "b"]
    assert plan.results == tuple({("lit", (name,)): True} for name in lit)


def test_a_last_try_ends_as_is_likeliest() -> None:
    plan = planned("exact", "objects { a - lamp } init { } horizon = 1")
    assert plan.results == ({},)


def test_without_a_horizon_the_course_leads_to_the_goal() -> None:
    plan = planned("exact", "objects { a b - lamp } init { } goal { lit(a), lit(b) } horizon = unlimited")
    assert [dict(result) for result in plan.results] == [
        {("lit", action.objects): True} for action in plan.actions
    ]
    assert len(plan.results) == 2


@pytest.mark.parametrize("horizon", ["3", "unlimited"])
@pytest.mark.parametrize("planner", ["exact", "prada+"])
def test_what_is_forgotten_may_be_set_again(planner: str, horizon: str) -> None:
    """Whether an area that is clean is big matters no more, and polishing it makes it big."""
    inside = f"objects {{ a - area }} init {{ dirt(a) }} goal {{ done(a) }} horizon = {horizon}"
    plan = PLANNERS[planner](prepare(task(POLISH, inside)), Options(samples=200, seed=1))
    assert [action.name for action in plan.actions] == ["clean", "polish"]
    assert [dict(each) for each in plan.results] == [
        {("dirt", ("a",)): False},
        {("big", ("a",)): True, ("done", ("a",)): True},
    ]


@pytest.mark.parametrize("planner", ["exact", "prada+", "uct", "sst", "prada", "likeliest"])
def test_results_are_those_that_the_rules_allow(planner: str) -> None:
    """Replayed in the task, of which nothing is forgotten; a sequence has none."""
    domain = shipped_domain("cleaning")
    whole = ground(domain, shipped_problem("three_areas", domain))
    plan = PLANNERS[planner](prepare(whole), Options(samples=500, seed=2))
    assert plan.actions
    if plan.policy is None:
        assert plan.results == ()
        return
    state, numbers = whole.initial, {action.key: index for index, action in enumerate(whole.actions)}
    for action, result in zip(plan.actions, plan.results, strict=True):
        after = values_of(changing_facts(whole, state)) | dict(result)
        allowed = [found for _, found in successors(whole, state, numbers[action.key])]
        (state,) = [found for found in allowed if values_of(changing_facts(whole, found)) == _true(after)]


def _true(values: dict[Fluent, Value]) -> dict[Fluent, Value]:
    """The values that are facts: not those of predicates that do not hold."""
    return {fluent: value for fluent, value in values.items() if value is not False}
