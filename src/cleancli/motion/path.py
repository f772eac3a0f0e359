"""Tool paths: where the rag goes for one action, before anything is timed or driven."""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass, replace

from cleancli.motion.pace import LIFT, TRANSIT_SPEED, VERTICAL_SPEED

EDGE_MARGIN = 0.005
"""Metres by which tools come down within the surface, at least."""


class Unreachable(Exception):
    """A robot can't bring its tool to a place of the table; nothing has moved."""

    def __init__(self, x: float, y: float, reason: str) -> None:
        super().__init__(f"it can't reach ({100 * x:.1f} cm, {100 * y:.1f} cm): {reason}")


class Interpolation(enum.Enum):
    """How the drive goes to the next waypoint (§3.2.1): shortest in joint space, or along a straight line."""

    JOINT = "joint"
    STRAIGHT = "straight"


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A tool pose: x, y, z of the rag's lower middle in metres (z = 0 touches the surface), `yaw` in radians
    of the direction the rag pushes to (the cloth stands perpendicular to it), `speed` in m/s on the way
    here."""

    x: float
    y: float
    z: float
    yaw: float
    speed: float


@dataclass(frozen=True, slots=True)
class Dustpan:
    """Where the second hand holds the dustpan while the rag pushes, and where it then tips it by `tip`
    radians.

    A dustpan's pose is that of its held end; its lip is ahead of the rag, against its yaw.
    """

    place: Waypoint
    empty: Waypoint
    tip: float


@dataclass(frozen=True, slots=True)
class ToolPath:
    """The rag's waypoints in order, and what the dustpan does meanwhile, if it takes part. The first and the
    last waypoint are above the surface (§3.2)."""

    waypoints: tuple[Waypoint, ...]
    interpolation: Interpolation
    dustpan: Dustpan | None = None

    @property
    def stroke(self) -> tuple[tuple[float, float], ...]:
        """x and y of the waypoints on the surface, metres."""
        return tuple((w.x, w.y) for w in self.waypoints if w.z <= 0)


def along(poses: Sequence[tuple[float, float, float]], speed: float, how: Interpolation) -> ToolPath:
    """The path of a stroke over poses (x, y, yaw): down at the first, and up after the last (§3.2)."""
    (x, y, yaw), *others = poses
    last_x, last_y, last_yaw = poses[-1]
    return ToolPath(
        (
            Waypoint(x, y, LIFT, yaw, TRANSIT_SPEED),
            Waypoint(x, y, 0.0, yaw, VERTICAL_SPEED),
            *(Waypoint(x, y, 0.0, yaw, speed) for x, y, yaw in others),
            Waypoint(last_x, last_y, LIFT, last_yaw, VERTICAL_SPEED),
        ),
        how,
    )


def pressed(path: ToolPath, depth: float) -> ToolPath:
    """The path with the rag pressed so far below the surface on its stroke, metres; unchanged where a dustpan
    takes part, which the rag would push away."""
    if path.dustpan is not None:
        return path
    return replace(path, waypoints=tuple(replace(w, z=w.z - depth * (w.z <= 0)) for w in path.waypoints))
