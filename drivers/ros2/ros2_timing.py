"""When an arm is where along a straight piece of its path, and where that piece lies for its base. No ROS."""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Floats
from cleancli.motion.path import Waypoint

ACCELERATION = 0.5
"""m/s² of the tool along a piece, at its beginning and its end. Chosen."""
TURNING = 0.1
"""Metres that a radian of turning counts as: the end of a rag moves about so far."""
MOST_JUMP = 0.2
"""Radians by which a joint may move from one point of a piece to the next, 5 mm on: more is an arm that
turns over."""


class NoWay(Exception):
    """A path that the arm cannot follow; the message says why."""


def in_base(table: Floats, waypoint: Waypoint) -> tuple[Floats, Floats]:
    """Place (3,) and quaternion (x, y, z, w) of a waypoint in the coordinates of the robot's base. `table`
    (4, 4) leads there from the scene's, as `cleancli cell touch` found."""
    place = table[:3, :3] @ (waypoint.x, waypoint.y, waypoint.z) + table[:3, 3]
    cos, sin = np.cos(waypoint.yaw), np.sin(waypoint.yaw)
    return place, quaternion(table[:3, :3] @ np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]]))


def in_scene(table: Floats, place: Floats) -> tuple[float, float, float]:
    """A place of the base's coordinates in those of the scene."""
    x, y, z = table[:3, :3].T @ (place - table[:3, 3])
    return float(x), float(y), float(z)


def quaternion(turn: Floats) -> Floats:
    """(x, y, z, w) of a rotation (3, 3): the eigenvector of the largest eigenvalue of Bar-Itzhack's matrix
    (2000), which has no cases to tell apart."""
    (a, b, c), (d, e, f), (g, h, i) = turn
    matrix = np.array(
        [
            [a - e - i, b + d, c + g, h - f],
            [b + d, e - a - i, f + h, c - g],
            [c + g, f + h, i - a - e, d - b],
            [h - f, c - g, d - b, a + e + i],
        ]
    )
    found = np.linalg.eigh(matrix)[1][:, -1]
    return np.asarray(found if found[3] >= 0 else -found)


def length_of(before: Waypoint, after: Waypoint) -> float:
    """Metres from one waypoint to the next, or what a turn counts as."""
    far = float(np.linalg.norm((after.x - before.x, after.y - before.y, after.z - before.z)))
    turned = abs((after.yaw - before.yaw + np.pi) % (2 * np.pi) - np.pi)
    return max(far, TURNING * turned)


def timed(joints: Floats, length: float, speed: float, least: float) -> tuple[Floats, Floats]:
    """When each point of a piece is reached, (n,) seconds, and how fast its joints move there, (n, joints).

    The points `joints` (n, joints) lie evenly along it. The tool goes faster, keeps its `speed`, and slows
    down to stand still at the end; all of it takes `least` seconds, which the joints need, or longer. Raises
    NoWay where a joint jumps.
    """
    if np.abs(np.diff(joints, axis=0)).max(initial=0.0) > MOST_JUMP:
        raise NoWay("a joint would jump on the way: the arm turns over")
    gone = np.linspace(0, length, len(joints))
    most = min(speed, np.sqrt(ACCELERATION * length))
    ramp = most**2 / (2 * ACCELERATION)
    whole = length / most + most / ACCELERATION
    times = np.where(
        gone < ramp,
        np.sqrt(2 * gone / ACCELERATION),
        np.where(
            gone <= length - ramp,
            gone / most + most / (2 * ACCELERATION),
            whole - np.sqrt(2 * np.maximum(length - gone, 0) / ACCELERATION),
        ),
    )
    times *= max(1.0, least / whole)
    moving = np.zeros_like(joints)
    if len(joints) > 2:
        moving[1:-1] = (joints[2:] - joints[:-2]) / (times[2:] - times[:-2])[:, None]
    return times, moving
