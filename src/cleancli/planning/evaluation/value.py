"""What a given sequence of actions is worth: by PRADA's factored belief, exactly, and by rollouts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.compiler.semantics import (
    SUPPORT_LIMIT,
    SupportTooLargeError,
    idle_earliness,
    idle_worth,
)
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.evaluation.belief_value import plan_value
from cleancli.planning.evaluation.forecast import FEW_STATES, drawn_course, exact_course
from cleancli.planning.evaluation.state_distribution import ahead, paying, spent
from cleancli.planning.plan import Options, PlanningRefused

RUNS = 100_000
"""Runs that value a sequence; at a spread of one dirty area the error is 0.003. Chosen."""


@dataclass(frozen=True, slots=True)
class Sampled:
    """The mean of so many rollouts, and its standard error."""

    value: float
    error: float
    runs: int


@dataclass(frozen=True, slots=True)
class Evaluation:
    """The expected discounted reward of a sequence up to the horizon, found in three ways.

    `exact` is None where more than `SUPPORT_LIMIT` states may occur. As libPRADA computes, rules may overlap,
    so there is neither an exact nor a sampled value.
    """

    factored: float
    exact: float | None
    sampled: Sampled | None


def evaluate(prepared: Prepared, actions: Sequence[int], options: Options, *, runs: int = RUNS) -> Evaluation:
    """The value of doing the actions, given by index, and then nothing up to the horizon; what lies beyond it
    does not count. Raises `PlanningRefused` where the problem has no horizon."""
    if prepared.task.reaching is not None:
        raise PlanningRefused(
            "a sequence is valued up to a horizon, and this problem's is unlimited",
            "state a number of actions, `horizon = 10`, or let `cleancli simulate` carry out policies",
        )
    actions = actions[: max(prepared.task.horizon, 0)]
    factored = plan_value(
        prepared.task, actions, rule_threshold=options.rule_threshold, compat=options.compat
    )
    if options.compat:
        return Evaluation(factored, None, None)
    return Evaluation(
        factored,
        exact(prepared, actions),
        sampled(prepared, actions, options.seed, runs),
    )


def exact(prepared: Prepared, actions: Sequence[int], limit: int = SUPPORT_LIMIT) -> float | None:
    """What `exact_value` of compiler/semantics.py says, by whole arrays; None beyond `limit` states."""
    task, p = prepared.task, prepared.process
    actions = actions[: max(task.horizon, 0)]
    try:
        course = exact_course(prepared, actions, limit)
    except SupportTooLargeError:
        return None
    paid, value, factor = [paying(p, spread) for spread in course], 0.0, 1.0
    for i, action in enumerate(actions):
        step = paid[i][0] - paid[i + 1][0] + paid[i + 1][1] - spent(p, course[i], action)
        value += factor * p.payment[action] * step
        factor *= p.discount[action]
    rest = idle_worth(task.discount, task.horizon - len(actions))[-1]
    return float(value + factor * rest * paid[-1][1])


def earliness(prepared: Prepared, actions: Sequence[int], seed: int, runs: int = RUNS // 10) -> float:
    """The earliness of a sequence (planning/preference.py): exact while few states may occur, else over drawn
    runs."""
    p, horizon = prepared.process, max(prepared.task.horizon, 0)
    actions = actions[:horizon]
    try:
        course = exact_course(prepared, actions, FEW_STATES)
    except SupportTooLargeError:
        course = drawn_course(prepared, actions, seed, runs)
    left, paid = [ahead(p, spread) for spread in course], [paying(p, spread)[1] for spread in course]
    progress = [left[step] - left[step + 1] + paid[step + 1] for step in range(len(actions))]
    early = sum((horizon - step) * each for step, each in enumerate(progress))
    return early + paid[-1] * idle_earliness(horizon - len(actions))


def sampled(prepared: Prepared, actions: Sequence[int], seed: int, runs: int = RUNS) -> Sampled:
    """The mean over runs that depend on the seed alone, so sequences are compared on the same draws."""
    task = prepared.task
    actions = actions[: max(task.horizon, 0)]
    idle = idle_worth(task.discount, task.horizon)
    mean, square = kernels.transitions.sequence_value(
        prepared.process,
        np.array(task.initial, dtype=np.int32),
        np.array(actions, dtype=np.int32),
        idle,
        runs,
        np.uint64(seed % 2**64),
    )
    return Sampled(float(mean), math.sqrt(max(square - mean**2, 0.0) / runs), runs)
