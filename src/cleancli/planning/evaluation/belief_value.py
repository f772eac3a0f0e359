"""What a sequence of actions is worth, and what is believed after each, by PRADA's factored belief."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cleancli.array_types import Floats, Ints
from cleancli.compiler.lowering.belief_tables import Tables, lower
from cleancli.compiler.task import Task
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared


def plan_value(
    task: Task, actions: Sequence[int], *, rule_threshold: float = 0.03, compat: bool = False
) -> float:
    """Expected discounted reward of a sequence of action indices, by PRADA's factored belief.

    After its end nothing is done up to the horizon, and what lies beyond it does not count, as in
    `exact_value` of compiler/semantics.py; but that does not treat variables as independent, as the belief
    does."""
    actions = actions[: max(task.horizon, 0)]
    tables = lower(task, independent=compat)
    return float(worth_of(task, tables, rule_threshold, [np.asarray(actions, dtype=np.int32)])[0][0])


def plan_beliefs(prepared: Prepared, actions: Sequence[int], rule_threshold: float) -> Floats:
    """PRADA's factored belief before the first action and after each: the probability of each value of each
    variable (actions + 1, S)."""
    initial = prepared.task.initial
    return kernels.belief_search.beliefs(prepared.tables, initial, actions, threshold=rule_threshold)


def worth_of(
    task: Task, tables: Tables, threshold: float, sequences: Sequence[Ints]
) -> tuple[Floats, Floats]:
    """The values of sequences of action indices, and their earliness (planning/preference.py)."""
    steps = max(task.horizon, 0)
    rewards, progress = kernels.belief_search.step_rewards(
        tables, task.initial, sequences, steps, threshold=threshold
    )
    factors = np.zeros_like(rewards)
    for row, actions in enumerate(sequences):
        discount, payment = np.full(steps, task.discount), np.ones(steps)
        discount[: actions.size] = tables.discount[actions]
        payment[: actions.size] = tables.payment[actions]
        factors[row] = payment * np.cumprod(np.concatenate([[1.0], discount]))[:-1]
    return (rewards * factors).sum(axis=1), progress @ (steps - np.arange(steps))
