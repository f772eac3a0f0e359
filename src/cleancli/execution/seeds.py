"""Splits one seed into random streams, so that drawing more from one changes no other."""

from __future__ import annotations

import enum

import numpy as np


class Stream(enum.IntEnum):
    """What randomness is wanted for; numbers are part of a run's identity and never reused."""

    WORLD = 0
    PERCEPTION = 1
    PLANNING = 2


def derived(seed: int, stream: Stream) -> int:
    """A 63-bit seed for one stream."""
    state = np.random.SeedSequence(seed, spawn_key=(stream,)).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(1))
