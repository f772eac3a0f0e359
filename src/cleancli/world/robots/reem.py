"""REEM (§6): two arms on a torso behind the container, the rag in its right hand, a dustpan in its left."""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.motion.arm import Arm, Capsule, forward
from cleancli.motion.clearance import SELF_GAP, hull_ends, segment_gaps
from cleancli.motion.pace import TRANSIT_SPEED
from cleancli.motion.path import ToolPath, Unreachable
from cleancli.scene.model import Scene
from cleancli.world import constants as par
from cleancli.world.physics import Engine
from cleancli.world.robots import constants
from cleancli.world.robots.arm_drive import ArmDrive, Build, rag_for
from cleancli.world.robots.dustpan import PanDrive, dustpan_for, outline

ARMS_TOUCH = "the arms would touch each other"
PAN_TOUCHED = "the right arm would touch the dustpan"


class Reem:
    """A drive (`Drive`) with fourteen joints: seven of the right arm, then seven of the left."""

    def __init__(self, engine: Engine, scene: Scene, rng: np.random.Generator) -> None:
        right, left = arm_for(scene, 1), arm_for(scene, -1)
        self._arms = right, left
        self._right = ArmDrive(engine, right, build_for(1), rag_for(engine, right, scene.rag, rng))
        self._left = PanDrive(engine, left, build_for(-1), dustpan_for(engine))

    def place(self) -> None:
        """Stand at rest at once; only before the clock starts."""
        self._right.place()
        self._left.place()

    def follow(self, path: ToolPath, offset: Floats) -> Floats:
        """(k, 14) joints along the rag's path and back to rest in between where the dustpan takes part."""
        right, left = self._right.joints(), self._left.joints()
        if path.dustpan is None:
            return self._checked(_one(np.concatenate(self._right.pieces(path, offset, right)), left))
        lower, turning, lifting = self._left.put_down(path.dustpan, left)
        *push, leaving = self._right.pieces(path, offset, right)
        pushed, held = np.concatenate(push), turning[-1]
        back = self._right.through_air(leaving[-1], np.array(build_for(1).rest), TRANSIT_SPEED)
        away = np.concatenate((lifting, self._left.emptied(path.dustpan, lifting[-1])))
        return self._checked(
            np.concatenate(
                (
                    _other(lower, right),
                    _one(pushed, lower[-1]),
                    _both(leaving, turning),
                    _one(back, held),
                    _other(away, back[-1]),
                )
            )
        )

    def withdraw(self) -> Floats:
        """(k, 14) joints of a way to rest, the right arm first."""
        right = self._right.withdraw()
        here = self._left.joints()
        left = self._left.withdraw()
        rest = right[-1] if len(right) else self._right.joints()
        return self._checked(np.concatenate((_one(right, here), _other(left, rest))))

    def lift(self) -> Floats:
        """(k, 14) joints straight up, the rag and then the dustpan."""
        here = self._left.joints()
        right = self._right.lift()
        above = right[-1] if len(right) else self._right.joints()
        return np.concatenate((_one(right, here), _other(self._left.lift(), above)))

    def command(self, joints: Floats) -> None:
        """Be at `joints` (14,) after the next step, as far as the joints' torques allow."""
        self._right.command(joints[:7])
        self._left.command(joints[7:])

    def commanded(self) -> Floats:
        """Where the joints were last commanded to be, (14,)."""
        return np.concatenate((self._right.commanded(), self._left.commanded()))

    def tool(self) -> Floats:
        """Where the rag is: x, y, z and yaw, (4,)."""
        return self._right.tool()

    def stray(self) -> float:
        """How far the tool that strayed farther is from where it was commanded to be, metres."""
        return max(self._right.stray(), self._left.stray())

    def flaps(self) -> Floats:
        """(n, 3) middles of the rag's flaps, metres."""
        return self._right.flaps()

    def holds(self, points: Floats) -> Bools:
        """(n,) which of `points` (n, 3) lie in the dustpan."""
        return self._left.holds(points)

    def _checked(self, joints: Floats) -> Floats:
        """The same joints, if the arms keep clear of each other, and the right one of the dustpan; looked at
        every twentieth of a second."""
        some = joints[:: max(1, round(0.05 / par.STEP))]
        right, left = (hull_ends(arm, part) for arm, part in zip(self._arms, np.hsplit(some, 2), strict=True))
        pan = outline(forward(self._arms[1], some[:, 7:]))
        for i, first in enumerate(self._arms[0].hulls):
            for k, second in enumerate(self._arms[1].hulls):
                _refuse_near(right[:, i], left[:, k], first.radius + second.radius + SELF_GAP, ARMS_TOUCH)
            for k in range(pan.shape[1]):
                _refuse_near(right[:, i], pan[:, k], first.radius + SELF_GAP, PAN_TOUCHED)
        return joints


def arm_for(scene: Scene, side: int) -> Arm:
    """The right (1) or left (-1) arm, seen by who stands behind the container and looks at the surface."""
    out = np.array(scene.outwards())
    right = np.array((-out[1], out[0]))
    half = abs(out @ (scene.surface.width, scene.surface.depth)) / 2
    base = np.eye(4)
    base[:2, 0], base[:2, 1] = -out, -right
    base[:2, 3] = half * out + side * constants.REEM_SHOULDERS * right
    base[:2, 3] += scene.container.offset * np.abs(right)
    base[2, 3] = constants.REEM_ABOVE
    return Arm(
        offsets=constants.REEM_OFFSETS,
        lengths=constants.REEM_LENGTHS,
        low=constants.REEM_LOW,
        high=constants.REEM_HIGH,
        speed=constants.REEM_SPEED,
        acceleration=constants.REEM_ACCELERATION,
        posture=constants.REEM_POSTURE,
        base=tuple(tuple(row) for row in base.tolist()),
        tool=constants.REEM_TOOL,
        hulls=tuple(Capsule(*hull) for hull in constants.REEM_HULLS),
        apart=constants.REEM_APART,
    )


def build_for(side: int) -> Build:
    """What an arm is made of; the left one rests as the right one's mirror image."""
    rest = constants.REEM_REST if side > 0 else constants.REEM_LEFT_REST
    return Build(constants.REEM_MASSES, constants.REEM_TORQUE, rest, constants.REEM_COLOUR)


def _refuse_near(first: Floats, second: Floats, least: float, reason: str) -> None:
    """Raise Unreachable if lines with the ends `first` and `second` (n, 2, 3) ever come nearer than `least`,
    metres."""
    gaps = segment_gaps(first, second)
    if len(gaps) and gaps.min() < least:
        x, y, _ = first[gaps.argmin(), 1]
        raise Unreachable(float(x), float(y), reason)


def _one(right: Floats, left: Floats) -> Floats:
    return np.column_stack((right, np.tile(left, (len(right), 1))))


def _other(left: Floats, right: Floats) -> Floats:
    return np.column_stack((np.tile(right, (len(left), 1)), left))


def _both(right: Floats, left: Floats) -> Floats:
    """Both at once; who is done first waits."""
    count = max(len(right), len(left))
    waiting = [np.concatenate((way, np.repeat(way[-1:], count - len(way), axis=0))) for way in (right, left)]
    return np.column_stack(waiting)
