"""The table as characters: where the areas are, where the tool is and goes, where the container stands and
the zone lies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import cos, hypot, sin

from rich.text import Text

from cleancli.execution.episode_state import Situation
from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.path import ToolPath
from cleancli.motion.zone import corners
from cleancli.scene.model import Scene

Place = tuple[float, float]
Cell = tuple[int, int]

ASPECT = 2.0
"""How much higher than wide a character is."""


@dataclass(frozen=True, slots=True)
class Marks:
    """The characters of a map: `corners` from north-west to south-east, sides that lie and that stand, the
    same of the container's mouth, and what is on the surface."""

    corners: tuple[str, str, str, str]
    sides: tuple[str, str]
    mouth: tuple[str, str]
    things: Mapping[str, str]


FANCY = Marks(
    ("┌", "┐", "└", "┘"),
    ("─", "│"),
    ("━", "┃"),
    {"dirt": "▒", "unseen": "░", "way": "·", "zone": "▫", "tool": "█"},
)
PLAIN = Marks(
    ("+", "+", "+", "+"),
    ("-", "|"),
    ("=", "#"),
    {"dirt": "*", "unseen": "?", "way": ".", "zone": "o", "tool": "@"},
)
STYLES = {
    "dirt": "red",
    "unseen": "dim red",
    "way": "blue",
    "zone": "green",
    "tool": "bold green",
    "name": "bold",
    "mouth": "bold blue",
}


def rows_for(scene: Scene, columns: int) -> int:
    """How many rows a map of so many columns has inside its frame, if lengths are to look right."""
    return max(3, round(columns * scene.surface.depth / scene.surface.width / ASPECT))


def table_map(
    scene: Scene,
    situation: Situation | None,
    path: ToolPath | None,
    tool: Place | None,
    columns: int,
    ascii_only: bool = False,
) -> Text:
    """The surface from above, north up, in a frame; `columns` without it. The container's mouth is a thicker
    stretch of the frame. Areas that are hidden, and only remembered, look fainter."""
    rows = rows_for(scene, columns)
    marks = PLAIN if ascii_only else FANCY
    grid = [[(" ", "")] * columns for _ in range(rows)]
    for kind, (column, row) in _layers(scene, situation, path, (columns, rows)):
        grid[row][column] = (marks.things[kind], STYLES[kind])
    for area in () if situation is None else situation.areas:
        column, row = _cell(area.ellipse.centre, scene, (columns, rows))
        first = max(0, min(column, columns - len(area.name)))
        for offset, letter in enumerate(area.name[: columns - first]):
            grid[row][first + offset] = (letter, STYLES["name"])
    if tool is not None and _on_surface(tool, scene):
        column, row = _cell(tool, scene, (columns, rows))
        grid[row][column] = (marks.things["tool"], STYLES["tool"])
    return _framed(grid, scene, marks)


def _layers(
    scene: Scene, situation: Situation | None, path: ToolPath | None, size: Cell
) -> Iterator[tuple[str, Cell]]:
    """What stands in which cell; what comes later lies on top."""
    if scene.zone is not None:
        outline = corners(scene.zone).tolist()
        for begin, end in zip(outline, outline[1:] + outline[:1], strict=True):
            yield from (("zone", cell) for cell in _line(begin, end, scene, size))
    if situation is not None:
        for area in situation.areas:
            kind = "unseen" if area.name in situation.unseen else "dirt"
            yield from ((kind, cell) for cell in _covered(area.ellipse, scene, size))
    if path is not None:
        yield from (("way", cell) for cell in _way(path, scene, size))


def _covered(ellipse: Ellipse, scene: Scene, size: Cell) -> Iterator[Cell]:
    """The cells whose middle lies in the ellipse, and that of its own middle."""
    yield _cell(ellipse.centre, scene, size)
    columns, rows = size
    along, across = (max(axis, 1e-9) for axis in ellipse.axes)
    for row in range(rows):
        for column in range(columns):
            x = ((column + 0.5) / columns - 0.5) * scene.surface.width - ellipse.centre[0]
            y = (0.5 - (row + 0.5) / rows) * scene.surface.depth - ellipse.centre[1]
            u = x * cos(ellipse.angle) + y * sin(ellipse.angle)
            v = y * cos(ellipse.angle) - x * sin(ellipse.angle)
            if (u / along) ** 2 + (v / across) ** 2 <= 1:
                yield column, row


def _way(path: ToolPath, scene: Scene, size: Cell) -> Iterator[Cell]:
    """The cells that the stroke goes over."""
    for begin, end in pairwise(path.stroke):
        yield from _line(begin, end, scene, size)


def _line(begin: Place, end: Place, scene: Scene, size: Cell) -> Iterator[Cell]:
    """The cells of the surface on the line between two places."""
    finest = scene.surface.width / size[0] / 2
    (x0, y0), (x1, y1) = begin, end
    number = max(1, int(hypot(x1 - x0, y1 - y0) / finest))
    places = ((x0 + (x1 - x0) * n / number, y0 + (y1 - y0) * n / number) for n in range(number + 1))
    yield from (_cell(place, scene, size) for place in places if _on_surface(place, scene))


def _on_surface(place: Place, scene: Scene) -> bool:
    return abs(place[0]) <= scene.surface.width / 2 and abs(place[1]) <= scene.surface.depth / 2


def _cell(place: Place, scene: Scene, size: Cell) -> Cell:
    """The column and row of a place; the nearest ones of a place beside the surface."""
    column = int((place[0] / scene.surface.width + 0.5) * size[0])
    row = int((0.5 - place[1] / scene.surface.depth) * size[1])
    return min(max(column, 0), size[0] - 1), min(max(row, 0), size[1] - 1)


def _framed(grid: list[list[tuple[str, str]]], scene: Scene, marks: Marks) -> Text:
    rows, columns = len(grid), len(grid[0])
    first, last = (_cell(end, scene, (columns, rows)) for end in scene.mouth())
    edge = scene.container.edge
    lying, standing = marks.sides
    thick_lying, thick_standing = marks.mouth

    def side(name: str, at: int, low: int, high: int, thin: str, thick: str) -> tuple[str, str]:
        return (thick, STYLES["mouth"]) if edge == name and low <= at <= high else (thin, "")

    def lid(name: str, ends: tuple[str, str]) -> Iterable[tuple[str, str]]:
        middle = [side(name, n, first[0], last[0], lying, thick_lying) for n in range(columns)]
        return ((ends[0], ""), *middle, (ends[1], ""))

    top, bottom = min(first[1], last[1]), max(first[1], last[1])
    lines = [lid("north", marks.corners[:2])]
    for number, row in enumerate(grid):
        west = side("west", number, top, bottom, standing, thick_standing)
        east = side("east", number, top, bottom, standing, thick_standing)
        lines.append((west, *row, east))
    lines.append(lid("south", marks.corners[2:]))
    return Text("\n", no_wrap=True).join(Text.assemble(*line) for line in lines)
