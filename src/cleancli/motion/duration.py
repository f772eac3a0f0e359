"""About how long a robot takes for a tool path, by its length and its speeds: for plans, before anything is
timed exactly (motion/timing.py)."""

from __future__ import annotations

from itertools import pairwise
from math import cos, dist, hypot

from cleancli.geometry.ellipse import Point
from cleancli.motion.legs import SHARPEST
from cleancli.motion.pace import TRANSIT_SPEED
from cleancli.motion.path import ToolPath, Waypoint

STOP = 0.12
"""Seconds that it costs to come to rest and to start again. Chosen: the gantry's, at 0.25 m/s and 2 m/s²."""


def expected_seconds(path: ToolPath, start: Point) -> float:
    """Seconds from above `start` to the end of the path: up, across to where it begins, and along it.

    About right for any robot whose joints are quick enough for the speeds of the path (tests/motion).
    """
    first = path.waypoints[0]
    across = dist(start, (first.x, first.y)) / TRANSIT_SPEED
    along = sum(dist((a.x, a.y, a.z), (b.x, b.y, b.z)) / b.speed for a, b in pairwise(path.waypoints))
    stops = 1 + sum(map(_stops, path.waypoints, path.waypoints[1:], path.waypoints[2:]))
    return across + along + STOP * (stops + 1)


def _stops(before: Waypoint, here: Waypoint, after: Waypoint) -> bool:
    """Whether the tool comes to rest at a waypoint: where it comes down, is lifted or turns back."""
    if (before.z == here.z) != (here.z == after.z):
        return True
    came, goes = (here.x - before.x, here.y - before.y), (after.x - here.x, after.y - here.y)
    along = came[0] * goes[0] + came[1] * goes[1]
    return along < cos(SHARPEST) * hypot(*came) * hypot(*goes)
