"""Ellipses on the surface: distances, points on and within, and those that actions start from (§3.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np

from cleancli.array_types import Bools, Floats, Longs, Points

_BOUNDARY_POINTS = 720
_COARSE = 8  # of so many points one is looked at first
_KEPT = 4096  # pairs of ellipses: a plan asks for the same ones again and again

_ANGLES = np.linspace(-pi, pi, 720, endpoint=False)
_NORMALS = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])

_NUMBERS = np.arange(128)
_TURNS = _NUMBERS * pi * (3 - 5**0.5)
_DISC = np.sqrt((_NUMBERS[:, None] + 0.5) / 128) * np.column_stack([np.cos(_TURNS), np.sin(_TURNS)])
"""As a sunflower's seeds stand, each for an equal share of the disc (Vogel, Math. Biosciences 44, 1979)."""


def gap(first: Ellipse, second: Ellipse) -> float:
    """Metres between two ellipses, 0 where they overlap.

    Two convex shapes are as far apart as the widest strip that fits between them, over all directions; half a
    degree between directions makes the result at most 1e-5 of the centres' distance too small.
    """
    between = np.array(second.centre) - np.array(first.centre)
    widest = (_NORMALS @ between - reaches((first, second), _NORMALS).sum(axis=1)).max()
    return max(0.0, float(widest))


def boundary(ellipse: Ellipse) -> Points:
    """(720, 2) points counter-clockwise, from the end of the longer axis."""
    turn = 2 * np.pi * np.arange(_BOUNDARY_POINTS) / _BOUNDARY_POINTS
    return _placed(ellipse, np.column_stack([np.cos(turn), np.sin(turn)]))


def points_within(ellipse: Ellipse) -> Points:
    """(128, 2) points spread evenly over the ellipse."""
    return _placed(ellipse, _DISC)


def contains(ellipse: Ellipse, points: Points) -> Bools:
    """For points (n, 2): whether each lies within the ellipse or on it, (n,)."""
    local = (points - np.array(ellipse.centre)) @ _rotation(ellipse)
    first, second = (max(axis, 1e-9) for axis in ellipse.axes)
    inside: Bools = (local[:, 0] / first) ** 2 + (local[:, 1] / second) ** 2 <= 1
    return inside


def extent(ellipse: Ellipse) -> float:
    """Square metres inside the ellipse."""
    return pi * ellipse.axes[0] * ellipse.axes[1]


def _placed(ellipse: Ellipse, unit: Points) -> Points:
    """Points of the unit disc (n, 2), stretched and turned as the ellipse is."""
    return np.array(ellipse.centre) + (unit * ellipse.axes) @ _rotation(ellipse).T


def _rotation(ellipse: Ellipse) -> Floats:
    cos, sin = np.cos(ellipse.angle), np.sin(ellipse.angle)
    return np.array(((cos, -sin), (sin, cos)))


@dataclass(frozen=True, slots=True)
class Ellipse:
    """`axes` are the half lengths, longer first; `angle` of the longer one from x, in (-pi/2, pi/2]."""

    centre: tuple[float, float]
    axes: tuple[float, float]
    angle: float


Point = tuple[float, float]


def reach(ellipse: Ellipse, direction: Point) -> float:
    """How far the ellipse reaches from its centre along a direction of length 1, either way, in metres."""
    return float(reaches((ellipse,), np.array(direction))[0])


def reaches(ellipses: Sequence[Ellipse], directions: Floats) -> Floats:
    """The same of n ellipses along directions (..., 2): (..., n)."""
    axes = np.array([each.axes for each in ellipses]).reshape(-1, 2)
    turns = np.array([each.angle for each in ellipses])
    x, y = directions[..., :1], directions[..., 1:]
    cos, sin = np.cos(turns), np.sin(turns)
    far: Floats = np.hypot(axes[:, 0] * (x * cos + y * sin), axes[:, 1] * (y * cos - x * sin))
    return far


def major_ends(ellipse: Ellipse) -> tuple[Point, Point]:
    """The two ends of the longer axis, the one its angle points to first."""
    step = ellipse.axes[0] * np.array((np.cos(ellipse.angle), np.sin(ellipse.angle)))
    centre = np.array(ellipse.centre)
    return _point(centre + step), _point(centre - step)


@lru_cache(maxsize=_KEPT)
def farthest(ellipse: Ellipse, other: Ellipse) -> Point:
    """The point of the ellipse farthest from the other; from its middle, if the other covers this ellipse."""
    points, theirs = boundary(ellipse), boundary(other)
    # The nearest point of a convex boundary is found roughly, and then around there.
    rough = _gaps(points, theirs[::_COARSE]).argmin(axis=1) * _COARSE
    away = np.hypot(*(points[:, None] - theirs[_around(rough)]).transpose(2, 0, 1)).min(axis=1)
    away[contains(other, points)] = 0
    if not away.any():
        away = np.linalg.norm(points - np.array(other.centre), axis=1)
    return _point(points[np.argmax(away)])


@lru_cache(maxsize=_KEPT)
def nearest(ellipse: Ellipse, other: Ellipse) -> tuple[Point, Point]:
    """The point of the ellipse nearest to the other, and that of the other nearest to the ellipse.

    Ellipses that overlap share many points: then both are one shared point near the line between the middles.
    """
    mine, theirs = boundary(ellipse), boundary(other)
    shared = _shared_point(ellipse, other, mine, theirs)
    if shared is not None:
        return shared, shared
    coarse = _gaps(mine[::_COARSE], theirs[::_COARSE])
    pair = np.array(np.unravel_index(np.argmin(coarse), coarse.shape)) * _COARSE
    while True:  # the gap of convex shapes falls on the way to its minimum
        rows, columns = _around(pair)
        gaps = _gaps(mine[rows], theirs[columns])
        row, column = np.unravel_index(np.argmin(gaps), gaps.shape)
        if gaps[row, column] == gaps[_COARSE, _COARSE]:
            return _point(mine[pair[0]]), _point(theirs[pair[1]])
        pair = np.array((rows[row], columns[column]))


def _shared_point(ellipse: Ellipse, other: Ellipse, mine: Points, theirs: Points) -> Point | None:
    common = np.concatenate((mine[contains(other, mine)], theirs[contains(ellipse, theirs)]))
    if not len(common):
        return None
    middle = (np.array(ellipse.centre) + np.array(other.centre)) / 2
    if contains(ellipse, middle[None])[0] and contains(other, middle[None])[0]:
        return _point(middle)
    return _point(common[np.argmin(np.linalg.norm(common - middle, axis=1))])


def _around(numbers: Longs) -> Longs:
    """The numbers (n, 2 * _COARSE + 1) of a boundary's points from a coarse step before each to one after."""
    return np.asarray((numbers[:, None] + np.arange(-_COARSE, _COARSE + 1)) % _BOUNDARY_POINTS)


def _gaps(first: Points, second: Points) -> Floats:
    """(n, m) distances between points (n, 2) and (m, 2)."""
    return np.hypot(first[:, None, 0] - second[None, :, 0], first[:, None, 1] - second[None, :, 1])


def _point(pair: Floats) -> Point:
    return float(pair[0]), float(pair[1])
