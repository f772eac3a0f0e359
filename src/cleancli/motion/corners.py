"""From the corners of a stroke to the tool's poses on it: down behind the first, perpendicular to the motion,
and turning at the others."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import atan2, hypot

import numpy as np

from cleancli.geometry.ellipse import Ellipse, Point, reach
from cleancli.motion.path import EDGE_MARGIN
from cleancli.scene.model import Scene

# Chosen: the tool comes down this far behind the dirt. The rag's ends lead its middle by 6 mm, the cloth is
# 4 mm thick, the ellipse of an area leaves out a part of its outermost dirt.
CLEARANCE = 0.02
TURN_STRETCH = 0.02  # a corner is turned from this far before it to this far after it
_SAME_PLACE = 1e-3  # corners closer than this are one


def behind_middle(area: Ellipse, ahead: Point) -> Point:
    """Where a stroke begins that leads over the area's middle towards a place: as far behind it as the area
    reaches, so that as much of it lies on either side."""
    x, y = direction(area.centre, ahead)
    back = reach(area, (x, y))
    return area.centre[0] - back * x, area.centre[1] - back * y


def behind(corners: tuple[Point, ...], scene: Scene) -> Point:
    """Where the tool comes down: behind the first corner, but not off the surface."""
    x, y = direction(corners[0], corners[1])
    width, depth = scene.surface.width / 2 - EDGE_MARGIN, scene.surface.depth / 2 - EDGE_MARGIN
    back = corners[0][0] - CLEARANCE * x, corners[0][1] - CLEARANCE * y
    return min(max(back[0], -width), width), min(max(back[1], -depth), depth)


def turning(corners: tuple[Point, ...]) -> tuple[tuple[float, float, float], ...]:
    """Poses (x, y, yaw) of the stroke: perpendicular on every straight piece, and turning evenly from a
    little before each inner corner to a little after it."""
    pieces = list(pairwise(corners))
    poses: list[tuple[float, float, float]] = []
    for index, (begin, end) in enumerate(pieces):
        x, y = direction(begin, end)
        length = hypot(end[0] - begin[0], end[1] - begin[1])
        yaw = atan2(y, x)
        stretch = min(TURN_STRETCH, length / 3)
        after = stretch if index > 0 else 0.0
        poses.append((begin[0] + after * x, begin[1] + after * y, yaw))
        if index + 1 == len(pieces):
            poses.append((*end, yaw))
            continue
        following = atan2(*reversed(direction(*pieces[index + 1])))
        turn = (following - yaw + np.pi) % (2 * np.pi) - np.pi
        poses.append((end[0] - stretch * x, end[1] - stretch * y, yaw))
        poses.append((*end, yaw + turn / 2))
    return tuple(poses)


def distinct(corners: Sequence[Point]) -> tuple[Point, ...]:
    """The corners without those that stand where the one before stands; two remain even of one point."""
    kept = [corners[0]]
    for corner in corners[1:]:
        if hypot(corner[0] - kept[-1][0], corner[1] - kept[-1][1]) > _SAME_PLACE:
            kept.append(corner)
    return tuple(kept) if len(kept) > 1 else (corners[0], corners[0])


def direction(begin: Point, end: Point) -> Point:
    """The unit vector from one point to another; east, if they are one point."""
    x, y = end[0] - begin[0], end[1] - begin[1]
    length = hypot(x, y)
    return (x / length, y / length) if length > 0 else (1.0, 0.0)
