"""Splits a tool path into legs: dense poses between the places where the tool has to stop for a moment.

The tool stops where it comes down on the surface, where it leaves it, and where it turns back; other corners
it rounds off.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cleancli.array_types import Floats
from cleancli.motion.path import Waypoint

SPACING = 5e-3  # metres between poses, at most
ROUNDING = 5e-3  # chosen: a corner is rounded off from this far before it to this far after it
SHARPEST = np.radians(100)  # chosen: at a corner sharper than this the tool stops
LEVER = 0.06  # a turn counts as the way of a point this far from the tool's middle
_SHORTEST = 1e-6  # pieces shorter than this are left out, metres


@dataclass(frozen=True, slots=True)
class Leg:
    """From rest to rest: `points` (n, 4) as x, y, z and yaw, at most `SPACING` apart, no two the same;
    `speeds` (n,) the highest tool speed on the way to each, m/s; `knots` the numbers of the points at or next
    to the waypoints, the ends included. `level` says that it goes at one height."""

    points: Floats
    speeds: Floats
    knots: tuple[int, ...]
    level: bool


def legs(waypoints: tuple[Waypoint, ...], offset: Floats) -> tuple[Leg, ...]:
    """The legs of a tool path, every pose moved by `offset` (4,). Yaw turns the shorter way at each
    waypoint."""
    corners = np.array([(w.x, w.y, w.z, w.yaw) for w in waypoints])
    corners[:, 3] = np.unwrap(corners[:, 3])
    speeds = np.array([w.speed for w in waypoints[1:]])
    kept = lengths(corners) > _SHORTEST
    corners = np.concatenate((corners[:1], corners[1:][kept]))
    speeds = speeds[kept]
    steps = np.diff(corners, axis=0) * (1, 1, 1, LEVER)
    level = np.abs(steps[:, 2]) < _SHORTEST
    steep = np.abs(steps[:, 2]) > np.linalg.norm(steps[:, :2], axis=1)
    headings = steps / np.linalg.norm(steps, axis=1)[:, None]
    back = (headings[1:] * headings[:-1]).sum(axis=1) < np.cos(SHARPEST)
    turns = back | (level[1:] != level[:-1]) | (steep[1:] != steep[:-1])
    stops = [0, *(np.flatnonzero(turns) + 1).tolist(), len(corners) - 1]
    return tuple(
        _leg(corners[begin : end + 1] + offset, speeds[begin:end], bool(level[begin]))
        for begin, end in pairwise(stops)
        if end > begin
    )


def lengths(points: Floats) -> Floats:
    """(n - 1,) ways between poses (n, 4), metres; a turn in place has a length too."""
    steps = np.diff(points, axis=0)
    ways: Floats = np.maximum(np.linalg.norm(steps[:, :3], axis=1), LEVER * np.abs(steps[:, 3]))
    return ways


def _leg(corners: Floats, speeds: Floats, level: bool) -> Leg:
    ways = lengths(corners)
    cuts = np.minimum(ROUNDING / ways, 1 / 3)  # the share of each piece that a rounded corner takes
    points, paces, knots = [corners[:1]], [speeds[:1]], [0]

    def append(more: Floats, pace: float) -> None:
        points.append(more)
        paces.append(np.full(len(more), pace))

    for k, step in enumerate(np.diff(corners, axis=0)):
        first, last = k == 0, k + 1 == len(ways)
        begin = corners[k] if first else corners[k] + cuts[k] * step
        end = corners[k + 1] if last else corners[k + 1] - cuts[k] * step
        append(_between(begin, end)[1:], speeds[k])
        if not last:
            following = corners[k + 1] + cuts[k + 1] * (corners[k + 2] - corners[k + 1])
            curve = _rounded(end, corners[k + 1], following)
            knots.append(sum(map(len, points)) - 1 + len(curve) // 2)
            append(curve, min(speeds[k], speeds[k + 1]))
    joined = np.concatenate(points)
    return Leg(joined, np.concatenate(paces), (*knots, len(joined) - 1), level)


def _between(begin: Floats, end: Floats) -> Floats:
    count = max(2, int(np.ceil(lengths(np.stack((begin, end)))[0] / SPACING)) + 1)
    return begin + np.linspace(0, 1, count)[:, None] * (end - begin)


def _rounded(begin: Floats, corner: Floats, end: Floats) -> Floats:
    """A parabola from `begin` to `end` that leaves and arrives in the directions of the corner's pieces."""
    shares = np.linspace(0, 1, 9)[1:, None]
    curve: Floats = (1 - shares) ** 2 * begin + 2 * shares * (1 - shares) * corner + shares**2 * end
    return curve
