"""Many states of one task at once, compiled: a step of each, which actions apply, and which states are over.

The meaning is that of transitions.py, state by state; states are (N, V) value indices.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Bools, Floats, Ints
from cleancli.compiler.lowering.state_tables import Process
from cleancli.planning.kernels.jit import njit
from cleancli.planning.kernels.rng import GOLDEN, split, uniform
from cleancli.planning.kernels.transitions import covering, holds, rewarded, step

Streams = NDArray[np.uint64]


@njit(cache=True, nogil=True)
def begin(streams: Streams, seeds: Streams) -> None:
    """The stream of each state, (N,), at its start: that of its seed."""
    for i in range(len(seeds)):
        streams[i] = split(seeds[i], np.uint64(0))


@njit(cache=True, nogil=True)
def step_each(
    p: Process,
    states: Ints,
    actions: Ints,
    anew: Bools,
    initial: Ints,
    streams: Streams,
    rewards: Floats,
    standing: Floats,
) -> None:
    """A step of each state by its action, (N,), drawn from its own stream; what is paid for it (eq. 2, and
    what else is paid), and what each further step is paid for in which nothing is done, (N,) each. Where
    `anew` is true the state becomes the initial one instead, and nothing is drawn or paid."""
    for i in range(len(states)):
        if anew[i]:
            states[i] = initial
            rewards[i] = standing[i] = 0.0
            continue
        streams[i] += GOLDEN
        paid, _, _ = step(p, states[i], actions[i], uniform(streams[i]))
        standing[i] = rewarded(p, states[i])[1]
        rewards[i] = paid + standing[i]


@njit(cache=True, nogil=True)
def covered_each(p: Process, states: Ints, masks: NDArray[np.int8]) -> None:
    """1 for each action of each state that a rule covers there, else 0, (N, A)."""
    for i in range(len(states)):
        for action in range(masks.shape[1]):
            masks[i, action] = covering(p, states[i], action) >= 0


@njit(cache=True, nogil=True)
def any_holds_each(p: Process, states: Ints, conditions: Ints, found: Bools) -> None:
    """Whether any of these conditions of `Process` holds in each state, (N,)."""
    for i in range(len(states)):
        found[i] = False
        for condition in conditions:
            if holds(p, states[i], condition):
                found[i] = True
                break
