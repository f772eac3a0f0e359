"""About how long a robot takes for a tool path, by its length and its speeds: for plans, before anything is
timed exactly (motion/timing.py)."""

from __future__ import annotations

from itertools import pairwise
from math import dist

from cleancli.geometry.ellipse import Point
from cleancli.motion.pace import TRANSIT_SPEED
from cleancli.motion.path import ToolPath

STOP = 0.12
"""Seconds that it costs to come to rest and to start again. Chosen: the gantry's, at 0.25 m/s and 2 m/s²."""


def expected_seconds(path: ToolPath, start: Point) -> float:
    """Seconds from above `start` to the end of the path: up, across to where it begins, and along it.

    About right for any robot whose joints are quick enough for the speeds of the path (tests/motion).
    """
    first = path.waypoints[0]
    across = dist(start, (first.x, first.y)) / TRANSIT_SPEED
    along = sum(dist((a.x, a.y, a.z), (b.x, b.y, b.z)) / b.speed for a, b in pairwise(path.waypoints))
    level = [a.z == b.z for a, b in pairwise(path.waypoints)]
    stops = 1 + sum(one != other for one, other in pairwise(level))
    return across + along + STOP * (stops + 1)
