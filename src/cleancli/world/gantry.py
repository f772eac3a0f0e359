"""The gantry: a drive with the joints x, y, z and yaw, and the rag below it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cleancli.scene.model import Rag
from cleancli.world import rag as cloths
from cleancli.world import robots
from cleancli.world.links import NOTHING, Link, assemble
from cleancli.world.physics import Engine

_DRIVES = (0, 1, 2, 3)  # joint numbers of x, y, z, yaw


class Gantry:
    """The driven tool. Its pose is (x, y, z, yaw) of the rag's lower middle, as in a `Waypoint`."""

    def __init__(self, engine: Engine, rag: Rag, rng: np.random.Generator) -> None:
        self._engine = engine
        cloth = cloths.hang(engine, rag, _DRIVES[-1], rng)
        self._body = assemble(engine, (*_carriages(engine, rag), *cloth.links))
        for joint in _DRIVES:
            engine.changeDynamics(
                self._body, joint, localInertiaDiagonal=[robots.CARRIAGE_INERTIA] * 3, linearDamping=0
            )
        cloths.spring(engine, self._body, len(_DRIVES), cloth)

    def place(self, pose: NDArray[np.float64]) -> None:
        """Stand at `pose` (4,) at once; only before the clock starts."""
        for joint, value in zip(_DRIVES, pose, strict=True):
            self._engine.resetJointState(self._body, joint, value)
        self.command(pose)

    def command(self, pose: NDArray[np.float64]) -> None:
        """Be at `pose` (4,) after the next step, as far as the joints' forces allow."""
        self._engine.setJointMotorControlArray(
            self._body,
            _DRIVES,
            self._engine.POSITION_CONTROL,
            targetPositions=pose.tolist(),
            forces=robots.JOINT_FORCE,
            positionGains=(1.0, 1.0, 1.0, 1.0),
            velocityGains=(1.0, 1.0, 1.0, 1.0),
        )

    def pose(self) -> NDArray[np.float64]:
        """Where the joints are, (4,)."""
        return np.array([state[0] for state in self._engine.getJointStates(self._body, _DRIVES)])

    def flaps(self) -> NDArray[np.float64]:
        """(n, 3) middles of the flaps, metres."""
        return cloths.flap_middles(self._engine, self._body, len(_DRIVES))


def _carriages(engine: Engine, rag: Rag) -> tuple[Link, ...]:
    """Carriages for x, y and z, and the turning holder."""
    slide, turn = engine.JOINT_PRISMATIC, engine.JOINT_REVOLUTE
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    looks = (NOTHING, NOTHING, NOTHING, cloths.holder(engine, rag))
    return tuple(
        Link(parent, joint, axis, mass, seen=seen)
        for parent, joint, axis, mass, seen in zip(
            (-1, 0, 1, 2), (slide, slide, slide, turn), axes, robots.CARRIAGE_MASS, looks, strict=True
        )
    )
