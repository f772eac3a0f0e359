"""The rows of a study by cell, and a measure of each run.

Runs are what chance varies: a run is the mean of those of its episodes that are meant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Bools, Floats, Longs
from cleancli.statistics.bootstrap import Estimate, mean_of
from cleancli.statistics.paired import by_run
from cleancli.study.model import Value
from cleancli.study.row import MEASURES, Row

ALWAYS_TOLD = frozenset({"thinking", "score", "left", "clean"})
"""Measures that say something also of an episode that did not end clean; all others are of the way there."""


@dataclass(frozen=True, slots=True)
class Cell:
    """Rows that have these values, None for an axis that is not theirs. `mean`: of runs, each the mean of its
    rows that count; `failed`: how many rows do not, as they did not end clean."""

    values: tuple[Value | None, ...]
    rows: tuple[Row, ...]
    mean: Estimate
    failed: int

    @property
    def runs(self) -> int:
        """How many runs the rows are of."""
        return len({row.run for row in self.rows})


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
    told, clean = measured(rows, measure)
    return Cell(values, tuple(rows), mean_of(by_run(runs_of(rows)[clean], told[clean])), int((~clean).sum()))


def measured(rows: Sequence[Row], measure: str) -> tuple[Floats, Bools]:
    """The measure of each row, and whether it is one of the whole way to a clean end, (n,) each."""
    values = np.array([MEASURES[measure].of(row) for row in rows], dtype=np.float64)
    return values, np.array([row.clean or measure in ALWAYS_TOLD for row in rows], dtype=np.bool_)


def runs_of(rows: Sequence[Row]) -> Longs:
    """The number of each row's run, (n,)."""
    return np.array([row.run for row in rows], dtype=np.int64)
