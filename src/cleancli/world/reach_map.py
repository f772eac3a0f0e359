"""Where on the surface a robot can put its tool down, over a grid of places, and which dirt it cannot clean
away."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import PICK_UP, can_execute, tool_paths
from cleancli.motion.path import ToolPath
from cleancli.scene.model import Scene
from cleancli.scene.robots import ARMS
from cleancli.world.robots.registry import ROBOTS

STEP = 0.02
"""Metres between places that are tried."""

CELL = 0.04
"""Metres of the squares whose dirt is asked about at once. Chosen: less than a rag is wide."""

SPECK = 1e-3
"""Metres of half the size of the dirt that is asked about. Chosen: less than a lentil's."""

_OUTWARDS = {"east": 0.0, "north": np.pi / 2, "west": np.pi, "south": -np.pi / 2}


def reach(scene: Scene) -> tuple[Floats, Bools]:
    """Places (n, 2) in a grid over the surface, metres, and whether the robot reaches each, (n,): with
    the rag on the surface, as it stands to push towards the container's edge."""
    axes = (_axis(scene.surface.width), _axis(scene.surface.depth))
    places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    height, yaw = np.zeros(len(places)), np.full(len(places), _OUTWARDS[scene.container.edge])
    return places, ROBOTS[scene.robot].reaches(np.column_stack((places, height, yaw)), scene)


def cleaning_of(robot: str) -> str:
    """The action by which a robot of that name cleans particles away: with two arms it picks them up."""
    return PICK_UP if can_execute(PICK_UP, 1, ARMS[robot]) else "moveToContainerStraight"


def missed(points: Floats, action: str, scene: Scene, can_follow: Callable[[ToolPath], bool]) -> int:
    """How many of `points` (n, 2), metres, lie where the robot can follow no path of an action upon them.
    Those of a square are asked about in their middle."""
    squares = np.rint(points / CELL)
    count = 0
    for square in np.unique(squares, axis=0):
        inside = points[(squares == square).all(axis=1)]
        x, y = inside.mean(axis=0).tolist()
        speck = Ellipse((x, y), (SPECK, SPECK), 0.0)
        count += 0 if any(map(can_follow, tool_paths(action, (speck,), scene))) else len(inside)
    return count


def _axis(length: float) -> Floats:
    """Places at most a step apart, from one end to the other."""
    return np.linspace(-length / 2, length / 2, int(np.ceil(length / STEP)) + 1)
