"""Particles on a simulated table: their shapes, where a scene drops them, and when they have come to rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, hypot

import numpy as np

from cleancli.array_types import Floats
from cleancli.scene.model import Colour, Dirt, Group, Ink, Scattered
from cleancli.world import constants as par
from cleancli.world.physics import Engine

_TRIES = 1000
"""Places that are drawn for a block at most until one is free."""

_CORNERS = 8
Pair = tuple[float, float]

_LENTIL_RINGS = ((0.4, 1.0), (0.8, 0.6), (1.0, 0.0), (0.8, -0.6), (0.4, -1.0))
_ROUND_RINGS = tuple((float(np.cos(a)), float(np.sin(a))) for a in np.radians((65, 35, 0, -35, -65)))
"""(radius, height) of the rings of corners, as shares of half the width and half the height."""


@dataclass(frozen=True, slots=True)
class Drops:
    """Where particles are dropped: `spots` (n, 2) in metres, what each is, `kinds` (n), and its colour, if it
    is not one of its kind's."""

    spots: Floats
    kinds: tuple[str, ...]
    colours: tuple[Colour | None, ...]


@dataclass(frozen=True, slots=True)
class _Shapes:
    touched: int
    seen: tuple[int, ...]


def drop(engine: Engine, drops: Drops, rng: np.random.Generator) -> tuple[int, ...]:
    """Bodies of particles just above the surface, stacked where spots are too close."""
    looks = tuple(zip(drops.kinds, drops.colours, strict=True))
    shapes = {look: _shapes(engine, par.PARTICLES[look[0]], look[1]) for look in dict.fromkeys(looks)}
    bodies = []
    for (x, y), look, height in zip(drops.spots, looks, _heights(drops), strict=True):
        particle, shape = par.PARTICLES[look[0]], shapes[look]
        body = engine.createMultiBody(
            baseMass=particle.mass,
            baseCollisionShapeIndex=shape.touched,
            baseVisualShapeIndex=shape.seen[rng.integers(len(shape.seen))],
            basePosition=[x, y, height],
            baseOrientation=engine.getQuaternionFromEuler([0, 0, rng.uniform(0, np.pi)]),
            useMaximalCoordinates=1,
        )
        engine.changeDynamics(
            body,
            -1,
            lateralFriction=particle.friction * (1 + par.FRICTION_SPREAD * rng.uniform(-1, 1)),
            rollingFriction=particle.rolling,
            spinningFriction=particle.rolling,
            collisionMargin=par.PARTICLE_MARGIN,
            activationState=engine.ACTIVATION_STATE_ENABLE_SLEEPING,
        )
        bodies.append(body)
    return tuple(bodies)


def places(dirt: tuple[Dirt, ...], rng: np.random.Generator) -> Drops:
    """Where to drop particles, evenly drawn in each group's disc or each rectangle; ink is none.

    Blocks lie beside each other, as one that lay on another would be no dirt on the surface but a thing that
    stands there: one that is drawn too close to an earlier one is drawn again.
    """
    drawn, kinds, colours = [np.empty((0, 2))], list[str](), list[Colour | None]()
    for source in dirt:
        match source:
            case Group(count, centre, radius, of, colour):

                def in_disc(number: int, centre: Pair = centre, radius: float = radius) -> Floats:
                    angle = rng.uniform(0, 2 * np.pi, number)
                    distance = radius * np.sqrt(rng.uniform(0, 1, number))
                    step = np.stack((distance * np.cos(angle), distance * np.sin(angle)), axis=1)
                    return np.array(centre) + step

                drawn.append(_spots(in_disc, count, par.PARTICLES[of]))
                kinds += [of] * count
                colours += [colour] * count
            case Scattered(count, low, high, of, colour):

                def in_rectangle(number: int, low: Pair = low, high: Pair = high) -> Floats:
                    return rng.uniform(low, high, (number, 2))

                drawn.append(_spots(in_rectangle, count, par.PARTICLES[of]))
                kinds += [of] * count
                colours += [colour] * count
            case Ink():
                pass
    return Drops(np.concatenate(drawn), tuple(kinds), tuple(colours))


def _spots(draw: Callable[[int], Floats], count: int, particle: par.Particle) -> Floats:
    """(count, 2) drawn places; those of boxes leave room for each other, however they are turned."""
    spots = draw(count)
    if particle.shape is par.Shape.BOX:
        room = 2 * _room(particle)
        for index in range(1, count):
            for _ in range(_TRIES):
                if np.linalg.norm(spots[:index] - spots[index], axis=1).min() > room:
                    break
                spots[index] = draw(1)[0]
    return spots


def positions(engine: Engine, bodies: tuple[int, ...]) -> Floats:
    """(n, 3) middles of the particles, metres."""
    return np.array([engine.getBasePositionAndOrientation(body)[0] for body in bodies]).reshape(-1, 3)


