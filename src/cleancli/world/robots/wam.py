"""The Barrett WAM of §6: where it stands beside a table, and what it is made of."""

from __future__ import annotations

import numpy as np

from cleancli.motion.arm import Arm, Capsule
from cleancli.scene.model import Scene
from cleancli.world.robots import constants
from cleancli.world.robots.arm_drive import Build

BUILD = Build(constants.WAM_MASSES, constants.WAM_TORQUE, constants.WAM_REST, constants.WAM_COLOUR)


def arm_for(scene: Scene) -> Arm:
    """The arm beside the surface, on the left of who looks over the container's edge, facing the middle."""
    out = np.array(scene.outwards())
    left = np.array((-out[1], out[0]))
    half = abs(left @ (scene.surface.width, scene.surface.depth)) / 2
    beside = max(constants.WAM_BESIDE, half + constants.WAM_GAP)
    base = np.eye(4)
    base[:2, 0], base[:2, 1] = -left, out
    base[:2, 3] = beside * left - constants.WAM_BACK * out
    base[2, 3] = constants.WAM_ABOVE
    return Arm(
        offsets=constants.WAM_OFFSETS,
        lengths=constants.WAM_LENGTHS,
        low=constants.WAM_LOW,
        high=constants.WAM_HIGH,
        speed=constants.WAM_SPEED,
        acceleration=constants.WAM_ACCELERATION,
        posture=constants.WAM_POSTURE,
        base=tuple(tuple(row) for row in base.tolist()),
        tool=constants.WAM_TOOL,
        hulls=tuple(Capsule(*hull) for hull in constants.WAM_HULLS),
        apart=constants.WAM_APART,
    )
