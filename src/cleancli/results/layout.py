"""What a figure of any study shows where: which axis goes from left to right, and which tell series apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cleancli.results.cells import Cell, cells, telling
from cleancli.study.model import Value
from cleancli.study.row import Row, axes_of

LEAST_NUMBERS = 3
"""Values of an axis of numbers that a line is drawn along."""


@dataclass(frozen=True, slots=True)
class Grid:
    """Cells as a figure shows them: by series, and from left to right by the value of the axis `along`; None
    where no such cell was carried out. `is_line`: the values are numbers, and few gaps lie between them."""

    along: str
    places: tuple[Value | None, ...]
    series: tuple[tuple[str, tuple[Cell | None, ...]], ...]
    is_line: bool


def grid_of(rows: Sequence[Row], measure: str) -> Grid:
    """The cells of a part of a study. From left to right go episodes, else numbers, else scenes, else the
    first axis that varies."""
    axes = telling(rows)
    along = next(iter(sorted(axes, key=lambda axis: _rank(rows, axis))), "scene")
    apart = tuple(axis for axis in axes if axis != along)
    found = {cell.values: cell for cell in cells(rows, (along, *apart), measure)}
    places = list(dict.fromkeys(values[0] for values in found))
    is_line = _rank(rows, along) < 2
    if is_line:
        places.sort(key=lambda place: float(place or 0))
    series = dict.fromkeys(values[1:] for values in found)
    return Grid(
        along,
        tuple(places),
        tuple((named(apart, own), tuple(found.get((place, *own)) for place in places)) for own in series),
        is_line,
    )


def named(axes: Sequence[str], values: Sequence[Value | None]) -> str:
    """The values of some axes, numbers with their axis; those left out that a cell does not have."""
    pairs = zip(axes, values, strict=True)
    return ", ".join(
        f"{axis} {value}" if isinstance(value, int | float) else str(value)
        for axis, value in pairs
        if value is not None
    )


def _rank(rows: Sequence[Row], axis: str) -> int:
    if axis == "episode":
        return 0
    values = {axes_of(row).get(axis) for row in rows}
    if len(values) >= LEAST_NUMBERS and all(isinstance(value, int | float) for value in values):
        return 1
    return 2 if axis == "scene" else 3