def keep_in_room(engine: Engine, bodies: tuple[int, ...]) -> None:
    """Where the floor ends falls end: what has got past its edge, at its level or lower, is at rest there and
    stays for good. So a particle's place says whether it is, and a saved state needs to say no more."""
    for body in bodies:
        (x, y, z), turn = engine.getBasePositionAndOrientation(body)
        if z <= -par.TABLE_HEIGHT and max(abs(x), abs(y)) >= par.FLOOR_HALF:
            engine.changeDynamics(body, -1, mass=0)
            engine.resetBasePositionAndOrientation(body, (x, y, -par.TABLE_HEIGHT), turn)
            engine.resetBaseVelocity(body, (0, 0, 0), (0, 0, 0))


def settle(engine: Engine, bodies: tuple[int, ...]) -> None:
    """Let time pass until every particle rests, or the limit is reached."""
    quarter = ceil(0.25 / par.STEP)
    for _ in range(ceil(par.SETTLE_LIMIT / 0.25)):
        for _ in range(quarter):
            engine.stepSimulation()
        keep_in_room(engine, bodies)
        if all(np.linalg.norm(engine.getBaseVelocity(body)[0]) < par.SETTLED_SPEED for body in bodies):
            return


def _shapes(engine: Engine, particle: par.Particle, own: Colour | None) -> _Shapes:
    """What the engine lets collide is the convex hull of the corners; what it shows is their mesh."""
    if particle.shape is par.Shape.BOX:
        return _box_shapes(engine, particle, own)
    rings = _LENTIL_RINGS if particle.shape is par.Shape.LENS else _ROUND_RINGS
    corners, faces = _mesh(rings, particle)
    if particle.size[0] == particle.size[2]:
        # A ball rolls; a hull of corners would come to rest on a face.
        touched = engine.createCollisionShape(engine.GEOM_SPHERE, radius=particle.size[0] / 2)
    else:
        touched = engine.createCollisionShape(engine.GEOM_MESH, vertices=corners.tolist())
    seen = tuple(
        engine.createVisualShape(
            engine.GEOM_MESH,
            vertices=corners.tolist(),
            indices=faces,
            rgbaColor=[*(c / 255 for c in colour), 1],
        )
        for colour in (particle.colours if own is None else (own,))
    )
    return _Shapes(touched, seen)


def _box_shapes(engine: Engine, particle: par.Particle, own: Colour | None) -> _Shapes:
    half = [side / 2 for side in particle.size]
    seen = tuple(
        engine.createVisualShape(engine.GEOM_BOX, halfExtents=half, rgbaColor=[*(c / 255 for c in colour), 1])
        for colour in (particle.colours if own is None else (own,))
    )
    return _Shapes(engine.createCollisionShape(engine.GEOM_BOX, halfExtents=half), seen)


def _heights(drops: Drops) -> Floats:
    """(n,) heights to drop from, so that no two particles start inside each other."""
    kinds = [par.PARTICLES[kind] for kind in drops.kinds]
    room, high = np.array([(_room(kind), 1.2 * kind.size[2]) for kind in kinds]).reshape(-1, 2).T
    tops = np.zeros(len(drops.spots))
    for index in range(len(drops.spots)):
        apart = np.linalg.norm(drops.spots[:index] - drops.spots[index], axis=1)
        below = tops[:index][apart < room[:index] + room[index]]
        tops[index] = (below.max() if below.size else 0) + high[index]
    heights: Floats = par.DROP_HEIGHT + tops - high
    return heights


def _room(particle: par.Particle) -> float:
    """Metres around its middle that a particle needs, however it is turned; a round one a bit more."""
    wide, deep, _ = particle.size
    return hypot(wide, deep) / 2 if particle.shape is par.Shape.BOX else 0.55 * wide


def _mesh(rings: tuple[tuple[float, float], ...], particle: par.Particle) -> tuple[Floats, list[int]]:
    """Corners (40, 3) of a particle, and those of its triangles by number, counter-clockwise from outside."""
    angle = 2 * np.pi * np.arange(_CORNERS) / _CORNERS
    layers = [
        np.stack((radius * np.cos(angle), radius * np.sin(angle), np.full(_CORNERS, height)), axis=1)
        for radius, height in rings
    ]
    corners = np.concatenate(layers) * np.array(particle.size) / 2
    faces: list[int] = []
    for ring in range(len(rings) - 1):
        for corner in range(_CORNERS):
            upper, lower = ring * _CORNERS, (ring + 1) * _CORNERS
            following = (corner + 1) % _CORNERS
            faces += [upper + corner, lower + corner, lower + following]
            faces += [upper + corner, lower + following, upper + following]
    last = (len(rings) - 1) * _CORNERS
    for corner in range(1, _CORNERS - 1):
        faces += [0, corner, corner + 1]
        faces += [last, last + corner + 1, last + corner]
    return corners, faces
