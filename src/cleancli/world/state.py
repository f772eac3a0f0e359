"""What a simulated table is like at one moment, as numbers that a file can hold.

The engine keeps more than it tells: contacts of the step before, the order of its pairs, what sleeps. Its own
saved states don't hold all of that either: measured, a table restored from one goes on differently after a
few steps, even in the same process. So a table whose state is saved is built anew from it, and goes on as any
other that is built from the same numbers.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Floats, Singles
from cleancli.world.physics import Engine

FARTHEST = 1e3
"""Metres, metres a second, radians: nothing leaves the room, and whatever falls lies on its floor."""

MOST_STEPS = 10**11

Generators = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class TableState:
    """All that the future of a table hangs on, besides its scene and its seed.

    `particles` (n, 13): place, turn as a quaternion, speed and spin. `joints` (m, 2): position and speed of
    each joint that moves, body by body. `commanded` (d,): where the drive is told to be; `ahead` (k, d): what
    is left of a motion. `ink` (rows, columns) and `flaps` (f, 3), where the flaps last touched it, are empty
    without ink. `steps` of physics since the dirt came to rest. `generators` of random numbers, by use.
    """

    particles: Floats
    joints: Floats
    commanded: Floats
    ahead: Floats
    ink: Singles
    flaps: Floats
    steps: int
    status: str
    failure: str
    generators: Generators

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The same as arrays by name, for `numpy.savez`."""
        rest = {
            "steps": self.steps,
            "status": self.status,
            "failure": self.failure,
            "generators": self.generators,
        }
        return {
            "particles": self.particles,
            "joints": self.joints,
            "commanded": self.commanded,
            "ahead": self.ahead,
            "ink": self.ink,
            "flaps": self.flaps,
            "rest": np.array(json.dumps(rest)),
        }


def from_arrays(arrays: Mapping[str, NDArray[Any]]) -> TableState:
    """The state whose `arrays` these are; KeyError, ValueError or TypeError where they are no state's."""
    fields: dict[str, Any] = {name: array for name, array in arrays.items() if name != "rest"}
    state = TableState(**fields, **json.loads(str(arrays["rest"])))
    for name, columns in (("particles", 13), ("joints", 2), ("flaps", 3)):
        _refuse_shape(name, fields[name], columns)
    for name in ("particles", "joints", "flaps", "commanded", "ahead", "ink"):
        _refuse_numbers(name, fields[name])
    _refuse_rest(state)
    return state


def _refuse_shape(name: str, array: NDArray[Any], columns: int) -> None:
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"`{name}` must have {columns} columns")


def _refuse_numbers(name: str, array: NDArray[Any]) -> None:
    if array.dtype.kind != "f" or not (np.abs(array) <= FARTHEST).all():
        raise ValueError(f"`{name}` has numbers that no table has")


def _refuse_rest(state: TableState) -> None:
    if type(state.steps) is not int or not 0 <= state.steps <= MOST_STEPS:
        raise ValueError("`steps` must be a whole number")
    if not isinstance(state.status, str) or not isinstance(state.failure, str):
        raise TypeError("`status` and `failure` must be texts")


def bodies(engine: Engine, particles: tuple[int, ...]) -> tuple[Floats, Floats]:
    """`particles` and `joints` of a state."""
    rows = [
        np.concatenate((*engine.getBasePositionAndOrientation(body), *engine.getBaseVelocity(body)))
        for body in particles
    ]
    joints = [engine.getJointState(body, joint)[:2] for body, joint in _moving(engine)]
    return np.array(rows).reshape(-1, 13), np.array(joints).reshape(-1, 2)


def put(engine: Engine, particles: tuple[int, ...], state: TableState) -> None:
    """Bring particles and joints to where they are in a state. Raises ValueError for one of another table."""
    moving = len(list(_moving(engine)))
    if state.particles.shape != (len(particles), 13) or state.joints.shape != (moving, 2):
        raise ValueError("the saved state is of another table")
    place(engine, particles, state.particles, state.joints)


def place(engine: Engine, particles: tuple[int, ...], places: Floats, joints: Floats) -> None:
    """Bring particles (n, 13) and joints (k, 2) to where `bodies` has found them."""
    for body, row in zip(particles, places.tolist(), strict=True):
        engine.resetBasePositionAndOrientation(body, row[:3], row[3:7])
        engine.resetBaseVelocity(body, row[7:10], row[10:])
    for (body, joint), (position, speed) in zip(_moving(engine), joints.tolist(), strict=True):
        engine.resetJointState(body, joint, position, speed)


def _moving(engine: Engine) -> Iterator[tuple[int, int]]:
    """Body and number of each joint that is not fixed."""
    for body in range(engine.getNumBodies()):
        for joint in range(engine.getNumJoints(body)):
            if engine.getJointInfo(body, joint)[2] != engine.JOINT_FIXED:
                yield body, joint
