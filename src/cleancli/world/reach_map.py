"""Where on the surface a robot can put its tool down, over a grid of places."""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.scene.model import Scene
from cleancli.world.robots.registry import ROBOTS

STEP = 0.02
"""Metres between places that are tried."""

_OUTWARDS = {"east": 0.0, "north": np.pi / 2, "west": np.pi, "south": -np.pi / 2}


def reach(scene: Scene) -> tuple[Floats, Bools]:
    """Places (n, 2) in a grid over the surface, metres, and whether the robot reaches each, (n,): with
    the rag on the surface, as it stands to push towards the container's edge."""
    axes = (_axis(scene.surface.width), _axis(scene.surface.depth))
    places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    height, yaw = np.zeros(len(places)), np.full(len(places), _OUTWARDS[scene.container.edge])
    return places, ROBOTS[scene.robot].reaches(np.column_stack((places, height, yaw)), scene)


def missed(points: Floats, places: Floats, reached: Bools) -> int:
    """How many of `points` (m, 2) lie nearest to one of the `places` (n, 2) that are not `reached` (n,)."""
    return sum(not reached[np.abs(places - point).sum(axis=1).argmin()] for point in points)


def _axis(length: float) -> Floats:
    """Places at most a step apart, from one end to the other."""
    return np.linspace(-length / 2, length / 2, int(np.ceil(length / STEP)) + 1)
