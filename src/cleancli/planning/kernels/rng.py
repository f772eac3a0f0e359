"""Counter-based random numbers for compiled code: each sample has a stream of its own."""

from __future__ import annotations

import numpy as np

from cleancli.planning.kernels.jit import compiled

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
"""What a stream advances by (Steele, Lea and Flood, OOPSLA 2014)."""


@compiled
def mixed(state: np.uint64) -> np.uint64:
    """The output function of splitmix64 (Steele, Lea and Flood, OOPSLA 2014)."""
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return state ^ (state >> np.uint64(31))


@compiled
def uniform(stream: np.uint64) -> float:
    """The number in [0, 1) of a place in a stream: the 53 upper bits of what is mixed from it."""
    return float(mixed(stream) >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@compiled
def split(seed: np.uint64, number: np.uint64) -> np.uint64:
    """The start of the numbered stream of a seed."""
    return mixed(seed) + number * GOLDEN
