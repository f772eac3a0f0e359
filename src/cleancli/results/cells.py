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
from cleancli.statistics.shares import share_of
from cleancli.study.model import Value
from cleancli.study.row import MEASURES, Row, axes_of

FIRST = ("scene", "strategy", "episode")
"""Axes that are told although they may follow from others."""


@dataclass(frozen=True, slots=True)
class Cell:
    """Rows that have these values, None for an axis that is not theirs. `told`: those that count, which are
    the clean ones where the measure is of the way there. `mean`: of runs, each the mean of its rows told."""

    values: tuple[Value | None, ...]
    rows: tuple[Row, ...]
    told: tuple[Row, ...]
    mean: Estimate

    @property
    def failed(self) -> int:
        """How many rows do not count."""
        return len(self.rows) - len(self.told)

    @property
    def runs(self) -> int:
        """How many runs the rows are of."""
        return len({row.run for row in self.rows})


def varied(rows: Iterable[Row]) -> tuple[str, ...]:
    """The axes of which rows have different values, in the order in which rows have them."""
    told = [axes_of(row) for row in rows]
    names = dict.fromkeys(name for axes in told for name in axes)
    return tuple(name for name in names if len({axes.get(name) for axes in told}) > 1)


def telling(rows: Sequence[Row]) -> tuple[str, ...]:
    """The axes of which rows have different values, without those that follow from others, as a planner may
    from the strategy."""
    told = [axes_of(row) for row in rows]
    axes = list(varied(rows))
    for axis in reversed([axis for axis in axes if axis not in FIRST]):
        others = [other for other in axes if other != axis]
        if len({_values(each, others) for each in told}) == len({_values(each, axes) for each in told}):
            axes = others
    return tuple(axes)


def _values(axes: Mapping[str, Value], names: Iterable[str]) -> tuple[Value | None, ...]:
    return tuple(axes.get(name) for name in names)


def cells(rows: Iterable[Row], axes: Sequence[str], measure: str, always: bool = False) -> tuple[Cell, ...]:
    """The rows by their values of some axes, in the order in which these come first. `always`: all of them
    count, whatever is measured."""
    found: dict[tuple[Value | None, ...], list[Row]] = {}
    for row in rows:
        found.setdefault(_values(axes_of(row), axes), []).append(row)
    return tuple(_cell(values, own, measure, always) for values, own in found.items())


def _cell(values: tuple[Value | None, ...], rows: Sequence[Row], measure: str, always: bool) -> Cell:
    told, counts = measured(rows, measure)
    counts |= always
    kept = tuple(row for row, each in zip(rows, counts.tolist(), strict=True) if each)
    return Cell(values, tuple(rows), kept, estimated(by_run(runs_of(kept), told[counts]), measure))


def estimated(values: Floats, measure: str) -> Estimate:
    """What runs, (n,), say that a measure is."""
    return share_of(values) if MEASURES[measure].is_share else mean_of(values)


def means_of_runs(rows: Sequence[Row], measure: str) -> Floats:
    """Of each run that has any, the mean of its rows that count, (n,)."""
    told, counts = measured(rows, measure)
    return by_run(runs_of(rows)[counts], told[counts])


def measured(rows: Sequence[Row], measure: str) -> tuple[Floats, Bools]:
    """The measure of each row, and whether the row counts, (n,) each."""
    found = MEASURES[measure]
    values = np.array([found.of(row) for row in rows], dtype=np.float64)
    return values, np.array([row.clean or found.always for row in rows], dtype=np.bool_)


def runs_of(rows: Sequence[Row]) -> Longs:
    """The number of each row's run, (n,)."""
    return np.array([row.run for row in rows], dtype=np.int64)
