"""Goals that are far away: relaxed distances against slow references, ways along relaxed plans, and plans
that hope for a goal that no run reaches."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from cleancli.compiler.semantics import reaches_goal, successors
from cleancli.compiler.task import GroundCondition, GroundState, RewardCondition, Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.kernels import relaxed
from cleancli.planning.plan import Options
from cleancli.planning.planners import goal_beam, policy_search
from cleancli.planning.registry import PLANNERS
from support import from_text, small_tasks

Slots = Mapping[tuple[int, int], float]


def goal_task(seed: int) -> Task:
    """A random task that pays for a goal alone: three of its variables at values that they do not have."""
    task = small_tasks.random_task(seed)
    goal: GroundCondition = tuple((v, frozenset({1 - min(task.initial[v], 1)})) for v in range(3))
    paid = RewardCondition(goal, Fraction(-1), Fraction(0))
    return replace(task, rewards=(paid,), goal=(goal,), counted=None)


def costs(task: Task, state: GroundState, together: bool) -> Slots:
    """What each variable with each of its values costs, by going over all rules until nothing changes. Of a
    rule's literals that is what they cost `together`, and of an outcome the tries that it takes; or what the
    dearest literal costs, and one."""
    found = dict.fromkeys(enumerate(state), 0.0)
    while True:
        before = dict(found)
        for rule in task.rules:
            cost = condition_cost(found, rule.condition, together)
            for outcome in rule.outcomes:
                if not outcome.probability or cost == math.inf:
                    continue
                more = cost + (1 / float(outcome.probability) if together else 1)
                for slot in outcome.effects:
                    found[slot] = min(found.get(slot, math.inf), more)
        if found == before:
            return found


def condition_cost(found: Slots, condition: GroundCondition, together: bool) -> float:
    literals = [min(found.get((v, x), math.inf) for x in values) for v, values in condition]
    return sum(literals) if together else max(literals, default=0.0)


def distance(task: Task) -> tuple[float, float]:
    process = prepare(task).process
    state = np.array(task.initial, dtype=np.int32)
    found: tuple[float, float] = relaxed.goal_distance(process, relaxed.relaxed(process), state)
    return found


@pytest.mark.parametrize("seed", range(12))
def test_a_goal_is_as_far_as_the_relaxed_task_says(seed: int) -> None:
    task = goal_task(seed)
    ways = [
        min(condition_cost(costs(task, task.initial, together), goal, together) for goal in task.goal)
        for together in (True, False)
    ]
    assert distance(task) == pytest.approx(tuple(ways))


@pytest.mark.parametrize("seed", range(12))
def test_no_goal_is_reached_earlier_than_it_can_be(seed: int) -> None:
    task = goal_task(seed)
    reached, steps = {task.initial}, 0
    while not any(reaches_goal(task, state) for state in reached) and steps < 12:
        reached, steps = set(after_any(task, reached)) | reached, steps + 1
    found = any(reaches_goal(task, state) for state in reached)
    assert not found or distance(task)[1] <= steps


def after_any(task: Task, states: Iterable[GroundState]) -> Iterable[GroundState]:
    for state in states:
        for action in range(len(task.actions)):
            yield from (after for _, after in successors(task, state, action))


@pytest.mark.parametrize("seed", range(6))
def test_a_way_leads_to_the_goal_by_some_outcomes(seed: int) -> None:
    task = goal_task(seed)
    way = goal_beam.sequence(prepare(task).process, task.initial, 8, 50)
    reached = {task.initial}
    for action in way:
        reached = {after for state in reached for _, after in successors(task, state, action)}
    assert not way or any(reaches_goal(task, state) for state in reached)


ROOMS = [f"r{i}" for i in range(12)]
CORRIDOR = """
domain corridor {
  types { room }
  predicates { at(?r - room)  next(?r ?s - room) [static]  lit(?r - room)  lost() }
  actions { go(?r ?s - room) }
  rule go_lit: go(?r, ?s) {
    when at(?r), next(?r, ?s), lit(?s), not lost()
    then 0.9: not at(?r), at(?s)
         0.1: nothing
  }
  rule go_dark: go(?r, ?s) {
    when at(?r), next(?r, ?s), not lit(?s), not lost()
    then 0.5: not at(?r), at(?s)
         0.5: lost()
  }
  reward { goal }
}
"""


def corridor(dark: str, around: bool) -> Task:
    """A corridor of twelve rooms, of which one is dark; perhaps with a way around it, longer by one."""
    facts = ["at(r0)", *(f"next({a}, {b})" for a, b in itertools.pairwise(ROOMS))]
    facts += [f"next({b}, {a})" for a, b in itertools.pairwise(ROOMS)]
    facts += [f"lit({room})" for room in ROOMS if room != dark]
    if around:
        facts += ["next(r0, x)", "next(x, y)", "next(y, r2)", "lit(x)", "lit(y)"]
    objects = f"objects {{ {' '.join(ROOMS)} x y - room }} init {{ {', '.join(facts)} }}"
    return from_text.task(CORRIDOR, f"{objects} goal {{ at(r11) }} horizon = 30 discount = 1")


def test_a_far_goal_is_hoped_for_where_no_run_reaches_it() -> None:
    """Twenty samples find no sequence of eleven actions."""
    task = corridor("x", around=False)
    planner = PLANNERS["prada+"].having(solve=0)
    plan = planner(prepare(task), Options(samples=20, seed=1))
    assert [str(action) for action in plan.actions[:2]] == ["go(r0, r1)", "go(r1, r2)"]


def test_hoping_sees_a_dead_end_that_is_near() -> None:
    """The straight way leads through the dark room, where one is lost half of the time."""
    task = corridor("r1", around=True)
    assert policy_search.goal_alone(task)
    prepared = prepare(task)
    way = policy_search.way_to_goal(prepared)
    hope = policy_search.hopeful(prepared, way, policy_search.Effort(300, None, 0))
    assert str(task.actions[hope.course.actions[0]]) == "go(r0, x)"


def test_what_also_pays_on_the_way_is_not_hoped_for() -> None:
    assert not policy_search.goal_alone(small_tasks.random_task(0))
    assert policy_search.goal_alone(goal_task(0))
    assert policy_search.prize(goal_task(0)) == 1.0
