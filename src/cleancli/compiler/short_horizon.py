"""Goals that take more actions than a problem's plans may have.

What can happen is taken to happen as one wishes, so what is told takes at least so many actions. States are
looked at one by one; of problems that have too many nothing is said.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from cleancli.compiler.semantics import reaches_goal
from cleancli.compiler.task import GroundState, Task, holds

WORK = 200_000
"""Rules that are asked about states, which takes some tenths of a second. Chosen."""


@dataclass(frozen=True, slots=True)
class ShortHorizon:
    """A goal takes `least` actions, None where they were not found out, and the `horizon` is shorter."""

    horizon: int
    least: int | None


def short_horizon(task: Task) -> ShortHorizon | None:
    """The horizon, where it is certain to be too short for the goal; None else, and where that cannot be
    known with so much work, where no number of actions is known to be enough, or without goal or horizon."""
    if not task.goal or task.reaching is not None:
        return None
    frontier, known, work, steps = [task.initial], {task.initial}, 0, 0
    while frontier:
        if any(reaches_goal(task, state) for state in frontier):
            return ShortHorizon(task.horizon, steps) if steps > task.horizon else None
        work += len(frontier) * len(task.rules)
        if work > WORK:
            return ShortHorizon(task.horizon, None) if steps >= task.horizon else None
        found = dict.fromkeys(after for state in frontier for after in _after(task, state))
        frontier = [state for state in found if state not in known]
        known.update(frontier)
        steps += 1
    return None


def _after(task: Task, state: GroundState) -> Iterator[GroundState]:
    """The states that may follow by any action."""
    for rule in task.rules:
        if holds(rule.condition, state):
            for outcome in rule.outcomes:
                if outcome.probability and outcome.effects:
                    values = list(state)
                    for variable, value in outcome.effects:
                        values[variable] = value
                    yield tuple(values)
