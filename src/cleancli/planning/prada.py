"""PRADA (Lang and Toussaint 2010, §4.1): draw action sequences, value them by factored beliefs, keep one."""

from __future__ import annotations

import time
from collections.abc import Sequence
from types import ModuleType

import numpy as np

from cleancli.compiler.tables import Floats, Ints, Tables, lower
from cleancli.compiler.task import Task
from cleancli.planning.coverage import coverage, enough_samples
from cleancli.planning.plan import Options, Plan

MARGIN = 0.05
"""A plan must be worth more than doing nothing by this, as in the authors' implementation."""


def prada(task: Task, options: Options) -> Plan:
    """The best of the sampled sequences; empty where it is not worth `MARGIN` more than doing nothing."""
    times = [time.perf_counter()]
    tables = lower(task)
    times.append(time.perf_counter())
    inference = _inference()
    inference.best_sequence(tables, 0, task.discount, 1, 0)  # makes numba load or compile what it will run
    nothing = _value(task, tables, np.zeros(0, dtype=np.int32))
    times.append(time.perf_counter())
    samples = enough_samples(task, options.samples)
    best: Ints = inference.best_sequence(tables, task.horizon, task.discount, samples, options.seed)
    value = _value(task, tables, best)
    times.append(time.perf_counter())
    chosen = best if value > nothing + MARGIN else best[:0]
    return Plan(
        planner="prada",
        actions=tuple(task.actions[action] for action in chosen),
        value=value if chosen.size else nothing,
        samples=samples,
        horizon=task.horizon,
        coverage=coverage(task, samples),
        seconds=dict(zip(("lower", "compile", "search"), np.diff(times).tolist(), strict=True)),
    )


def plan_value(task: Task, actions: Sequence[int]) -> float:
    """Expected discounted reward of a sequence of action indices, by PRADA's factored belief.

    After its end nothing is done up to the horizon, as in `exact_value` of compiler/transition.py; but that
    does not treat variables as independent, as the belief does.
    """
    return _value(task, lower(task), np.asarray(actions, dtype=np.int32))


def _inference() -> ModuleType:
    """The one place that loads numba, which takes longer than most plans."""
    from cleancli.planning import inference

    return inference


def _value(task: Task, tables: Tables, actions: Ints) -> float:
    rewards: Floats = _inference().step_rewards(tables, actions, max(actions.size, task.horizon))
    return float(rewards @ task.discount ** np.arange(rewards.size))
