"""The best that can be done, slow and obvious, as docs/planning.md ("Acting and stopping") says it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

from cleancli.compiler.semantics import (
    covering_rule,
    forward,
    payment,
    progress,
    reward,
    standing,
    successors,
)
from cleancli.compiler.task import GroundState, Task

SAME = 1e-9

Best = tuple[float, float, int | None]
"""A value, its earliness, and what is done first; None: stop."""


def optimum(task: Task) -> Callable[[GroundState, int], Best]:
    """What is best in a state with so many steps left."""

    @cache
    def best(state: GroundState, left: int) -> Best:
        options = [stop(state, left)]
        for action in range(len(task.actions)):
            if left > 0 and covering_rule(task, state, action) is not None:
                options.append(act(state, left, action))
        most = max(value for value, _, _ in options)
        good = [option for option in options if option[0] >= most - SAME]
        soonest = max(earliness for _, earliness, _ in good)
        return next(option for option in good if option[1] >= soonest - SAME)  # stopping first, then in order

    def stop(state: GroundState, left: int) -> Best:
        paid = standing(task, state)
        return (
            sum(paid * task.discount**k for k in range(left)),
            sum(paid * (left - k) for k in range(left)),
            None,
        )

    def act(state: GroundState, left: int, action: int) -> Best:
        value = earliness = 0.0
        for chance, after in successors(task, state, action):
            later, late, _ = best(after, left - 1)
            paid = payment(task, action) * reward(task, state, action, after)
            value += chance * (paid + task.discounts[action] * later)
            earliness += chance * (left * progress(task, state, after) + late)
        return value, earliness, action

    return best


def earliness(task: Task, actions: Sequence[int]) -> float:
    """Of a sequence that is carried out whatever happens."""
    distribution, total = {task.initial: 1.0}, 0.0
    for step, action in enumerate(actions[: task.horizon]):
        total += (task.horizon - step) * sum(
            mass * chance * progress(task, state, after)
            for state, mass in distribution.items()
            for chance, after in successors(task, state, action)
        )
        distribution = forward(task, distribution, action)
    paid = sum(mass * standing(task, state) for state, mass in distribution.items())
    return total + sum(paid * (task.horizon - step) for step in range(len(actions), task.horizon))
