"""Calls the compiled annealing with the memory that it works in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cleancli.array_types import Ints
from cleancli.compiler.semantics import idle_worth
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.kernels import bit_parallel

HEAT = 0.1
"""A chain's first heat, as a share of what an action of its best sequence adds. Chosen."""

KEPT = 2048
"""Draws of a rule's outcomes that are kept. Chosen: fits a cache of the second level."""


def chain(prepared: Prepared, start: Sequence[int], moves: int, words: int, seed: int) -> tuple[int, ...]:
    """The best sequence that `moves` changes of a sequence lead to, by 64 · `words` runs of the seed."""
    runs, common = _begun(prepared, words)
    horizon = len(runs.row) - 1
    current, trial, best = np.zeros((3, horizon + 1), dtype=np.int32)
    length = min(len(start), horizon)
    current[:length] = start[:length]
    length = bit_parallel.anneal(
        prepared.process,
        runs,
        common,
        bit_parallel.Scratch(current, trial),
        length,
        best,
        idle_worth(prepared.task.discount, prepared.task.horizon),
        moves if prepared.task.actions else 0,
        HEAT,
        np.uint64(seed % 2**64),
    )
    return tuple(best[:length].tolist())


def value(prepared: Prepared, actions: Sequence[int], words: int, seed: int) -> float:
    """Mean discounted reward of a sequence over 64 · `words` runs of the seed."""
    return worth(prepared, actions, words, seed)[0]


def worth(prepared: Prepared, actions: Sequence[int], words: int, seed: int) -> tuple[float, float]:
    """The same, and the sequence's earliness (planning/preference.py)."""
    runs, common = _begun(prepared, words)
    found: tuple[float, float] = bit_parallel.worth(
        prepared.process,
        runs,
        common,
        np.asarray(actions, dtype=np.int32),
        idle_worth(prepared.task.discount, prepared.task.horizon),
        np.uint64(seed % 2**64),
    )
    return found


def _begun(prepared: Prepared, words: int) -> tuple[bit_parallel.Runs, bit_parallel.CommonRandomNumbers]:
    process, horizon = prepared.process, max(prepared.task.horizon, 0)
    outcomes = max((len(rule.outcomes) for rule in prepared.task.rules), default=1)
    runs = bit_parallel.Runs(
        np.zeros((2, horizon + 1, int(process.slot_start[-1]), words), dtype=np.uint64),
        np.zeros((2, horizon + 1)),
        np.zeros((2, horizon + 1)),
        np.zeros((2, horizon + 1)),
        np.ones((2, horizon + 1)),
        np.zeros(horizon + 1, dtype=np.int32),
    )
    common = bit_parallel.CommonRandomNumbers(
        np.zeros(KEPT, dtype=np.int64), np.zeros((KEPT, outcomes, words), dtype=np.uint64)
    )
    state: Ints = np.asarray(prepared.task.initial, dtype=np.int32)
    bit_parallel.begin(process, runs, common, state)
    return runs, common
