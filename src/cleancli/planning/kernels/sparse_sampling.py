"""Sparse sampling, compiled: the value of a state from a few drawn results of each action, and so on.

The meaning is that of compiler/semantics.py. Guaranteed by `lower_process`: at most one rule of an action
covers a state.
"""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Floats, Ints
from cleancli.compiler.lowering.state_tables import Process
from cleancli.compiler.semantics import idle_worth
from cleancli.compiler.task import GroundState
from cleancli.planning.kernels.jit import better, njit, standing_earliness
from cleancli.planning.kernels.rng import GOLDEN, mixed, uniform
from cleancli.planning.kernels.transitions import apply, choosable, draw, rewarded


@njit(cache=True, nogil=True)
def _look_ahead(
    p: Process,
    rows: Ints,
    counts: Ints,
    best: Ints,
    idle: Floats,
    branching: int,
    level: int,
    stream: np.uint64,
) -> tuple[float, float]:
    """The value of the state in a row of `rows` and its earliness (planning/preference.py); there is a row
    per step that is looked ahead and one more. Leaves the best action (-1: to stop) in `best`.

    `idle` (steps + 1,) is what a reward of 1 in each of so many last steps is worth. In the last row nothing
    is done any more. `counts` (rows, most outcomes of a rule) is 0 between uses."""
    decreasing, standing, ahead = rewarded(p, rows[level])
    left = len(idle) - 1 - level
    value, earliness, chosen = float(standing * idle[left]), float(standing * standing_earliness(left)), -1
    for action in range(len(p.cost) if level < len(rows) - 1 else 0):
        rule = choosable(p, rows[level], action)
        if rule < 0:
            continue
        first = p.outcome_start[rule]
        for _ in range(branching):
            stream += GOLDEN
            counts[level, draw(p, rule, uniform(stream)) - first] += 1
        paid, gained, later, early = 0.0, 0.0, 0.0, 0.0
        for outcome in range(first, p.outcome_start[rule + 1]):
            count = counts[level, outcome - first]
            if count > 0:
                counts[level, outcome - first] = 0
                for v in range(rows.shape[1]):  # assigning the row would compile for seconds
                    rows[level + 1, v] = rows[level, v]
                apply(p, rows[level + 1], outcome)
                left_over, after, still = rewarded(p, rows[level + 1])
                paid += count * (decreasing - left_over + after - p.outcome_cost[outcome])
                gained += count * (ahead - still + after)
                stream = mixed(stream + GOLDEN)
                worth, soon = _look_ahead(p, rows, counts, best, idle, branching, level + 1, stream)
                later += count * worth
                early += count * soon
        total = p.payment[action] * (paid / branching - p.cost[action])
        total += p.discount[action] * later / branching
        early = (left * gained + early) / branching
        if better(total, early, value, earliness):
            value, earliness, chosen = total, early, action
    best[level] = chosen
    return value, earliness


def look_ahead(
    process: Process,
    initial: GroundState,
    discount: float,
    *,
    horizon: int,
    depth: int,
    branching: int,
    seed: int,
) -> tuple[float, int]:
    """The value of a state with `horizon` steps left, and the best action (-1: to stop)."""
    depth = max(min(depth, horizon), 0)
    rows = np.zeros((depth + 1, len(process.sizes)), dtype=np.int32)
    rows[0] = initial
    counts = np.zeros((depth + 1, int(np.diff(process.outcome_start).max(initial=0))), dtype=np.int32)
    best = np.full(depth + 1, -1, dtype=np.int32)
    idle = idle_worth(discount, horizon)
    stream = np.uint64(seed % 2**64)  # compiled functions return their uint64 as int, which is another type
    value, _ = _look_ahead(process, rows, counts, best, idle, branching, 0, stream)
    return float(value), int(best[0])
