"""A push as four numbers, for agents that choose places on the table and no symbols."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Floats
from cleancli.geometry.ellipse import Point
from cleancli.motion.actions import OVERSHOOT
from cleancli.scene.model import Scene


def rectangle(scene: Scene) -> tuple[Floats, Floats]:
    """The lowest and highest (x, y), in metres, between which a push may start and end: the surface, and over
    the container's edge as far as a whole rag goes past it."""
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    beyond = (scene.rag.width / 2 + OVERSHOOT) * np.array(scene.outwards())
    return np.minimum(-half, -half + beyond), np.maximum(half, half + beyond)


def ends(action: Sequence[float] | NDArray[np.floating], scene: Scene) -> tuple[Point, Point]:
    """Where a push starts and ends, of four numbers between -1 and 1: x and y of both, as shares of the
    rectangle. The start is brought onto the surface. Raises ValueError for anything else."""
    numbers = np.asarray(action, np.float64)
    if numbers.shape != (4,) or not np.isfinite(numbers).all():
        raise ValueError(f"a push is four numbers between -1 and 1, not {action!r}")
    low, high = rectangle(scene)
    shares = (np.clip(numbers, -1, 1).reshape(2, 2) + 1) / 2
    (x0, y0), (x1, y1) = (low + shares * (high - low)).tolist()
    width, depth = scene.surface.width / 2, scene.surface.depth / 2
    return (min(max(x0, -width), width), min(max(y0, -depth), depth)), (x1, y1)
