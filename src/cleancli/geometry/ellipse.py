"""Measures of ellipses on the surface that tracking, symbols, occlusion and motion share."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from cleancli.perception.area import Ellipse

Points = NDArray[np.float64]

_BOUNDARY_POINTS = 720

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
    widest = (_NORMALS @ between - _reach(first) - _reach(second)).max()
    return max(0.0, float(widest))


def boundary(ellipse: Ellipse) -> Points:
    """(720, 2) points counter-clockwise, from the end of the longer axis."""
    turn = 2 * np.pi * np.arange(_BOUNDARY_POINTS) / _BOUNDARY_POINTS
    return _placed(ellipse, np.column_stack([np.cos(turn), np.sin(turn)]))


def points_within(ellipse: Ellipse) -> Points:
    """(128, 2) points spread evenly over the ellipse."""
    return _placed(ellipse, _DISC)


def contains(ellipse: Ellipse, points: Points) -> NDArray[np.bool_]:
    """For points (n, 2): whether each lies within the ellipse or on it, (n,)."""
    local = (points - np.array(ellipse.centre)) @ _rotation(ellipse)
    first, second = (max(axis, 1e-9) for axis in ellipse.axes)
    inside: NDArray[np.bool_] = (local[:, 0] / first) ** 2 + (local[:, 1] / second) ** 2 <= 1
    return inside


def extent(ellipse: Ellipse) -> float:
    """Square metres inside the ellipse."""
    return pi * ellipse.axes[0] * ellipse.axes[1]


def _placed(ellipse: Ellipse, unit: Points) -> Points:
    """Points of the unit disc (n, 2), stretched and turned as the ellipse is."""
    return np.array(ellipse.centre) + (unit * ellipse.axes) @ _rotation(ellipse).T


def _rotation(ellipse: Ellipse) -> NDArray[np.float64]:
    cos, sin = np.cos(ellipse.angle), np.sin(ellipse.angle)
    return np.array(((cos, -sin), (sin, cos)))


def _reach(ellipse: Ellipse) -> NDArray[np.float64]:
    """How far the ellipse reaches from its centre along each direction."""
    long, short = ellipse.axes
    along, across = (_NORMALS @ _rotation(ellipse)).T
    return np.asarray(np.hypot(long * along, short * across))
