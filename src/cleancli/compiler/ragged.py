"""Ragged arrays: lists of lists of indices, and the flat arrays made of them.

A ragged list is two arrays: the entries of item i of `x` are `x[x_start[i] : x_start[i + 1]]`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence, Sized
from fractions import Fraction
from typing import TypeVar

import numpy as np

from cleancli.array_types import Floats, Ints, Longs

_Item = TypeVar("_Item")


def starts(lists: Iterable[Sized]) -> Ints:
    """Where each list begins when they stand one after the other, and where the last ends: (items + 1,)."""
    return np.cumsum([0, *map(len, lists)]).astype(np.int32)


def ragged(lists: Sequence[Collection[int]]) -> tuple[Ints, Ints]:
    """Starts (items + 1,) and entries (n,) of a list of lists of indices."""
    return starts(lists), np.array([entry for entries in lists for entry in entries], dtype=np.int32)


def spans(first: Longs | Ints, count: Longs | Ints) -> tuple[Longs, Longs]:
    """The entries of several spans one after the other, each given by its `first` entry and their `count`:
    which span each is of, and the entry."""
    span: Longs = np.repeat(np.arange(len(count)), count)
    before: Longs = np.cumsum(count, dtype=np.int64) - count
    return span, np.arange(len(span)) + (first - before)[span]


def distinct(numbers: Longs) -> Longs:
    """The numbers that occur, ascending. numpy's `unique` imports masked arrays to tell the same."""
    ordered = np.sort(numbers)
    return ordered[np.flatnonzero(np.diff(ordered, prepend=ordered[:1] - 1))]


def floats(values: Iterable[float | Fraction]) -> Floats:
    """Numbers as an array. Fractions take long to divide, so one that stands there often is divided once."""
    listed = list(values)
    identities = list(map(id, listed))
    divided = {
        identity: float(value) for identity, value in dict(zip(identities, listed, strict=True)).items()
    }
    return np.array([divided[identity] for identity in identities], dtype=np.float64)
