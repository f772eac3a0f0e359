"""A sequence to a goal that is far away: by layers, along relaxed plans (helpful actions, Hoffmann and Nebel
2001), as if outcomes could be chosen."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from cleancli.compiler.lowering.state_tables import Process
from cleancli.compiler.task import GroundState
from cleancli.planning import kernels

MOST = 64
"""Outcomes of a state's helpful actions that are looked at. Chosen."""

Way = tuple[float, float, tuple[int, ...]]
"""How far the goal is from a state, the tries that the way to it takes, and the way's actions."""


def sequence(process: Process, initial: GroundState, steps: int, width: int) -> tuple[int, ...]:
    """The actions that lead to the goal in the fewest steps that were found, of which the way with the fewest
    tries; none where no way was found. In each step, `width` states are followed from which tries so far and
    those of the relaxed plan are fewest."""
    ways: Mapping[GroundState, Way] = {initial: (0.0, 0.0, ())}
    look = _Looking(process)
    for _ in range(steps):
        found = dict[GroundState, Way]()
        for state, (_, tried, actions) in ways.items():
            for after, action, tries, far in look(state):
                known = found.get(after)
                if known is None or tried + tries < known[1]:
                    found[after] = far, tried + tries, (*actions, action)
        arrived = min((way for way in found.values() if way[0] == 0.0), key=lambda way: way[1], default=None)
        if arrived is not None:
            return arrived[2]
        best = sorted(found, key=lambda state: found[state][0] + found[state][1])[:width]
        ways = {state: found[state] for state in best if found[state][0] < math.inf}
    return ()


class _Looking:
    """The successors of a state by helpful actions."""

    def __init__(self, process: Process) -> None:
        loops = kernels.relaxed
        self._process, self._rooms = process, (loops.relaxed(process), loops.relaxed(process))
        self._after = np.zeros((MOST, len(process.sizes)), dtype=np.int32)
        self._action = np.zeros(MOST, dtype=np.int32)
        self._tries, self._far = np.zeros(MOST), np.zeros(MOST)

    def __call__(self, state: GroundState) -> list[tuple[GroundState, int, float, float]]:
        row = np.array(state, dtype=np.int32)
        number = kernels.relaxed.promising(
            self._process, *self._rooms, row, self._after, self._action, self._tries, self._far
        )
        found = (self._action[:number], self._tries[:number], self._far[:number])
        states = map(tuple, self._after[:number].tolist())
        return list(zip(states, *(array.tolist() for array in found), strict=True))
