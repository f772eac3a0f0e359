"""The compiled annealing for callers: gives it the memory that it works in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cleancli.compiler.ragged import Floats, Ints
from cleancli.planning import sequences, states
from cleancli.planning.prepared import Prepared

RUNS = 32
"""Runs by which a chain values sequences. Chosen: fewer overrate more, more take longer."""

HEAT = 0.1
"""A chain's first heat, as a share of what an action of the sequence that it starts from, or of `PAY`, earns. Chosen."""


def chain(prepared: Prepared, start: Sequence[int], moves: int, heat: float, seed: int) -> tuple[int, ...]:
    """The best sequence that `moves` changes of a sequence lead to, by runs that belong to the seed."""
    process, horizon = prepared.process, max(prepared.task.horizon, 0)
    state, variables = _state(prepared), len(prepared.task.variables)
    runs = sequences.Runs(
        np.zeros((2, horizon + 1, RUNS, variables), dtype=np.int32),
        np.zeros((2, horizon + 1, RUNS)),
        np.zeros((2, horizon + 1)),
        np.ones((2, horizon + 1)),
        np.zeros(horizon + 1, dtype=np.int32),
    )
    runs.state[:, 0] = state
    runs.standing[:, 0] = states.rewarded(process, state)[1]
    current, trial, best = np.zeros((3, horizon + 1), dtype=np.int32)
    length = min(len(start), horizon)
    current[:length] = start[:length]
    length, _ = sequences.anneal(
        process,
        runs,
        sequences.Sequence(current, trial),
        length,
        best,
        _idle(prepared),
        moves if prepared.task.actions else 0,
        heat,
        np.uint64(seed),
    )
    return tuple(best[:length].tolist())


def value(prepared: Prepared, actions: Sequence[int], runs: int, seed: int) -> tuple[float, float]:
    """Mean discounted reward of a sequence over drawn runs, and its standard error."""
    mean, square = states.sequence_value(
        prepared.process,
        _state(prepared),
        np.asarray(actions, dtype=np.int32),
        _idle(prepared),
        runs,
        np.uint64(seed),
    )
    return mean, float(np.sqrt(max(square - mean * mean, 0.0) / runs))


def _state(prepared: Prepared) -> Ints:
    return np.asarray(prepared.task.initial, dtype=np.int32)


def _idle(prepared: Prepared) -> Floats:
    """What a reward of 1 in each of so many last steps is worth at their start (horizon + 1,)."""
    steps = np.arange(max(prepared.task.horizon, 0))
    return np.concatenate([[0.0], np.cumsum(prepared.task.discount**steps)])
