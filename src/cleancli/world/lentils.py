"""Lentils on a simulated table: their shape, where a scene drops them, and when they have come to rest."""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy.typing import NDArray

from cleancli.scene.model import Group, Scattered
from cleancli.world import parameters as par
from cleancli.world.physics import Engine

_CORNERS = 8
# (radius, height) of the rings of corners, as shares of the half diameter and the half thickness.
_RINGS = ((0.4, 1.0), (0.8, 0.6), (1.0, 0.0), (0.8, -0.6), (0.4, -1.0))


def drop(engine: Engine, spots: NDArray[np.float64], rng: np.random.Generator) -> tuple[int, ...]:
    """Bodies of lentils just above the surface at `spots` (n, 2), stacked where spots are too close."""
    corners, faces = _mesh()
    hull = engine.createCollisionShape(engine.GEOM_MESH, vertices=corners.tolist())
    looks = [
        engine.createVisualShape(
            engine.GEOM_MESH,
            vertices=corners.tolist(),
            indices=faces,
            rgbaColor=[*(c / 255 for c in colour), 1],
        )
        for colour in par.LENTIL_COLOURS
    ]
    bodies = []
    for (x, y), height in zip(spots, _heights(spots), strict=True):
        body = engine.createMultiBody(
            baseMass=par.LENTIL_MASS,
            baseCollisionShapeIndex=hull,
            baseVisualShapeIndex=looks[rng.integers(len(looks))],
            basePosition=[x, y, height],
            baseOrientation=engine.getQuaternionFromEuler([0, 0, rng.uniform(0, np.pi)]),
            useMaximalCoordinates=1,
        )
        engine.changeDynamics(
            body,
            -1,
            lateralFriction=par.LENTIL_FRICTION * (1 + par.LENTIL_FRICTION_SPREAD * rng.uniform(-1, 1)),
            rollingFriction=par.LENTIL_ROLLING,
            spinningFriction=par.LENTIL_ROLLING,
            collisionMargin=par.LENTIL_MARGIN,
            activationState=engine.ACTIVATION_STATE_ENABLE_SLEEPING,
        )
        bodies.append(body)
    return tuple(bodies)


def places(dirt: tuple[Group | Scattered, ...], rng: np.random.Generator) -> NDArray[np.float64]:
    """(n, 2) points to drop lentils at, evenly drawn in each group's disc or each rectangle."""
    drawn = [np.empty((0, 2))]
    for source in dirt:
        match source:
            case Group(count, centre, radius):
                angle = rng.uniform(0, 2 * np.pi, count)
                distance = radius * np.sqrt(rng.uniform(0, 1, count))
                step = np.stack((distance * np.cos(angle), distance * np.sin(angle)), axis=1)
                drawn.append(np.array(centre) + step)
            case Scattered(count, low, high):
                drawn.append(rng.uniform(low, high, (count, 2)))
    return np.concatenate(drawn)


def positions(engine: Engine, bodies: tuple[int, ...]) -> NDArray[np.float64]:
    """(n, 3) middles of the lentils, metres."""
    return np.array([engine.getBasePositionAndOrientation(body)[0] for body in bodies]).reshape(-1, 3)


def settle(engine: Engine, bodies: tuple[int, ...]) -> None:
    """Let time pass until every lentil rests, or the limit is reached."""
    quarter = ceil(0.25 / par.STEP)
    for _ in range(ceil(par.SETTLE_LIMIT / 0.25)):
        for _ in range(quarter):
            engine.stepSimulation()
        if all(np.linalg.norm(engine.getBaseVelocity(body)[0]) < par.SETTLED_SPEED for body in bodies):
            return


def _heights(spots: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n,) heights to drop from, so that no two lentils start inside each other."""
    layers = np.zeros(len(spots))
    for index in range(len(spots)):
        apart = np.linalg.norm(spots[:index] - spots[index], axis=1)
        taken = layers[:index][apart < 1.1 * par.LENTIL_DIAMETER]
        layers[index] = taken.max() + 1 if taken.size else 0
    return par.DROP_HEIGHT + 1.2 * par.LENTIL_THICKNESS * layers


def _mesh() -> tuple[NDArray[np.float64], list[int]]:
    """Corners (40, 3) of one lentil, and those of its triangles by number, counter-clockwise from outside."""
    angle = 2 * np.pi * np.arange(_CORNERS) / _CORNERS
    rings = [
        np.stack((radius * np.cos(angle), radius * np.sin(angle), np.full(_CORNERS, height)), axis=1)
        for radius, height in _RINGS
    ]
    radius, height = par.LENTIL_DIAMETER / 2, par.LENTIL_THICKNESS / 2
    corners = np.concatenate(rings) * [radius, radius, height]
    faces: list[int] = []
    for ring in range(len(_RINGS) - 1):
        for corner in range(_CORNERS):
            upper, lower = ring * _CORNERS, (ring + 1) * _CORNERS
            following = (corner + 1) % _CORNERS
            faces += [upper + corner, lower + corner, lower + following]
            faces += [upper + corner, lower + following, upper + following]
    last = (len(_RINGS) - 1) * _CORNERS
    for corner in range(1, _CORNERS - 1):
        faces += [0, corner, corner + 1]
        faces += [last, last + corner + 1, last + corner]
    return corners, faces
