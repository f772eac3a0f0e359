"""Ragged arrays: lists of lists of indices, and the flat arrays made of them.

A ragged list is two arrays: the entries of item i of `x` are `x[x_start[i] : x_start[i + 1]]`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int32]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def inverse(size: int, lists: Sequence[Sequence[int]]) -> list[list[int]]:
    """For each member below `size`, which of the lists have it."""
    holders: list[list[int]] = [[] for _ in range(size)]
    for index, members in enumerate(lists):
        for member in members:
            holders[member].append(index)
    return holders


def union(lists: Sequence[Sequence[int]], chosen: Iterable[int]) -> list[int]:
    return sorted({member for index in chosen for member in lists[index]})


def ragged(lists: Sequence[Sequence[int]]) -> tuple[Ints, Ints]:
    """Starts (items + 1,) and entries (n,) of a list of lists of indices."""
    start = np.cumsum([0, *map(len, lists)]).astype(np.int32)
    return start, np.array([entry for entries in lists for entry in entries], dtype=np.int32)


def floats(values: Iterable[float | Fraction]) -> Floats:
    return np.array([float(value) for value in values])
