"""Where on the surface a robot can put its tool down, over a grid of places."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cleancli.scene.model import Scene
from cleancli.world import robots

STEP = 0.02
"""Metres between places that are tried."""

Points = NDArray[np.float64]
Reached = NDArray[np.bool_]


def _gantry(places: Points, scene: Scene) -> Reached:
    """The limits of the carriages for x and y; the yaw has none."""
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 + robots.REACH_MARGIN
    return np.asarray((np.abs(places) <= half).all(axis=1))


REACHES: Mapping[str, Callable[[Points, Scene], Reached]] = MappingProxyType({"gantry": _gantry})
"""By drive: which of the places (n, 2) on the surface the tool can stand at, (n,)."""


def reach(scene: Scene) -> tuple[Points, Reached]:
    """Places (n, 2) in a grid over the surface, metres, and whether the scene's robot reaches each, (n,)."""
    axes = (_axis(scene.surface.width), _axis(scene.surface.depth))
    places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    return places, REACHES[scene.robot](places, scene)


def _axis(length: float) -> NDArray[np.float64]:
    """Places at most a step apart, from one end to the other."""
    return np.linspace(-length / 2, length / 2, int(np.ceil(length / STEP)) + 1)
