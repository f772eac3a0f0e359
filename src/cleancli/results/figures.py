"""Figures of a study in the paper's form (Fig. 8 to 10): means with their intervals, and where time goes.

The same rows make the same bytes, with the same matplotlib. Colours are those of Okabe and Ito (2008), which
the colour-blind tell apart; series that share one differ by hatch or marker.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil
from statistics import fmean
from typing import Any

import numpy as np

from cleancli.report.timeline import in_order
from cleancli.results.layout import Grid, grid_of
from cleancli.study.row import Row, meaning_of, words_for

_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#f0e442", "#000000")
_HATCHES = ("", "////", "....", "xxxx")
_MARKERS = "osD^vPX*"
_OF_KINDS = {
    "planning": "#e69f00",
    "transits": "#56b4e9",
    "actions": "#0072b2",
    "perceiving": "#009e73",
    "extra_perceptions": "#d55e00",
    "learning": "#cc79a7",
}
"""As on the pages of runs (report/templates/style.css)."""

_STYLE: Mapping[Any, object] = {
    "svg.hashsalt": "cleancli",
    "font.size": 10,
    "text.parse_math": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.grid.axis": "y",
    "grid.color": "#d8dee4",
    "hatch.linewidth": 0.6,
}
_WIDTH, _HEIGHT = 8.0, 4.6
"""Inches, of a figure with one panel."""

DOTS = 100
"""Of a picture, in an inch."""

MOST_BARS = 48
"""Side by side. Chosen: each is 14 pixels wide or more, so that its name fits below."""

_UNTOLD = {"svg": {"Date": None, "Creator": None}, "png": {"Software": None}}
"""What would differ from day to day, or names the version of matplotlib."""

LETTERS = 90
"""That stand side by side. Chosen: as many as fit with room between names."""

MOST_WIDE = 24
"""Bars of which each is wide enough for a number above it. Chosen."""

_APART = 0.3
"""Of the gap between two places on an axis of numbers, what the points of all series take."""

_BAR = 0.84
"""Of a place's width, that of all its bars."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A picture by its name, what it shows, and its bytes by format."""

    name: str
    shows: str
    files: Mapping[str, bytes]


def figures_of(name: str, rows: Sequence[Row], measure: str) -> tuple[Figure, ...]:
    """The figures of a part of a study: the measure that it is about, the actions of a series and how
    many were unknown, and the seconds by kind. Raises ImportError without matplotlib."""
    grid = grid_of(rows, measure)
    shown = [(name, measure)]
    if grid.along == "episode":
        shown += [(f"{name}_{also}", also) for also in ("actions", "unknown") if also != measure]
    return (*(_means(each, rows, what) for each, what in shown), _times(f"{name}_times", grid))


def _means(name: str, rows: Sequence[Row], measure: str) -> Figure:
    grid = grid_of(rows, measure)
    shows = meaning_of(measure, words_for(rows))
    return _drawn(name, shows, [grid], _lines) if grid.is_line else _drawn(name, shows, _panels(grid), _bars)


