"""What stands still: the floor, the table with its legs, and the container below one edge."""

from __future__ import annotations

from itertools import product
from math import sin, sqrt

import numpy as np

from cleancli.array_types import Floats
from cleancli.scene.model import Container, Scene, Surface
from cleancli.world import constants as par
from cleancli.world.physics import Engine

_Triple = tuple[float, float, float]
_Box = tuple[_Triple, _Triple]  # lowest and highest corner


def build(engine: Engine, scene: Scene) -> int:
    """Put floor, table and container in place; the table's top is z = 0, and gravity slants if it tilts.

    The body of the table's top.
    """
    surface = scene.surface
    engine.setGravity(*gravity(surface))
    far, ground = par.FLOOR_HALF, -par.TABLE_HEIGHT
    floor = (-far, -far, ground - par.FLOOR_THICKNESS), (far, far, ground)
    _block(engine, floor, par.FLOOR_COLOUR, surface.friction)
    x, y = surface.width / 2, surface.depth / 2
    top = _block(engine, ((-x, -y, -par.TABLE_THICKNESS), (x, y, 0)), surface.colour, surface.friction)
    for leg in _legs(surface):
        _block(engine, leg, par.LEG_COLOUR, surface.friction)
    for wall in container_walls(scene.container, surface):
        _block(engine, wall, par.CONTAINER_COLOUR, par.CONTAINER_FRICTION)
    return top


def gravity(surface: Surface) -> _Triple:
    """Gravity as seen from the surface: the whole room is tilted with it."""
    east, north = (sin(angle) for angle in surface.tilt)
    down = sqrt(1 - east**2 - north**2)
    return par.GRAVITY * east, par.GRAVITY * north, par.GRAVITY * down


def container_space(container: Container, surface: Surface) -> _Box:
    """Lowest and highest corner of the container, walls included, reaching under the table's edge."""
    high = -par.TABLE_THICKNESS - par.CONTAINER_DROP
    low = high - par.CONTAINER_HEIGHT
    along = container.offset - container.width / 2, container.offset + container.width / 2
    half = (surface.depth if container.edge in ("north", "south") else surface.width) / 2
    across = half - par.CONTAINER_OVERLAP, half + container.depth
    if container.edge in ("south", "west"):
        across = -across[1], -across[0]
    if container.edge in ("north", "south"):
        return (along[0], across[0], low), (along[1], across[1], high)
    return (across[0], along[0], low), (across[1], along[1], high)


def container_walls(container: Container, surface: Surface) -> tuple[_Box, ...]:
    """The bottom and the four walls. The walls stand outside the mouth, which so keeps its full width."""
    (x0, y0, z0), (x1, y1, z1) = container_space(container, surface)
    wall = par.CONTAINER_WALL
    return (
        ((x0 - wall, y0 - wall, z0 - par.CONTAINER_BOTTOM), (x1 + wall, y1 + wall, z0)),
        ((x0 - wall, y0 - wall, z0), (x0, y1 + wall, z1)),
        ((x1, y0 - wall, z0), (x1 + wall, y1 + wall, z1)),
        ((x0, y0 - wall, z0), (x1, y0, z1)),
        ((x0, y1, z0), (x1, y1 + wall, z1)),
    )


def corners(scene: Scene) -> Floats:
    """(n, 3) corners of the table, down to the floor, and of the container."""
    x, y = scene.surface.width / 2, scene.surface.depth / 2
    boxes = ((-x, -y, -par.TABLE_HEIGHT), (x, y, 0.0)), container_space(scene.container, scene.surface)
    return np.array([corner for box in boxes for corner in product(*zip(*box, strict=True))])


def _legs(surface: Surface) -> tuple[_Box, ...]:
    x, y = surface.width / 2, surface.depth / 2
    leg, bottom, top = par.LEG, -par.TABLE_HEIGHT, -par.TABLE_THICKNESS
    return tuple(
        ((west, south, bottom), (west + leg, south + leg, top))
        for west in (-x, x - leg)
        for south in (-y, y - leg)
    )


def _block(engine: Engine, box: _Box, colour: tuple[int, int, int], friction: float) -> int:
    low, high = box
    half = [(b - a) / 2 for a, b in zip(low, high, strict=True)]
    body: int = engine.createMultiBody(
        baseMass=0,
        baseCollisionShapeIndex=engine.createCollisionShape(engine.GEOM_BOX, halfExtents=half),
        baseVisualShapeIndex=engine.createVisualShape(
            engine.GEOM_BOX, halfExtents=half, rgbaColor=[*(c / 255 for c in colour), 1]
        ),
        basePosition=[(a + b) / 2 for a, b in zip(low, high, strict=True)],
    )
    engine.changeDynamics(body, -1, lateralFriction=friction, rollingFriction=0, spinningFriction=0)
    return body
