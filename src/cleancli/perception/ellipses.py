"""Measures of ellipses on the surface that tracking and symbols share."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from cleancli.perception.area import Ellipse

_ANGLES = np.linspace(-pi, pi, 720, endpoint=False)
_NORMALS = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])


def gap(first: Ellipse, second: Ellipse) -> float:
    """Metres between two ellipses, 0 where they overlap.

    Two convex shapes are as far apart as the widest strip that fits between them, over all directions; half a
    degree between directions makes the result at most 1e-5 of the centres' distance too small.
    """
    between = np.array(second.centre) - np.array(first.centre)
    widest = (_NORMALS @ between - _reach(first) - _reach(second)).max()
    return max(0.0, float(widest))


def extent(ellipse: Ellipse) -> float:
    """Square metres inside the ellipse."""
    return pi * ellipse.axes[0] * ellipse.axes[1]


def _reach(ellipse: Ellipse) -> NDArray[np.float64]:
    """How far the ellipse reaches from its centre along each direction."""
    long, short = ellipse.axes
    along = _NORMALS @ np.array([cos(ellipse.angle), sin(ellipse.angle)])
    across = _NORMALS @ np.array([-sin(ellipse.angle), cos(ellipse.angle)])
    return np.asarray(np.hypot(long * along, short * across))
