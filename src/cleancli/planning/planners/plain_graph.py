"""The states of a small task and the best policy over them in plain Python, before compiled code is loaded.

Loading numba and a loop takes a tenth of a second, which is longer than plain Python needs for some dozens of
states. All is added up in the order of planning/kernels/state_graph.py, so the numbers are the same to the
last bit, and no plan depends on what has been loaded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cleancli.array_types import Floats, Ints
from cleancli.compiler.semantics import idle_earliness, idle_worth, payment
from cleancli.compiler.task import GroundCondition, GroundState, Task, advances, asked, holds
from cleancli.planning.preference import preferred

WORK = 20_000
"""Rules asked about states, and transitions valued in steps, up to which a task is small. Chosen: ten
milliseconds."""

FEW_STATES = 20
"""Where so many states a step would be too much work, no state is looked at. Chosen."""


@dataclass(frozen=True, slots=True)
class _Choice:
    """An action (an index), what its step is expected to pay without its `payment`, the step's expected
    progress, and the states (numbers) that may follow, each with its probability."""

    action: int
    reward: float
    progress: float
    after: tuple[tuple[int, float], ...]


@dataclass(frozen=True, slots=True)
class _Rule:
    """A rule of an action, with the outcomes that can happen."""

    action: int
    condition: GroundCondition
    outcomes: tuple[tuple[float, tuple[tuple[int, int], ...]], ...]


@dataclass(slots=True)
class PlainGraph:
    """The states that can be reached from one, numbered as they are found. `paid` has for each what is paid
    for its decrease, what a step that ends in it is paid, and whose decrease is progress; `within` how many
    states are found within 0, 1, ... steps. States that were found in the last step have no choices."""

    numbers: dict[GroundState, int]
    paid: list[tuple[float, float, float]]
    choices: list[tuple[_Choice, ...]] = field(default_factory=list)
    within: list[int] = field(default_factory=lambda: [1])
    transitions: int = 0

    @property
    def number(self) -> int:
        """States found."""
        return len(self.numbers)

    def index(self, state: GroundState) -> int:
        """The number of a state; -1 where it was not found."""
        return self.numbers.get(state, -1)


def may_be_small(task: Task) -> bool:
    """Whether it is worth while to look at the states of a task."""
    return len(task.rules) * task.horizon * FEW_STATES <= WORK


def small_graph(task: Task) -> PlainGraph | None:
    """All that can be reached within the task's horizon; None where that would be too much work."""
    graph, rules = PlainGraph({task.initial: 0}, [_paid(task, task.initial)]), _rules(task)
    for _ in range(task.horizon):
        frontier = list(graph.numbers)[len(graph.choices) :]
        for state in frontier:
            graph.choices.append(_choices(task, rules, graph, state))
            if len(graph.choices) * len(rules) + task.horizon * graph.transitions > WORK:
                return None
        if frontier:
            graph.within.append(graph.number)
    return graph


def backward(graph: PlainGraph, task: Task) -> tuple[Floats, Ints]:
    """Optimal values (horizon + 1, N) and actions (horizon, N), as the compiled `backward` has them."""
    horizon = max(task.horizon, 0)
    values, best = np.zeros((horizon + 1, graph.number)), np.full((horizon, graph.number), -1, np.int32)
    payments = [payment(task, action) for action in range(len(task.actions))]
    idle, later = idle_worth(task.discount, horizon).tolist(), list[tuple[float, float]]()
    for left in range(1, horizon + 1):
        known = graph.within[min(horizon - left, len(graph.within) - 1)]
        now = []
        for state in range(known):
            standing = graph.paid[state][1]
            stopping = standing * idle[left], standing * idle_earliness(left)
            choices = graph.choices[state] if state < len(graph.choices) else ()
            action, value, earliness = _best(task, payments, choices, left, later, stopping)
            now.append((value, earliness))
            values[horizon - left, state], best[horizon - left, state] = value, action
        later = now
    return values, best


def _best(
    task: Task,
    payments: Sequence[float],
    choices: Sequence[_Choice],
    left: int,
    later: Sequence[tuple[float, float]],
    stopping: tuple[float, float],
) -> tuple[int, float, float]:
    """The action that is best with so many steps left (-1 to stop), its value and its earliness
    (planning/preference.py)."""
    (value, earliness), action = stopping, -1
    most = value
    for choice in choices:
        expected, early = 0.0, left * choice.progress
        for after, probability in choice.after if left > 1 else ():
            expected += probability * later[after][0]
            early += probability * later[after][1]
        total = payments[choice.action] * choice.reward + task.discounts[choice.action] * expected
        if preferred(total, early, most, earliness):
            action, value, earliness = choice.action, total, early
        most = max(most, total)
    return action, value, earliness


def _choices(
    task: Task, rules: Sequence[_Rule], graph: PlainGraph, state: GroundState
) -> tuple[_Choice, ...]:
    """The choices in a state; adds the states that may follow."""
    found = []
    number = graph.numbers[state]
    decreasing, _, ahead = graph.paid[number]
    for rule in rules:
        if not holds(rule.condition, state):
            continue
        reward, progress, after = -float(task.actions[rule.action].cost), 0.0, dict[int, float]()
        for probability, effects in rule.outcomes:
            successor = _entered(task, graph, state, effects)
            left, standing, still = graph.paid[successor]
            reward += probability * (decreasing - left + standing)
            progress += probability * (ahead - still + standing)
            after[successor] = after.get(successor, 0.0) + probability
        if task.waiting or list(after) != [number]:
            found.append(_Choice(rule.action, reward, progress, tuple(after.items())))
            graph.transitions += len(after)
    return tuple(found)


def _entered(task: Task, graph: PlainGraph, state: GroundState, effects: Sequence[tuple[int, int]]) -> int:
    """The number of the state after an outcome."""
    values = list(state)
    for variable, value in effects:
        values[variable] = value
    after = tuple(values)
    number = graph.numbers.setdefault(after, graph.number)
    if number == len(graph.paid):
        graph.paid.append(_paid(task, after))
    return number


def _rules(task: Task) -> list[_Rule]:
    return [
        _Rule(
            rule.action,
            rule.condition,
            tuple((float(o.probability), o.effects) for o in rule.outcomes if o.probability),
        )
        for rule in task.rules
    ]


def _paid(task: Task, state: GroundState) -> tuple[float, float, float]:
    decreasing, standing, ahead = 0.0, float(task.constant_reward), 0.0
    for each, advance in zip(asked(task), advances(task), strict=True):
        if holds(each.condition, state):
            decreasing += float(each.decrease)
            standing += float(each.state)
            ahead += advance
    return decreasing, standing, ahead
