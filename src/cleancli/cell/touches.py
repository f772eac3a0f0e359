"""Where the robot finds the table, by places of it that its tool has touched.

What the robot tells is where its tool's tip was each time: x, y and z in coordinates of its own, whichever
they are. Touched with the tool that cleans, an error of its length is one of the table's height as well, and
the two cancel out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Floats, Points
from cleancli.cell.board import Board
from cleancli.cell.camera import Laid
from cleancli.cell.plane_fit import Fitted, fitted
from cleancli.perception.geometry import Plane
from cleancli.scene.model import Surface

UNITS = {"m": 1.0, "mm": 0.001}
"""Metres."""
LEAST_TOUCHES = 3
LEAST_WIDTH = 0.02
"""Metres (standard deviation) that touches must be spread over in the narrower direction: nearer to a line,
they tell no slant."""
MOST_WIDTH = 5.0
"""Metres: a table that is touched over more is measured in another unit."""
MOST_SPREAD = 0.003
"""Metres (standard deviation) that touches may lie off their plane; chosen."""
MOST_HEIGHT_ERROR = 0.001
"""Metres (standard deviation) by which the height of a corner of the table may be uncertain: a rag that is
2 mm too high passes over half of the lentils (docs/measurements/world.md)."""
ALONE, ALONE_RATIO = 0.002, 5.0
"""Metres, and standard deviations, by which a touch is off the plane of all others if it was a mistake."""
MOST_CORNER_MISFIT = 0.004
"""Metres (root of the mean square) that touched corners may be off; chosen: a blunt tool."""
MOST_CORNER_SCALE = 0.02
"""Share by which the robot may find corners farther apart than they were printed; chosen."""
FLIPPED = 0.5
"""Factor by which corners must fit better, seen from below, if the robot's z points down."""


class BadTouches(Exception):
    """Touches that tell no place of the table; the message says what is wrong, of a file in which line."""


@dataclass(frozen=True, slots=True)
class Touch:
    """`tool`: x, y, z of the tip in the robot's coordinates, metres; `corner` of the board by its name, None
    where only the surface was touched."""

    tool: tuple[float, float, float]
    corner: str | None = None


@dataclass(frozen=True, slots=True)
class Touched:
    """Where the robot finds the table.

    `pose` (4, 4) leads from the scene's coordinates to the robot's. Metres: `residuals` (n,) by which touches
    lie above the plane, their standard deviation `spread`, and that of the plane's height in the middle of
    the surface and at the corner where it is largest, `height_errors`; None where three touches tell none.
    `corners` is how corners of the board fitted, None where none were touched. `doubts` say in words what
    speaks against it.
    """

    pose: Floats
    residuals: Floats
    spread: float | None
    height_errors: tuple[float, float] | None
    corners: Fitted | None
    doubts: tuple[str, ...]


def header(unit: str) -> str:
    """The first line of a file of touches in a unit."""
    return f"x_{unit},y_{unit},z_{unit},corner"


def read_touches(text: str, board: Board) -> tuple[Touch, ...]:
    """The touches of a file: a header that names the unit, and x, y, z and perhaps a corner of the board on
    each line. Raises BadTouches."""
    lines = text.splitlines()
    unit = next((name for name in UNITS if lines and lines[0].strip() == header(name)), None)
    if unit is None:
        known = " or ".join(f"`{header(name)}`" for name in UNITS)
        raise BadTouches(f"line 1: the header must be {known}")
    found = []
    for number, line in enumerate(lines[1:], start=2):
        if line.strip():
            try:
                found.append(read_touch(line, unit, board))
            except BadTouches as error:
                raise BadTouches(f"line {number}: {error}") from None
    return tuple(found)


def read_touch(line: str, unit: str, board: Board) -> Touch:
    """x, y, z and perhaps a corner, with commas between. Raises BadTouches."""
    x, y, z, corner, *more = *(part.strip() for part in line.split(",")), "", "", "", ""
    if any(more):
        raise BadTouches(f"`{line.strip()}` has more than x, y, z and a corner")
    try:
        place = UNITS[unit] * float(x), UNITS[unit] * float(y), UNITS[unit] * float(z)
    except ValueError:
        raise BadTouches(f"`{line.strip()}` must begin with three numbers: x, y, z") from None
    if not all(map(math.isfinite, place)):
        raise BadTouches(f"`{line.strip()}`: x, y and z must be finite")
    if corner and corner not in board.corner_names:
        first, last = board.corner_names[-(board.columns - 1)], board.corner_names[board.columns - 2]
        raise BadTouches(f"the board {board.name} has no corner `{corner}`: they are {first} to {last}")
    return Touch(place, corner or None)


def touched(
    touches: Sequence[Touch], board: Board, laid: Laid, surface: Surface, before: Floats | None
) -> Touched:
    """The table's place by touches of it. Two or more corners of the board tell where on the plane the scene
    lies; without, that stays as in the pose `before` (4, 4), and height and slant alone are new. Raises
    BadTouches."""
    tools = np.array([touch.tool for touch in touches], np.float64).reshape(-1, 3)
    _refuse_narrow(tools)
    middle = tools.mean(axis=0)
    normal = np.linalg.svd(tools - middle)[2][2]
    names = [touch.corner for touch in touches if touch.corner is not None]
    corners: Fitted | None = None
    if len(set(names)) > 1:
        numbers = np.array([board.corner_names.index(name) for name in names], np.int64)
        at_corners = tools[[touch.corner is not None for touch in touches]]
        pose, corners = _by_corners(at_corners, laid.places(board, numbers), normal, middle)
    elif before is not None:
        up = normal if normal @ before[:3, 2] > 0 else -normal
        pose = Plane.below(before[:3, 3], up, float(up @ middle), before[:3, 0]).pose
    else:
        raise BadTouches(
            "two corners of the board at least must be touched, to tell where on the plane the table lies"
        )
    return _judged(tools, pose, corners, surface)


