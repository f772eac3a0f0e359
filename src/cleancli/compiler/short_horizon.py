"""Goals that take more actions than a problem's plans may have, or than any number.

What can happen is taken to happen as one wishes, so what is told takes at least so many actions. States are
looked at one by one; of problems that have too many nothing is said.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from cleancli.compiler.semantics import changed, reaches_goal
from cleancli.compiler.task import GroundState, Task, holds
from cleancli.language.model import Problem

WORK = 200_000
"""Rules that are asked about states, which takes some tenths of a second. Chosen."""

SHORTEST = 10
"""No shorter horizon is advised. Chosen."""


@dataclass(frozen=True, slots=True)
class GoalDistance:
    """How many actions a goal takes at least: `least`, None where no number of them is enough. `exact`:
    whether so many may be enough; else the work was too much to find that out."""

    least: int | None
    exact: bool


@dataclass(frozen=True, slots=True)
class ShortHorizon:
    """A goal takes `least` actions, None where they were not found out, and the `horizon` is shorter."""

    horizon: int
    least: int | None


def goal_distance(task: Task) -> GoalDistance:
    """How far the goal is, as far as so much work finds it out; 0 where the task has no condition for one."""
    frontier, known, work, steps = [task.initial], {task.initial}, 0, 0
    while frontier:
        if not task.goal or any(reaches_goal(task, state) for state in frontier):
            return GoalDistance(steps, exact=True)
        work += len(frontier) * len(task.rules)
        if work > WORK:
            return GoalDistance(steps + 1, exact=False)
        found = dict.fromkeys(after for state in frontier for after in _after(task, state))
        frontier = [state for state in found if state not in known]
        known.update(frontier)
        steps += 1
    return GoalDistance(None, exact=True)


def out_of_reach(task: Task, problem: Problem) -> bool:
    """Whether it is known that the goal of a task's problem never holds, if it has one. The task has no
    conditions for it where what is static already rules it out."""
    return bool(problem.goal) and (not task.goal or goal_distance(task).least is None)


def dead_ends(task: Task, states: Iterable[GroundState]) -> int | None:
    """How many of the states are such that no action can lead to the goal any more; None where that is too
    much work to know of one of them."""
    counts = Counter(states)
    found = 0
    for state, times in counts.items():
        distance = goal_distance(replace(task, initial=state))
        if not distance.exact:
            return None
        found += times if distance.least is None else 0
    return found


def short_horizon(task: Task) -> ShortHorizon | None:
    """The horizon, where it is certain to be too short for the goal; None else, and where that cannot be
    known with so much work, where no number of actions is enough, or without goal or horizon."""
    if task.reaching is not None:
        return None
    found = goal_distance(task)
    if found.least is None or found.least <= task.horizon:
        return None
    return ShortHorizon(task.horizon, found.least if found.exact else None)


def longer_horizon(task: Task) -> int:
    """A horizon to try where that of a task is too short, or may be: twice as long, or twice what the goal
    takes at least, so that there is time for what fails and is tried again."""
    return max(2 * max(task.horizon, goal_distance(task).least or 0), SHORTEST)


def _after(task: Task, state: GroundState) -> Iterator[GroundState]:
    """The states that may follow by any action, but for this one."""
    outcomes = (each for rule in task.rules if holds(rule.condition, state) for each in rule.outcomes)
    return (changed(state, each.effects) for each in outcomes if each.probability and each.effects)
