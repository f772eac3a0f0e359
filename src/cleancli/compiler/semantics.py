"""What a task means, state by state: the exact process that planners approximate and simulations sample.

Guaranteed by `ground`: at most one rule of an action covers a state, and its probabilities sum to 1.
"""

from __future__ import annotations

import itertools
from bisect import bisect_left
from collections.abc import Mapping, Sequence

import numpy as np

from cleancli.array_types import Floats
from cleancli.compiler.task import GroundRule, GroundState, Task, holds

SUPPORT_LIMIT = 100_000
"""Most states that an exact distribution may have. Chosen."""


class SupportTooLargeError(ValueError):
    """An exact distribution grew beyond `SUPPORT_LIMIT` states."""


def covering_rule(task: Task, assignment: GroundState, action: int) -> GroundRule | None:
    """The one rule of the action (an index) that covers the state; None where the default rule does."""
    start = bisect_left(task.rules, action, key=lambda rule: rule.action)
    for rule in task.rules[start:]:
        if rule.action != action:
            break
        if holds(rule.condition, assignment):
            return rule
    return None


def successors(task: Task, assignment: GroundState, action: int) -> tuple[tuple[float, GroundState], ...]:
    """The states that may follow, each once, with probabilities that sum to 1.

    Noise, nothing and the default rule leave the modelled state as it is.
    """
    rule = covering_rule(task, assignment, action)
    if rule is None:
        return ((1.0, assignment),)
    probability: dict[GroundState, float] = {}
    for outcome in rule.outcomes:
        if outcome.probability > 0:
            after = changed(assignment, outcome.effects)
            probability[after] = probability.get(after, 0.0) + float(outcome.probability)
    return tuple((p, after) for after, p in probability.items())


def sample(
    task: Task, assignment: GroundState, action: int, rng: np.random.Generator
) -> tuple[int | None, GroundState]:
    """A drawn outcome's index in its rule (None where no rule covers the state) and the state after it."""
    rule = covering_rule(task, assignment, action)
    if rule is None:
        return None, assignment
    cumulated = [float(p) for p in itertools.accumulate(outcome.probability for outcome in rule.outcomes)]
    drawn = int(np.searchsorted(cumulated, rng.random(), side="right"))
    return drawn, changed(assignment, rule.outcomes[drawn].effects)


def decreasing(task: Task, assignment: GroundState) -> float:
    """What is paid for its decrease: the weighted number of conditions that hold (#dirt of eq. 2)."""
    return float(sum(r.decrease for r in task.rewards if holds(r.condition, assignment)))


def standing(task: Task, assignment: GroundState) -> float:
    """What a step that ends in this state is paid for the state alone."""
    return float(task.constant_reward + sum(r.state for r in task.rewards if holds(r.condition, assignment)))


def reward(task: Task, before: GroundState, action: int | None, after: GroundState) -> float:
    """The reward of a step by an action, given by index, but for what its outcome pays; None for a step after
    the end of a plan (eq. 2, and what else is paid)."""
    cost = 0.0 if action is None else float(task.actions[action].cost)
    return decreasing(task, before) - decreasing(task, after) + standing(task, after) - cost


def outcome_cost(task: Task, assignment: GroundState, action: int) -> float:
    """What the reward of a step loses on average by which outcome of the action happens."""
    rule = covering_rule(task, assignment, action)
    outcomes = () if rule is None else rule.outcomes
    return float(sum(outcome.probability * outcome.cost for outcome in outcomes))


def reaches_goal(task: Task, assignment: GroundState) -> bool:
    """Whether the problem's goal holds; never without one."""
    return any(holds(condition, assignment) for condition in task.goal)


def progress(task: Task, before: GroundState, after: GroundState) -> float:
    """What a step is paid without what its action and outcome cost, and 1 if the goal comes to hold in it (-1
    if it is lost)."""
    reached = reaches_goal(task, after) - reaches_goal(task, before)
    return reward(task, before, None, after) + reached


def forward(task: Task, distribution: Mapping[GroundState, float], action: int) -> dict[GroundState, float]:
    """The exact distribution after an action. Raises `SupportTooLargeError` beyond `SUPPORT_LIMIT` states."""
    after: dict[GroundState, float] = {}
    for assignment, mass in distribution.items():
        for probability, successor in successors(task, assignment, action):
            after[successor] = after.get(successor, 0.0) + mass * probability
        if len(after) > SUPPORT_LIMIT:
            raise SupportTooLargeError(f"more than {SUPPORT_LIMIT} states; value the plan by sampling")
    return after


def exact_value(task: Task, actions: Sequence[int]) -> float:
    """Expected discounted reward of executing the actions, given by index, whatever happens, up to the
    horizon.

    From their end to the horizon nothing is done, and the state is paid for what it is; so a sequence gains
    nothing by stopping. Actions beyond the horizon do not count. Raises `SupportTooLargeError` where the
    states that may occur are too many."""
    actions = actions[: max(task.horizon, 0)]
    distribution: dict[GroundState, float] = {task.initial: 1.0}
    expected, value = decreasing(task, task.initial), 0.0
    paid, factor = standing(task, task.initial), 1.0
    for action in actions:
        by_outcome = sum(mass * outcome_cost(task, s, action) for s, mass in distribution.items())
        distribution = forward(task, distribution, action)
        remaining = sum(mass * decreasing(task, s) for s, mass in distribution.items())
        paid = sum(mass * standing(task, s) for s, mass in distribution.items())
        step = expected - remaining - float(task.actions[action].cost) - by_outcome + paid
        value += factor * payment(task, action) * step
        factor *= task.discounts[action]
        expected = remaining
    return value + factor * paid * float(idle_worth(task.discount, task.horizon - len(actions))[-1])


def payment(task: Task, action: int) -> float:
    """What a step's reward by the action is multiplied by: it comes when the action ends, so an action that
    takes longer than a step (`by_time`) earns less; 1 where steps discount."""
    return task.discounts[action] / task.discount if task.discount else 1.0


def idle_worth(discount: float, steps: int) -> Floats:
    """What a reward of 1 in each of 0 to `steps` steps (none if negative) is worth at their start, a number
    for each; that is what standing still is paid by, up to the horizon."""
    return np.concatenate([[0.0], np.cumsum(discount ** np.arange(max(steps, 0)))])


def idle_earliness(steps: int) -> int:
    """The earliness (planning/preference.py) of a progress of 1 in each of so many last steps."""
    return max(steps, 0) * (max(steps, 0) + 1) // 2


def changed(assignment: GroundState, effects: Sequence[tuple[int, int]]) -> GroundState:
    """The state with what an outcome sets."""
    values = list(assignment)
    for variable, value in effects:
        values[variable] = value
    return tuple(values)
