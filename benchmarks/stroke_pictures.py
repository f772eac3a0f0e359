"""An episode's strokes as a picture: all of them over where the particles lay first, and a panel for each."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from math import ceil, degrees
from pathlib import Path
from typing import Any

import numpy as np
from stroke_record import FEW, Episode, Place, Stroke

from cleancli.array_types import Bools, Points
from cleancli.scene.model import Scene

ACROSS = 4
"""Panels in a row."""

SIZE = 3.3
"""Inches of a panel's width."""

DOTS = 110
"""Pixels to an inch."""

GONE, MOVED, OVER, BESIDE, LEFT = "#15803d", "#2563eb", "#dc2626", "#f97316", "#9ca3af"
MANY, SOME, VAIN = "#15803d", "#ca8a04", "#dc2626"

KEY = (
    ("into the container", GONE),
    ("moved", MOVED),
    ("gone over, and left", OVER),
    ("passed within 6 cm of the rag", BESIDE),
    ("elsewhere", LEFT),
)

_STYLE = "<style>td { vertical-align: top; font: 13px sans-serif } img { width: 640px }</style>"


class MissingMatplotlib(Exception):
    """Pictures need matplotlib, which is an optional part."""

    def __init__(self) -> None:
        super().__init__("a picture needs matplotlib: pip install 'matplotlib>=3.8'")


def draw(episode: Episode, scene: Scene, path: Path) -> None:
    """Write the picture of an episode on a scene. Raises MissingMatplotlib."""
    rows = ceil((len(episode.strokes) + 1) / ACROSS)
    high = SIZE * (scene.surface.depth + 0.1) / (scene.surface.width + 0.2) + 0.3
    figure = new_figure(SIZE * ACROSS, high * rows + 0.6)
    panels = figure.subplots(rows, ACROSS, squeeze=False).ravel()
    for panel in panels:
        panel.axis("off")
    _overview(panels[0], episode, scene)
    for number, (panel, stroke) in enumerate(zip(panels[1:], episode.strokes, strict=False), start=1):
        _stroke(panel, number, stroke, scene)
    figure.suptitle(title(episode), fontsize=12)
    figure.legend(handles=[_key(text, colour) for text, colour in KEY], loc="outside lower center", ncols=5)
    figure.savefig(path, dpi=DOTS)


def title(episode: Episode) -> str:
    """What an episode came to, in a line."""
    domain, scene, strategy, seed = episode.job
    table = " (stand-in)" if episode.stand_in else ""
    end = f"{len(episode.strokes)} strokes, {episode.moving:.1f} s moving, {episode.left} left"
    return f"{scene}, seed {seed}{table}: {strategy} with {domain}: {end}"


def _overview(panel: Any, episode: Episode, scene: Scene) -> None:
    """All strokes, numbered where they begin, over all particles."""
    _table(panel, scene)
    panel.set_title("all strokes", fontsize=9)
    if episode.strokes:
        _dots(panel, episode.strokes[0].places, LEFT)
    for number, stroke in enumerate(episode.strokes, start=1):
        colour = _colour(stroke)
        panel.plot(*zip(*stroke.corners, strict=True), color=colour, linewidth=1.2)
        panel.text(*stroke.corners[0], str(number), color=colour, fontsize=9, ha="center", va="center")


def _stroke(panel: Any, number: int, stroke: Stroke, scene: Scene) -> None:
    """What one stroke was meant for, where the rag went, and what became of each particle."""
    _table(panel, scene)
    into = f"{stroke.into} in" + (f", {stroke.lost} lost" if stroke.lost else "")
    name = stroke.move if len(stroke.move) < 34 else stroke.move[:31] + "..."
    text = f"{number}. {name}\n{into}; {stroke.transit:.1f} + {stroke.seconds:.1f} s"
    panel.set_title(text, fontsize=8, color=_colour(stroke))
    for index, area in enumerate(stroke.areas):
        aimed = index in stroke.aims
        _ellipse(panel, area, 1.4 if aimed else 0.6, "black" if aimed else LEFT)
    _corridor(panel, stroke.corners, scene.rag.width)
    if stroke.came is not None:
        first = stroke.corners[0]
        panel.plot(*zip(stroke.came, first, strict=True), color="black", linewidth=0.6, linestyle=":")
    _particles(panel, stroke, scene.rag.width)


