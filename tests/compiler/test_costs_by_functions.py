"""What actions cost by functions of their objects (docs/language.md "Costs and rewards")."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise, permutations

import numpy as np
import pytest

import cleancli
from cleancli.compiler.rewards import waiting_can_pay
from cleancli.compiler.task import GroundAction
from cleancli.simulation.symbolic_world import do, world_of
from support.from_text import checked, task

PLACES = "abcd"
FAR = {
    (one, other): (3 * i * j + 7 * i + j) % 11
    for i, one in enumerate(PLACES)
    for j, other in enumerate(PLACES)
}
TOLL = dict(zip(PLACES, (0, 3, 1, 2), strict=True))
TEXT = """
domain driven {
  types      { place }
  constants  { a - place }
  predicates { at(?p - place)  road(?p ?q - place) [static] }
  functions  { far(?p ?q - place): 0..10 [static]  toll(?p - place): 0..3 [static] }
  actions {
    drive(?p ?q - place) [cost = 1/3 + 0.5 * far(?p, ?q) + toll(?q)]
    home(?p - place)     [cost = 2 * far(?p, a)]
  }
  rule drive_it: drive(?p, ?q) {
    when at(?p), road(?p, ?q)
    then 0.5: at(?q), not at(?p)
         0.5: nothing
  }
  rule drive_home: home(?p) {
    when at(?p), ?p != a
    then 1: at(a), not at(?p)
  }
  reward { REWARD }
}
"""
INSIDE = (
    "objects { b c d - place } init { at(a) "
    + " ".join(f"far({p}, {q}) = {value}" for (p, q), value in FAR.items())
    + " ".join(f" toll({p}) = {value}" for p, value in TOLL.items())
    + " road(a, b) road(b, c) road(a, d) road(d, c) } goal { at(c) } "
)


def cost_of(name: str, objects: tuple[str, ...]) -> Fraction:
    """By the words of the text."""
    if name == "home":
        return Fraction(2 * FAR[objects[0], "a"])
    start, end = objects
    return Fraction(1, 3) + Fraction(FAR[start, end], 2) + TOLL[end]


@pytest.mark.parametrize(("paid", "weight"), [("goal - cost", -1), ("goal - 0.5 * cost", Fraction(-1, 2))])
def test_an_action_costs_what_its_functions_say_of_its_objects(paid: str, weight: Fraction) -> None:
    found = task(TEXT.replace("REWARD", paid), f"{INSIDE} horizon = 4")
    assert {action.name for action in found.actions} == {"drive", "home"}
    for action in found.actions:
        assert action.declared_cost == cost_of(action.name, action.objects)
        assert action.cost == -weight * action.declared_cost


def test_a_plan_takes_the_cheapest_way_to_the_goal() -> None:
    """A road is tried twice on average; the cheapest order of places is found by trying all."""
    plan = cleancli.plan(TEXT.replace("REWARD", "goal - cost"), problem_text("horizon = unlimited"))
    roads = {("a", "b"), ("b", "c"), ("a", "d"), ("d", "c")}
    ways = [("a", *between, "c") for length in range(3) for between in permutations("bd", length)]
    costs = [
        sum(2 * cost_of("drive", road) for road in pairwise(way))
        for way in ways
        if set(pairwise(way)) <= roads
    ]
    assert len(costs) == 2
    assert plan.reached is not None
    assert plan.reached.cost == pytest.approx(float(min(costs)), abs=1e-9)


def problem_text(said: str) -> str:
    return f"problem p {{ domain = driven {INSIDE} {said} }}"


def test_an_action_that_can_change_nothing_costs_as_much() -> None:
    domain, problem = checked(TEXT.replace("REWARD", "goal - cost"), f"{INSIDE} horizon = 4")
    world = world_of(domain, problem)
    idle = ("drive", ("c", "b"))
    assert idle not in world.numbers
    step, after = do(world, world.task.initial, GroundAction(*idle, None), np.random.default_rng(1))
    assert after == world.task.initial
    assert step.cost == pytest.approx(float(cost_of(*idle)))
    assert step.reward == pytest.approx(-float(cost_of(*idle)))


def test_whether_an_action_may_earn_depends_on_the_sign_of_costs() -> None:
    for paid, pays in (("goal - cost", False), ("goal + cost", True)):
        assert waiting_can_pay(checked(TEXT.replace("REWARD", paid), f"{INSIDE} horizon = 4")[0]) is pays
