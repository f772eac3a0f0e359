"""What a task means, state by state: the exact process that planners approximate and simulations sample.

Guaranteed by `ground`: at most one rule of an action covers a state, and its probabilities sum to 1.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping, Sequence

import numpy as np

from cleancli.compiler.task import Assignment, GroundRule, Task, holds

SUPPORT_LIMIT = 100_000
"""Most states that an exact distribution may have. Chosen."""


class SupportTooLargeError(ValueError):
    """An exact distribution grew beyond `SUPPORT_LIMIT` states."""


def covering_rule(task: Task, assignment: Assignment, action: int) -> GroundRule | None:
    """The one rule of the action (an index) that covers the state; None where the default rule does."""
    start = bisect_left(task.rules, action, key=lambda rule: rule.action)
    for rule in task.rules[start:]:
        if rule.action != action:
            break
        if holds(rule.condition, assignment):
            return rule
    return None


def successors(task: Task, assignment: Assignment, action: int) -> tuple[tuple[float, Assignment], ...]:
    """The states that may follow, each once, with probabilities that sum to 1.

    Noise, nothing and the default rule leave the modelled state as it is.
    """
    rule = covering_rule(task, assignment, action)
    if rule is None:
        return ((1.0, assignment),)
    probability: dict[Assignment, float] = {}
    for outcome in rule.outcomes:
        if outcome.probability > 0:
            after = _changed(assignment, outcome.effects)
            probability[after] = probability.get(after, 0.0) + outcome.probability
    return tuple((p, after) for after, p in probability.items())


def sample(
    task: Task, assignment: Assignment, action: int, rng: np.random.Generator
) -> tuple[int | None, Assignment]:
    """A drawn outcome's index in its rule (None where no rule covers the state) and the state after it."""
    rule = covering_rule(task, assignment, action)
    if rule is None:
        return None, assignment
    cumulated = np.cumsum([outcome.probability for outcome in rule.outcomes])
    # Rounding keeps the sum from being exactly 1: scaled by it, no draw falls beyond the last outcome.
    drawn = int(np.searchsorted(cumulated, rng.random() * cumulated[-1], side="right"))
    return drawn, _changed(assignment, rule.outcomes[drawn].effects)


def count(task: Task, assignment: Assignment) -> int:
    """How many of the counted conditions hold, those that always do included."""
    return task.counted_always + sum(holds(condition, assignment) for condition in task.counted)


def reward(task: Task, before: Assignment, after: Assignment) -> float:
    """The decrease of the count (eq. 2)."""
    return float(count(task, before) - count(task, after))


def forward(task: Task, distribution: Mapping[Assignment, float], action: int) -> dict[Assignment, float]:
    """The exact distribution after an action. Raises `SupportTooLargeError` beyond `SUPPORT_LIMIT` states."""
    after: dict[Assignment, float] = {}
    for assignment, mass in distribution.items():
        for probability, successor in successors(task, assignment, action):
            after[successor] = after.get(successor, 0.0) + mass * probability
        if len(after) > SUPPORT_LIMIT:
            raise SupportTooLargeError(f"more than {SUPPORT_LIMIT} states; value the plan by sampling")
    return after


def exact_value(task: Task, actions: Sequence[int]) -> float:
    """Expected discounted reward (eq. 2) of executing all the actions, given by index, whatever happens.

    Raises `SupportTooLargeError` where the states that may occur are too many.
    """
    distribution: dict[Assignment, float] = {task.initial: 1.0}
    expected, value = float(count(task, task.initial)), 0.0
    for step, action in enumerate(actions):
        distribution = forward(task, distribution, action)
        remaining = sum(mass * count(task, assignment) for assignment, mass in distribution.items())
        value += task.discount**step * (expected - remaining)
        expected = remaining
    return value


def _changed(assignment: Assignment, effects: Sequence[tuple[int, int]]) -> Assignment:
    values = list(assignment)
    for variable, value in effects:
        values[variable] = value
    return tuple(values)