def _particles(panel: Any, stroke: Stroke, width: float) -> None:
    places, (over, beside) = stroke.places, stroke.passed(width)
    known: tuple[tuple[Bools, str], ...] = (
        (stroke.gone, GONE),
        (stroke.moved, MOVED),
        (over, OVER),
        (beside, BESIDE),
    )
    for which, colour in known:
        _dots(panel, places[which], colour)
    _dots(panel, places[~np.any([which for which, _ in known], axis=0)], LEFT)
    for index in np.flatnonzero(stroke.moved):
        end = stroke.after[index]
        assert end is not None, "what has moved is on the table"
        panel.plot(*zip(stroke.before[index], end, strict=True), color=MOVED, linewidth=0.6)


def _colour(stroke: Stroke) -> str:
    if stroke.in_vain:
        return VAIN
    return MANY if stroke.into > FEW or not stroke.into else SOME


def _table(panel: Any, scene: Scene) -> None:
    """The surface, and the container's mouth at its edge."""
    from matplotlib.patches import Rectangle

    width, depth = scene.surface.width, scene.surface.depth
    panel.add_patch(Rectangle((-width / 2, -depth / 2), width, depth, fill=False, linewidth=0.8))
    panel.plot(*zip(*scene.mouth(), strict=True), color="black", linewidth=4)
    panel.set_xlim(-width / 2 - 0.1, width / 2 + 0.1)
    panel.set_ylim(-depth / 2 - 0.05, depth / 2 + 0.05)
    panel.set_aspect("equal")


def _corridor(panel: Any, corners: tuple[Place, ...], width: float) -> None:
    """What the rag sweeps, and the way of its middle."""
    from matplotlib.patches import Polygon

    for first, last in pairwise(map(np.array, corners)):
        step = last - first
        length = float(np.linalg.norm(step))
        if length > 0:
            side = np.array((-step[1], step[0])) / length * width / 2
            box = np.stack((first + side, last + side, last - side, first - side))
            panel.add_patch(Polygon(box, closed=True, alpha=0.15, facecolor=MOVED, linewidth=0))
    panel.plot(*zip(*corners, strict=True), color=MOVED, linewidth=0.8)
    panel.plot(*corners[0], marker="o", markersize=3, markerfacecolor="white", color=MOVED)


def _ellipse(panel: Any, area: Any, linewidth: float, colour: str) -> None:
    from matplotlib.patches import Ellipse

    long, short = (2 * axis for axis in area.axes)
    style = {"fill": False, "linewidth": linewidth, "edgecolor": colour}
    panel.add_patch(Ellipse(area.centre, long, short, angle=degrees(area.angle), **style))


def _dots(panel: Any, places: Points, colour: str) -> None:
    panel.plot(places[:, 0], places[:, 1], ".", markersize=4, color=colour)


def _key(text: str, colour: str) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], marker=".", linestyle="", color=colour, label=text)


def new_figure(width: float, height: float) -> Any:
    """An empty figure, inches. Raises MissingMatplotlib."""
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] != "matplotlib":
            raise
        raise MissingMatplotlib() from error
    return Figure(figsize=(width, height), layout="constrained")


def sheet(pictures: Iterable[tuple[Episode, Path]]) -> str:
    """A page of HTML with all pictures: a row a scene and seed, the strategies side by side."""
    rows: dict[tuple[str, int], list[str]] = {}
    for episode, path in pictures:
        cell = f'<td>{title(episode)}<br><a href="{path.name}"><img src="{path.name}"></a></td>'
        rows.setdefault((episode.job[1], episode.job[3]), []).append(cell)
    body = "".join(f"<tr>{''.join(cells)}</tr>\n" for cells in rows.values())
    return f"<!doctype html><meta charset=utf-8><title>Strokes</title>{_STYLE}\n<table>{body}</table>\n"