def _panels(grid: Grid) -> list[Grid]:
    """Places in as few portions as have room for a bar of each series, about equally many in each."""
    number = ceil(len(grid.places) / max(1, MOST_BARS // len(grid.series)))
    many = ceil(len(grid.places) / number)
    portions = [slice(start, start + many) for start in range(0, len(grid.places), many)]
    return [
        replace(
            grid,
            places=grid.places[portion],
            series=tuple((name, row[portion]) for name, row in grid.series),
        )
        for portion in portions
    ]


def _bars(axes: Any, grid: Grid) -> None:
    """A group of bars for each place, one a series."""
    width = _BAR / len(grid.series)
    for number, (name, row) in enumerate(grid.series):
        at = np.arange(len(grid.places)) + (number + 0.5) * width - _BAR / 2
        heights = [0.0 if cell is None or not cell.mean.count else cell.mean.value for cell in row]
        colour = _COLOURS[number % len(_COLOURS)]
        hatch = _HATCHES[number // len(_COLOURS) % len(_HATCHES)]
        axes.bar(at, heights, width * 0.92, color=colour, hatch=hatch, edgecolor="white", label=name)
        for x, height, cell in zip(at, heights, row, strict=True):
            if cell is None:
                continue
            top = height
            if cell.mean.known:
                axes.plot([x, x], [cell.mean.low, cell.mean.high], color="#1c2128", linewidth=1.2)
                top = cell.mean.high
            if cell.failed:
                _note(axes, x, top, cell.failed, upright=len(grid.places) * len(grid.series) <= MOST_WIDE)
    _label(axes, range(len(grid.places)), [str(place) for place in grid.places])
    axes.set_xlabel(grid.along)


def _lines(axes: Any, grid: Grid) -> None:
    """A line for each series, a little aside of one another so that their intervals do not overlap."""
    places = [float(place) for place in grid.places if isinstance(place, int | float)]
    apart = _APART * min(np.diff(places), default=0.0) / len(grid.series)
    for number, (name, row) in enumerate(grid.series):
        aside = (number - (len(grid.series) - 1) / 2) * apart
        own = [(x + aside, cell) for x, cell in zip(places, row, strict=True) if cell and cell.mean.count]
        colour, marker = _COLOURS[number % len(_COLOURS)], _MARKERS[number % len(_MARKERS)]
        at, means = [x for x, _ in own], [cell.mean.value for _, cell in own]
        axes.plot(at, means, color=colour, marker=marker, markersize=5, label=name)
        for x, cell in own:
            if cell.mean.known:
                axes.plot([x, x], [cell.mean.low, cell.mean.high], color=colour, linewidth=1.2)
            if cell.failed:
                top = cell.mean.high if cell.mean.known else cell.mean.value
                _note(axes, x, top, cell.failed, upright=len(grid.series) == 1)
    axes.set_xticks(places)
    axes.set_xlabel(grid.along)


def _note(axes: Any, x: float, y: float, failed: int, upright: bool = True) -> None:
    """How many episodes did not end clean."""
    axes.annotate(
        f"✗{failed}",
        (x, y),
        (0, 3),
        textcoords="offset points",
        ha="center",
        fontsize=8,
        color="#a40000",
        rotation=0 if upright else 90,
    )


def _label(axes: Any, at: Iterable[float], labels: Sequence[str], towards: str = "right") -> None:
    """Name places; slanted, and so that names end or begin at theirs, where they have too many letters."""
    slanted = {"rotation": 25, "ha": towards, "rotation_mode": "anchor"}
    axes.set_xticks(list(at), labels, **(slanted if sum(map(len, labels)) > LETTERS else {}))


def _times(name: str, grid: Grid) -> Figure:
    """Mean seconds by kind, one on top of the other, of the episodes that count (Fig. 8b, 10b)."""
    kinds = in_order(
        {kind: 0.0 for stack in _stacks(grid) for kind, seconds in stack.seconds.items() if seconds}
    )

    def draw(axes: Any, panel: Grid) -> None:
        stacks = list(_stacks(panel))
        base = np.zeros(len(stacks))
        for kind in kinds:
            seconds = np.array([stack.seconds.get(kind, 0.0) for stack in stacks])
            axes.bar(
                [stack.at for stack in stacks],
                seconds,
                _BAR,
                base,
                color=_OF_KINDS.get(kind, "#8c959f"),
                edgecolor="white",
                linewidth=0.4,
                label=kind.replace("_", " "),
            )
            base = base + seconds
        _label_stacks(axes, panel, stacks)

    return _drawn(name, "mean seconds by kind", _panels(grid), draw)


@dataclass(frozen=True, slots=True)
class _Stack:
    """A bar of seconds by kind: where it stands, its place and its series."""

    at: float
    place: str
    series: str
    seconds: Mapping[str, float]


def _stacks(grid: Grid) -> Iterator[_Stack]:
    """Those of a place side by side, and a gap between two places."""
    at = 0.0
    for number, place in enumerate(grid.places):
        for series, row in grid.series:
            cell = row[number]
            if cell is not None:
                yield _Stack(at, str(place), series, _spent(cell.told))
                at += 1.0
        at += 0.6 if len(grid.series) > 1 else 0.0


def _spent(rows: Sequence[Row]) -> dict[str, float]:
    kinds = dict.fromkeys(kind for row in rows for kind in row.seconds)
    return {kind: fmean(row.seconds.get(kind, 0.0) for row in rows) for kind in kinds}


def _label_stacks(axes: Any, grid: Grid, stacks: Sequence[_Stack]) -> None:
    """Places below, or, where several series stand side by side, these below and places above."""
    if len(grid.series) == 1:
        _label(axes, [stack.at for stack in stacks], [stack.place for stack in stacks])
        axes.set_xlabel(grid.along)
        return
    axes.set_xticks(
        [stack.at for stack in stacks], [stack.series for stack in stacks], rotation=90, fontsize=8
    )
    places: dict[str, list[float]] = {}
    for stack in stacks:
        places.setdefault(stack.place, []).append(stack.at)
    above = axes.secondary_xaxis("top")
    _label(above, map(fmean, places.values()), list(places), towards="left")
    above.tick_params(length=0)
    above.spines["top"].set_visible(False)
    above.set_xlabel(grid.along)


def _drawn(name: str, shows: str, panels: Sequence[Grid], draw: Callable[[Any, Grid], None]) -> Figure:
    """The bytes of a figure with its panels one below the other, and its legend above: the one place that
    loads matplotlib, which takes long and is an optional part. Raises ImportError."""
    import matplotlib
    from matplotlib.figure import Figure as Canvas

    files = {}
    with matplotlib.rc_context(), warnings.catch_warnings():
        # Letters that the font does not have are shown as boxes; users know how they named their files.
        warnings.filterwarnings("ignore", r"Glyph \d+")
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_STYLE)
        figure = Canvas(figsize=(_WIDTH, _HEIGHT * (1 + len(panels)) / 2), layout="constrained")
        rows = figure.subplots(len(panels), sharey=True, squeeze=False)[:, 0]
        for axes, panel in zip(rows, panels, strict=True):
            draw(axes, panel)
            axes.set_ylabel(shows)
            axes.margins(y=0.08)
        axes.set_ylim(bottom=0)
        handles, labels = axes.get_legend_handles_labels()
        if len(labels) > 1:
            figure.legend(handles, labels, loc="outside upper center", ncols=_columns(labels), frameon=False)
        for kind, untold in _UNTOLD.items():
            buffer = io.BytesIO()
            figure.savefig(buffer, format=kind, dpi=DOTS, metadata=untold)
            files[kind] = buffer.getvalue()
    return Figure(name, shows, files)


def _columns(labels: Sequence[str]) -> int:
    """As many as fit side by side: about so many letters do."""
    return max(1, min(len(labels), LETTERS // (max(map(len, labels)) + 6)))
