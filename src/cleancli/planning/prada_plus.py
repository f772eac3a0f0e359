"""PRADA+: what PRADA finds, improved by annealing over drawn runs; small problems are solved exactly.

PRADA values a sequence by a belief whose variables are independent, and only ever draws new sequences. Here a
sequence is valued by runs of the process itself, and the next one to try is a change of a good one.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import ModuleType

from cleancli.planning.plan import Options, Plan
from cleancli.planning.prada import prada
from cleancli.planning.prepared import Prepared

CHAINS = 8
"""Annealings, each over runs of its own: what one overrates, the others do not. Chosen."""

BELIEF_SHARE = 20
"""PRADA draws one sequence for so many that are tried. Chosen."""

FRESH_RUNS = 1_000
"""Runs by which the best sequence of each chain is valued again, all by the same. Chosen."""

HEAT = 0.1
"""The first heat of a chain, as a share of what a step of the sequence that it starts from pays. Chosen."""

Actions = tuple[int, ...]


def prada_plus(prepared: Prepared, options: Options) -> Plan:
    """The best of about `samples` sequences, or of as many as `time_limit` allows; empty where it is not worth
    `margin` more than doing nothing.

    Its value is the mean of runs that chose nothing, so it is not too high for having been chosen.
    """
    task, times = prepared.task, [time.perf_counter()]
    _ = prepared.tables, prepared.process
    times.append(time.perf_counter())
    annealing = _annealing()
    annealing.chain(prepared, (), 0, 0.0, 0)  # makes numba load or compile what will run
    from_belief = _from_belief(prepared, options)
    times.append(time.perf_counter() - from_belief.seconds["search"])
    found, tried = _found(prepared, options, from_belief, annealing)
    nothing, _ = annealing.value(prepared, (), FRESH_RUNS, options.seed)
    best = max(found, key=lambda actions: annealing.value(prepared, actions, FRESH_RUNS, options.seed)[0])
    value, _ = annealing.value(prepared, best, FRESH_RUNS, options.seed + 1)
    times.append(time.perf_counter())
    worth_doing = value > nothing + options.margin
    return Plan(
        planner="prada+",
        actions=tuple(task.actions[action] for action in best) if worth_doing else (),
        value=value if worth_doing else nothing,
        measure="sampled",
        samples=tried,
        horizon=task.horizon,
        coverage=None,
        seconds=dict(
            zip(("lower", "compile", "search"), [b - a for a, b in zip(times, times[1:])], strict=True)
        ),
    )


def _from_belief(prepared: Prepared, options: Options) -> Plan:
    return prada(prepared, replace(options, samples=1 + options.samples // BELIEF_SHARE, time_limit=None))


def _found(prepared: Prepared, options: Options, starts: tuple[Actions, ...]) -> tuple[list[Actions], int]:
    """The best sequence of each chain, and how many sequences were tried in all.

    Without a time limit there are `CHAINS`, with one as many as there is time for, and at least one.
    """
    moves = -(-options.samples // CHAINS)
    deadline = None if options.time_limit is None else time.perf_counter() + options.time_limit
    annealing = _annealing()

    def chain(number: int) -> Actions:
        seed = options.seed * 4096 + number
        return annealing.chain(prepared, starts[number % len(starts)], moves, HEAT, seed)

    found: list[Actions] = []
    with ThreadPoolExecutor(options.threads) as pool:
        while len(found) < CHAINS if deadline is None else not found or time.perf_counter() < deadline:
            batch = range(len(found), len(found) + options.threads)
            found += pool.map(chain, batch)
    return found, moves * len(found)


def _annealing() -> ModuleType:
    """The one place that loads numba, which takes longer than most plans."""
    from cleancli.planning import annealing

    return annealing
