"""What of a cell cannot be right: the camera's place against the table that it sees, and the robot's against
places that its tool touches.

The table is its own witness: its plane tells the camera's height and slant, its rim the place and the turn.
By how much the two may differ is chosen: beyond what cameras and rulers are wrong by, and below what cleaning
bears (`python benchmarks/wrong_cells.py`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import acos, atan2, degrees, hypot

import numpy as np

from cleancli.array_types import Floats
from cleancli.cell.board import Board
from cleancli.cell.camera import Laid
from cleancli.cell.touches import Touch
from cleancli.geometry.rgbd import Frame
from cleancli.perception.outline import whole_outline
from cleancli.perception.surface import find_plane
from cleancli.scene.calibration import Thresholds
from cleancli.scene.model import Surface

HIGHER = 0.010
"""Metres by which the surface may be seen higher or lower than it lies: depth itself is some of that off."""
SLANTED = 1.0
"""Degrees by which it may be seen to slant."""
SHIFTED = 0.012
"""Metres by which its middle may be seen beside its place: the rim is seen to some millimetres."""
TURNED = 1.0
"""Degrees by which its sides may be seen turned."""
TOOL = 0.0015
"""Metres by which the tool may be higher or lower where it touches the table, on average: 2 mm too high, it
passes over half of the lentils."""
BESIDE = 0.006
"""Metres by which the tool may be beside a corner of the board that it touches, on average."""


@dataclass(frozen=True, slots=True)
class Seen:
    """Where the camera sees the table: `higher` than it lies (metres) and `slanted` (degrees), and where its
    rim is in view whole, by what its middle is `shifted` east and north (metres) and how far it is `turned`
    counter-clockwise (degrees)."""

    higher: float
    slanted: float
    shifted: tuple[float, float] | None
    turned: float | None


@dataclass(frozen=True, slots=True)
class Felt:
    """Where the tool is when it touches the table: `higher` than the cell says on average, and how far
    `beside` corners of the board, metres; None where none was touched."""

    higher: float
    beside: float | None


def seen(frames: Sequence[Frame], surface: Surface, rng: np.random.Generator) -> Seen:
    """Where a camera whose place is known sees the table: the median over `frames`, which show nothing but
    the table. Raises NoSurface. `rng` draws RANSAC's triples."""
    thresholds = Thresholds()
    planes = [find_plane(frame, surface, thresholds, rng) for frame in frames]
    outlines = [whole_outline(frame, surface, thresholds, rng) for frame in frames]
    places = np.array(
        [(*each.origin[:2], _turn(each.east, surface)) for each in outlines if each is not None]
    ).reshape(-1, 3)
    higher = float(np.median([plane.offset / plane.normal[2] for plane in planes]))
    slanted = float(np.median([degrees(acos(min(1.0, plane.normal[2]))) for plane in planes]))
    if not len(places):
        return Seen(higher, slanted, None, None)
    east, north, turned = (float(each) for each in np.median(places, axis=0))
    return Seen(higher, slanted, (east, north), turned)


def _turn(east: Floats, surface: Surface) -> float:
    """Degrees from the scene's x to a rectangle's, which looks the same after half a turn, and a square after
    a quarter."""
    period = 90.0 if surface.width == surface.depth else 180.0
    return (degrees(atan2(east[1], east[0])) + period / 2) % period - period / 2


def felt(touches: Sequence[Touch], board: Board, laid: Laid, table: Floats) -> Felt:
    """Where the tool is by touches, if the robot finds the table at the pose `table` (4, 4). At least one."""
    tools = np.array([touch.tool for touch in touches], np.float64)
    places = (tools - table[:3, 3]) @ table[:3, :3]
    away = []
    for touch, place in zip(touches, places, strict=True):
        if touch.corner is not None:
            (wanted,) = laid.places(board, np.array([board.corner_names.index(touch.corner)]))
            away.append(place[:2] - wanted)
    beside = float(np.linalg.norm(np.mean(away, axis=0))) if away else None
    return Felt(float(places[:, 2].mean()), beside)


def faults_seen(found: Seen) -> tuple[str, ...]:
    """What of the camera's place cannot be right, in words."""
    told = []
    if abs(found.higher) > HIGHER:
        way = "above" if found.higher > 0 else "below"
        told.append(
            f"the table is seen {abs(1000 * found.higher):.0f} mm {way} its place: the camera stands "
            f"{'lower' if found.higher > 0 else 'higher'} than the cell says, or depth is off"
        )
    if found.slanted > SLANTED:
        told.append(f"the table is seen to slant by {found.slanted:.1f} degrees: the camera slants otherwise")
    if found.shifted is not None and hypot(*found.shifted) > SHIFTED:
        told.append(
            f"the table's middle is seen {_way(*found.shifted)} of its place: the camera or the table was "
            "moved"
        )
    if found.turned is not None and abs(found.turned) > TURNED:
        way = "counter-clockwise" if found.turned > 0 else "clockwise"
        told.append(
            f"the table is seen turned by {abs(found.turned):.1f} degrees {way}: the camera, the board or "
            "the table was turned"
        )
    return tuple(told)


def faults_felt(found: Felt) -> tuple[str, ...]:
    """What of the robot's place cannot be right, in words."""
    told = []
    if abs(found.higher) > TOOL:
        way = "lower" if found.higher < 0 else "higher"
        meaning = "strokes would pass above it" if found.higher < 0 else "strokes would press into it"
        off = abs(1000 * found.higher)
        told.append(f"the tool touches the table {off:.1f} mm {way} than the cell says: {meaning}")
    if found.beside is not None and found.beside > BESIDE:
        told.append(
            f"the tool touches corners of the board {1000 * found.beside:.0f} mm beside them: the table, the "
            "board or the robot was moved"
        )
    return tuple(told)


def _way(east: float, north: float) -> str:
    parts = (
        f"{abs(1000 * by):.0f} mm {there if by > 0 else back}"
        for by, there, back in ((east, "east", "west"), (north, "north", "south"))
        if abs(by) >= 0.001
    )
    return " and ".join(parts)
