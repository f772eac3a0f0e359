"""PRADA (Lang and Toussaint 2010, §4.1): draw action sequences, value them by factored beliefs, keep one."""

from __future__ import annotations

import time
from collections.abc import Sequence
from types import ModuleType

import numpy as np

from cleancli.compiler.tables import Floats, Ints, lower
from cleancli.compiler.task import Task
from cleancli.planning.coverage import coverage, enough_samples
from cleancli.planning.plan import Options, Plan

MARGIN = 0.05
"""A plan must be worth more than this to be better than doing nothing, as in the authors' implementation."""


def prada(task: Task, options: Options) -> Plan:
    """The best of the sampled sequences; empty where it is not worth `MARGIN`."""
    times = [time.perf_counter()]
    tables = lower(task)
    times.append(time.perf_counter())
    inference = _inference()
    inference.best_sequence(tables, 0, task.discount, 1, 0)  # makes numba load or compile what it will run
    inference.step_rewards(tables, np.zeros(0, dtype=np.int32))
    times.append(time.perf_counter())
    samples = enough_samples(task, options.samples)
    best: Ints = inference.best_sequence(tables, task.horizon, task.discount, samples, options.seed)
    value = _discounted(inference.step_rewards(tables, best), task.discount)
    times.append(time.perf_counter())
    chosen = best if value > MARGIN else best[:0]
    return Plan(
        planner="prada",
        actions=tuple(task.actions[action] for action in chosen),
        value=value if chosen.size else 0.0,
        samples=samples,
        horizon=task.horizon,
        coverage=coverage(task, samples),
        seconds=dict(zip(("lower", "compile", "search"), np.diff(times).tolist(), strict=True)),
    )


def plan_value(task: Task, actions: Sequence[int]) -> float:
    """Expected discounted reward (eq. 2) of a sequence of action indices, by PRADA's factored belief.

    The belief treats variables as independent; `exact_value` of compiler/transition.py does not.
    """
    sequence = np.asarray(actions, dtype=np.int32)
    return _discounted(_inference().step_rewards(lower(task), sequence), task.discount)


def _inference() -> ModuleType:
    """The one place that loads numba, which takes longer than most plans."""
    from cleancli.planning import inference

    return inference


def _discounted(rewards: Floats, discount: float) -> float:
    return float(rewards @ discount ** np.arange(rewards.size))
