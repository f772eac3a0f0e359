"""PRADA+: what PRADA finds, improved by annealing over drawn runs.

PRADA values a sequence by a belief whose variables are independent, and only ever draws new sequences. Here a
sequence is valued by runs of the process itself, and the next one to try is a change of a good one.
"""

from __future__ import annotations

import itertools
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import ModuleType

from cleancli.planning.plan import Options, Plan
from cleancli.planning.prada import prada
from cleancli.planning.prepared import Prepared

CHAINS = 4
"""Annealings, each over runs of its own: what one overrates, the others do not. Chosen."""

BELIEF_SHARE = 20
"""PRADA draws one sequence for so many that are tried. Chosen."""

WORDS, FRESH_WORDS = 4, 64
"""A chain values sequences by 64 runs a word, and what it finds is valued again by fresh ones. Chosen."""

Actions = tuple[int, ...]


def prada_plus(prepared: Prepared, options: Options) -> Plan:
    """The best of about `samples` sequences, or of as many as `time_limit` allows; empty where it is not
    worth `margin` more than doing nothing.

    Its value is the mean of runs that chose nothing, so it is not too high for having been chosen.
    """
    task, times = prepared.task, [time.perf_counter()]
    _ = prepared.tables, prepared.process
    times.append(time.perf_counter())
    annealing = _annealing()
    annealing.chain(prepared, (), 0, WORDS, 0)  # makes numba load or compile what will run
    drawn = prada(prepared, replace(options, samples=1 + options.samples // BELIEF_SHARE, time_limit=None))
    times.append(time.perf_counter() - drawn.seconds["search"])
    number = {action: index for index, action in enumerate(task.actions)}
    plans = (drawn.actions, options.previous)
    starts = [tuple(number[action] for action in plan if action in number) for plan in plans]
    found, tried = _annealed(prepared, options, starts)
    nothing: float = annealing.value(prepared, (), FRESH_WORDS, options.seed)
    best = max(found, key=lambda actions: annealing.value(prepared, actions, FRESH_WORDS, options.seed))
    value: float = annealing.value(prepared, best, FRESH_WORDS, options.seed + 1)
    times.append(time.perf_counter())
    worth_doing = value > nothing + options.margin
    spent = [after - before for before, after in itertools.pairwise(times)]
    return Plan(
        planner="prada+",
        actions=tuple(task.actions[action] for action in best) if worth_doing else (),
        value=value if worth_doing else nothing,
        measure="sampled",
        samples=tried,
        horizon=task.horizon,
        coverage=None,
        seconds=dict(zip(("lower", "compile", "search"), spent, strict=True)),
    )


def _annealed(prepared: Prepared, options: Options, starts: list[Actions]) -> tuple[list[Actions], int]:
    """The best sequence of each chain, and how many sequences were tried in all.

    Without a time limit there are `CHAINS`; with one, as many as there is time for, and at least one.
    """
    moves = -(-options.samples // CHAINS)
    deadline = None if options.time_limit is None else time.perf_counter() + options.time_limit
    annealing = _annealing()

    def chain(index: int) -> Actions:
        seed = options.seed * 2**16 + index
        best: Actions = annealing.chain(prepared, starts[index % len(starts)], moves, WORDS, seed)
        return best

    found: list[Actions] = []
    with ThreadPoolExecutor(options.threads) as pool:
        while len(found) < CHAINS if deadline is None else not found or time.perf_counter() < deadline:
            found += pool.map(chain, range(len(found), len(found) + options.threads))
    return found, moves * len(found)


def _annealing() -> ModuleType:
    """The one place that loads numba, which takes longer than most plans."""
    from cleancli.planning import annealing

    return annealing
