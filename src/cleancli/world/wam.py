"""The Barrett WAM of §6: where it stands beside a table, and what it is made of."""

from __future__ import annotations

import numpy as np

from cleancli.motion.arm import Arm, Capsule
from cleancli.scene.model import Scene
from cleancli.world import robots
from cleancli.world.arm_drive import Build

BUILD = Build(robots.WAM_MASSES, robots.WAM_TORQUE, robots.WAM_REST, robots.WAM_COLOUR)


def arm_for(scene: Scene) -> Arm:
    """The arm beside the surface, on the left of who looks over the container's edge, facing the middle."""
    out = np.array(scene.outwards())
    left = np.array((-out[1], out[0]))
    half = abs(left @ (scene.surface.width, scene.surface.depth)) / 2
    beside = max(robots.WAM_BESIDE, half + robots.WAM_GAP)
    base = np.eye(4)
    base[:2, 0], base[:2, 1] = -left, out
    base[:2, 3] = beside * left - robots.WAM_BACK * out
    base[2, 3] = robots.WAM_ABOVE
    return Arm(
        offsets=robots.WAM_OFFSETS,
        lengths=robots.WAM_LENGTHS,
        low=robots.WAM_LOW,
        high=robots.WAM_HIGH,
        speed=robots.WAM_SPEED,
        acceleration=robots.WAM_ACCELERATION,
        posture=robots.WAM_POSTURE,
        base=tuple(tuple(row) for row in base.tolist()),
        tool=robots.WAM_TOOL,
        hulls=tuple(Capsule(*hull) for hull in robots.WAM_HULLS),
        apart=robots.WAM_APART,
    )
