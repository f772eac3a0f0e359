"""PRADA (Lang and Toussaint 2010, §4.1): draw action sequences, value them by factored beliefs, keep one."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from cleancli.array_types import Floats, Ints
from cleancli.compiler.lowering.belief_tables import lower
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.evaluation.belief_value import worth_of
from cleancli.planning.evaluation.coverage import coverage, enough_samples
from cleancli.planning.plan import Options, Plan, option
from cleancli.planning.preference import preferred

Worth = Callable[[Sequence[Ints]], tuple[Floats, Floats]]
"""`worth_of` (planning/evaluation/belief_value.py) in one task."""


@dataclass(frozen=True, slots=True)
class PradaOptions:
    """A plan must be worth more than doing nothing by more than the `margin`."""

    margin: float = option(0.05, 0, math.inf)


def prada(prepared: Prepared, options: Options, own: PradaOptions) -> Plan:
    """The best of the sampled sequences; empty where it is not worth `margin` more than doing nothing."""
    return best_sampled("prada", prepared, options, own, lambda actions, worth: actions)


def best_sampled(
    planner: str,
    prepared: Prepared,
    options: Options,
    own: PradaOptions,
    improved: Callable[[Ints, Worth], Ints],
) -> Plan:
    """What the planner of that name makes of the best of the sampled sequences."""
    task, limit = prepared.task, options.time_limit
    times = [time.perf_counter()]
    tables = lower(task, independent=True) if options.compat else prepared.tables
    worth = partial(worth_of, task, tables, options.rule_threshold)
    times.append(time.perf_counter())
    draw = partial(
        kernels.belief_search.best_sequence, tables, task.initial, threshold=options.rule_threshold
    )
    draw(0, task.discount, 1, 0)  # makes numba load or compile what will run
    nothing, latest = (float(found[0]) for found in worth([np.zeros(0, dtype=np.int32)]))
    times.append(time.perf_counter())
    best, samples = draw(
        task.horizon,
        task.discount,
        enough_samples(task, options.samples),
        options.seed,
        threads=options.threads,
        deadline=None if limit is None else times[-1] + limit,
    )
    best = improved(best, worth)
    value, early = (float(found[0]) for found in worth([best]))
    times.append(time.perf_counter())
    worthy = preferred(value, early, nothing, latest)
    if own.margin > 0:
        worthy = value > nothing + own.margin
    chosen = best if worthy else best[:0]
    return Plan(
        planner=planner,
        actions=tuple(task.actions[action] for action in chosen),
        value=value if chosen.size else nothing,
        measure="factored",
        samples=samples,
        horizon=task.horizon,
        coverage=coverage(task, samples),
        seconds=dict(zip(("lower", "compile", "search"), np.diff(times).tolist(), strict=True)),
    )
