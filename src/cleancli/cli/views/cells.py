"""What the commands of a real cell say of what they found."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cleancli.cell.camera import Sighted
from cleancli.cell.faults import Felt, Seen
from cleancli.cell.touches import Touched
from cleancli.language.diagnostics.plural import plural


def camera_told(found: Sighted, frames: int, out: Path) -> str:
    """Where the camera stands by a board, and what tells it, for people."""
    x, y, z = 100 * found.pose[:3, 3]
    slant = np.degrees(np.arccos(np.clip(-found.pose[2, 2], -1, 1)))
    lines = [
        f"{out}: the camera stands at ({x:z.1f}, {y:z.1f}, {z:z.1f}) cm, {slant:z.1f} degrees off looking "
        "straight down",
        f"board {found.board.name}: {plural(found.corners, 'corner')} in {found.pictures} of "
        f"{plural(frames, 'picture')}, {found.misfit:z.2f} pixels off on average",
    ]
    if found.depth_scale is not None:
        lines.append(
            f"the plane by {found.points} points of depth, which shows the board "
            f"{abs(1 / found.depth_scale - 1):z.1%} {'smaller' if found.depth_scale > 1 else 'larger'} than "
            "it is"
        )
    return "\n".join(lines)


def camera_data(found: Sighted) -> dict[str, object]:
    """The same for programs."""
    return {
        "pose": found.pose.tolist(),
        "board": found.board.name,
        "corners": found.corners,
        "pictures": found.pictures,
        "misfit": found.misfit,
        "depth_scale": found.depth_scale,
        "points": found.points,
        "doubts": list(found.doubts),
    }


def table_told(found: Touched, out: Path) -> str:
    """Where the robot finds the table, and how exactly, for people."""
    x, y, z = 1000 * found.pose[:3, 3]
    slant = np.degrees(np.arccos(np.clip(found.pose[2, 2], -1, 1)))
    turn = np.degrees(np.arctan2(found.pose[1, 0], found.pose[0, 0]))
    lines = [
        f"{out}: the table's middle is at ({x:z.1f}, {y:z.1f}, {z:z.1f}) mm for the robot; its x is turned "
        f"by {turn:z.1f} degrees from the robot's, and it slants by {slant:z.2f} degrees"
    ]
    told = plural(len(found.residuals), "touch", "touches")
    if found.spread is not None and found.height_errors is not None:
        middle, corner = (1000 * error for error in found.height_errors)
        lines.append(
            f"{told}, {1000 * found.spread:z.2f} mm off a plane; the height is so known to {middle:z.2f} mm "
            f"in the table's middle, and to {corner:z.2f} mm at its corners (standard deviations)"
        )
    if found.corners is not None:
        lines.append(f"corners of the board are {1000 * found.corners.misfit:z.1f} mm off on average")
    return "\n".join(lines)


def table_data(found: Touched) -> dict[str, object]:
    """The same for programs."""
    corners = found.corners
    return {
        "pose": found.pose.tolist(),
        "residuals": found.residuals.tolist(),
        "spread": found.spread,
        "height_errors": found.height_errors,
        "corners": None if corners is None else {"misfit": corners.misfit, "scale": corners.scale},
        "doubts": list(found.doubts),
    }


def seen_told(found: Seen | None) -> list[str]:
    """Where the camera sees the table; nothing where it was not asked."""
    if found is None:
        return []
    lines = [
        f"the camera sees the table {1000 * found.higher:+z.1f} mm above its place, slanting by "
        f"{found.slanted:z.2f} degrees"
    ]
    if found.shifted is None or found.turned is None:
        return [*lines, "its rim is not in view whole, so that nothing is known of its place and turn"]
    east, north = (1000 * by for by in found.shifted)
    return [
        *lines,
        f"its middle is {east:+z.1f} mm east and {north:+z.1f} mm north of its place, and it is turned by "
        f"{found.turned:+z.2f} degrees",
    ]


def felt_told(found: Felt | None) -> list[str]:
    """Where the tool touches the table; nothing where it was not asked."""
    if found is None:
        return []
    beside = (
        "" if found.beside is None else f", and {1000 * found.beside:z.1f} mm beside corners of the board"
    )
    return [f"the tool touches the table {1000 * found.higher:+z.2f} mm above its place{beside}"]