def _refuse_narrow(tools: Points) -> None:
    if len(tools) < LEAST_TOUCHES:
        raise BadTouches(f"{LEAST_TOUCHES} touches at least tell a plane, not {len(tools)}")
    wide, narrow, _ = np.linalg.svd(tools - tools.mean(axis=0), compute_uv=False) / np.sqrt(len(tools))
    if wide > MOST_WIDTH:
        raise BadTouches(f"they are spread over {2 * wide:.0f} m: is their unit mm?")
    if wide < LEAST_WIDTH:
        raise BadTouches(
            f"they are spread over {2000 * wide:.3g} mm: is their unit m? Else touch the whole table"
        )
    if narrow < LEAST_WIDTH:
        raise BadTouches("they lie almost on a line, which tells no slant: touch the whole table")


def _by_corners(at: Points, places: Points, normal: Floats, middle: Floats) -> tuple[Floats, Fitted]:
    """The pose by touched corners at (n, 3) whose `places` (n, 2) in the scene are known. The normal points
    up along the robot's z, unless corners fit much better the other way."""

    def fit(up: Floats) -> tuple[Floats, Fitted]:
        across = np.eye(3)[int(np.abs(up).argmin())]
        plane = Plane.below(middle, up, float(up @ middle), across)
        found = fitted((at - plane.origin) @ np.column_stack([plane.east, plane.north]), places)
        return plane.pose @ np.linalg.inv(found.pose), found

    up = normal if normal[2] > 0 else -normal
    above, below = fit(up), fit(-up)
    return below if below[1].misfit < FLIPPED * above[1].misfit else above


def _judged(tools: Points, pose: Floats, corners: Fitted | None, surface: Surface) -> Touched:
    places = (tools - pose[:3, 3]) @ pose[:3, :3]
    heights = places[:, 2]
    free = len(tools) - LEAST_TOUCHES
    spread = float(np.sqrt((heights**2).sum() / free)) if free else None
    errors = None if spread is None else _height_errors(places, spread, surface)
    doubts = (*_of_heights(places, spread, errors), *_of_corners(corners))
    return Touched(pose, heights, spread, errors, corners, doubts)


def _height_errors(places: Points, spread: float, surface: Surface) -> tuple[float, float]:
    """The plane's standard deviation in the middle and at the worst corner of the surface: that of linear
    regression, whose square is spread² aᵀ (AᵀA)⁻¹ a for the place a = (1, x, y)."""
    ones = np.ones(len(places))
    inverse = np.linalg.inv(_squares(np.column_stack([ones, places[:, :2]])))
    x, y = surface.width / 2, surface.depth / 2
    asked = np.array([(1, 0, 0), (1, -x, -y), (1, -x, y), (1, x, -y), (1, x, y)])
    errors = spread * np.sqrt(np.einsum("ij,jk,ik->i", asked, inverse, asked))
    return float(errors[0]), float(errors[1:].max())


def _squares(a: Floats) -> Floats:
    return np.asarray(a.T @ a, np.float64)


def _of_heights(places: Points, spread: float | None, errors: tuple[float, float] | None) -> tuple[str, ...]:
    if spread is None or errors is None:
        return ("three touches always lie on a plane: touch more places, to see how exact they are",)
    alone = _alone(places)
    if alone is not None:
        number, off = alone
        way = "above" if off > 0 else "below"
        return (f"touch {number + 1} lies {abs(1000 * off):.1f} mm {way} the plane of the others: repeat it",)
    if spread > MOST_SPREAD:
        return (
            f"touches lie {1000 * spread:.1f} mm off a plane: is the table flat, and the tool stiff and held "
            "upright?",
        )
    if errors[1] > MOST_HEIGHT_ERROR:
        return (
            f"the height of a corner of the table is known to {1000 * errors[1]:.1f} mm alone: touch more "
            "places, near its corners; a rag that is 2 mm too high leaves half of small things behind",
        )
    return ()


def _alone(places: Points) -> tuple[int, float] | None:
    """The touch that is farthest off the plane of all others and how far, if that is no chance."""
    if len(places) < LEAST_TOUCHES + 2:
        return None
    found: list[tuple[float, int, float]] = []
    for number in range(len(places)):
        others = np.delete(places, number, axis=0)
        a = np.column_stack([np.ones(len(others)), others[:, :2]])
        plane = np.linalg.lstsq(a, others[:, 2])[0]
        here = np.array([1.0, *places[number, :2]])
        spread = np.sqrt(((others[:, 2] - a @ plane) ** 2).sum() / (len(others) - LEAST_TOUCHES))
        error = spread * np.sqrt(1 + here @ np.linalg.pinv(_squares(a)) @ here)
        off = float(places[number, 2] - here @ plane)
        if abs(off) > max(ALONE, ALONE_RATIO * error):
            found.append((abs(off), number, off))
    return max(found)[1:] if found else None


def _of_corners(corners: Fitted | None) -> tuple[str, ...]:
    if corners is None:
        return ()
    if abs(corners.scale - 1) > MOST_CORNER_SCALE:
        way = "smaller" if corners.scale > 1 else "larger"
        return (
            f"the robot finds the board {abs(1 / corners.scale - 1):.1%} {way} than it was printed: does its "
            "bar measure what is said (`--bar`), is it the board that was touched (`--paper`), and is each "
            "corner called by its name?",
        )
    if corners.misfit > MOST_CORNER_MISFIT:
        return (
            f"corners are {1000 * corners.misfit:.1f} mm off on average: is each called by its name, and was "
            "the tool's middle on it?",
        )
    return ()
