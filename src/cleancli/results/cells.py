"""The rows of a study by cell, and a measure of each run.

A run is the mean of those of its episodes that are meant, and clean if all of them ended so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.statistics.bootstrap import Estimate, mean_of
from cleancli.study.model import Value
from cleancli.study.row import MEASURES, Row

ALWAYS_TOLD = frozenset({"thinking", "score", "left", "clean"})
"""Measures that say something also of an episode that did not end clean; all others are of the way there."""


@dataclass(frozen=True, slots=True)
class Cell:
    """Rows that have these values, None for an axis that is not theirs. `mean`: of the runs that ended clean,
    where the measure is of the way there; `failed`: how many of the `runs` did not."""

    values: tuple[Value | None, ...]
    rows: tuple[Row, ...]
    mean: Estimate
    runs: int
    failed: int


def axes_of(row: Row) -> Mapping[str, Value]:
    """All that rows are selected by."""
    return {"part": row.part, **row.axes, "episode": row.episode}


def varied(rows: Iterable[Row]) -> tuple[str, ...]:
    """The axes of which rows have different values, in the order in which rows have them."""
    told = [axes_of(row) for row in rows]
    names = dict.fromkeys(name for axes in told for name in axes)
    return tuple(name for name in names if len({axes.get(name) for axes in told}) > 1)


def cells(rows: Iterable[Row], axes: Sequence[str], measure: str) -> tuple[Cell, ...]:
    """The rows by their values of some axes, in the order in which these come first."""
    found: dict[tuple[Value | None, ...], list[Row]] = {}
    for row in rows:
        found.setdefault(tuple(axes_of(row).get(axis) for axis in axes), []).append(row)
    return tuple(_cell(values, own, measure) for values, own in found.items())


def _cell(values: tuple[Value | None, ...], rows: Sequence[Row], measure: str) -> Cell:
    told, clean = by_run(rows, *measured(rows, measure))
    return Cell(values, tuple(rows), mean_of(told[clean]), len(clean), int((~clean).sum()))


def measured(rows: Sequence[Row], measure: str) -> tuple[Floats, Bools]:
    """The measure of each row, and whether it is one of the whole way to a clean end, (n,) each."""
    values = np.array([MEASURES[measure].of(row) for row in rows], dtype=np.float64)
    return values, np.array([row.clean or measure in ALWAYS_TOLD for row in rows], dtype=np.bool_)


def by_run(rows: Sequence[Row], values: Floats, clean: Bools) -> tuple[Floats, Bools]:
    """The mean of each run's values, and whether all of it is clean, in the order of the runs' numbers."""
    _, which = np.unique([row.run for row in rows], return_inverse=True)
    count = np.bincount(which)
    return np.bincount(which, values) / count, np.bincount(which, clean) == count
