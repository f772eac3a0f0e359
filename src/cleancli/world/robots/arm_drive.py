"""A simulated arm that holds the rag: links and joints from its Denavit-Hartenberg table, driven by
position."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.motion.arm import TWISTS, Arm, Capsule, forward
from cleancli.motion.clearance import hull_ends
from cleancli.motion.joint_path import (
    ANY_LEAN,
    Lean,
    air_course,
    course,
    nearest_pose,
    rise,
    stroke,
    through_air,
)
from cleancli.motion.legs import Leg, legs
from cleancli.motion.pace import LIFT, TRANSIT_SPEED
from cleancli.motion.path import ToolPath, Waypoint
from cleancli.motion.timing import SpeedLimits, timed
from cleancli.scene.model import Rag
from cleancli.world import constants as par
from cleancli.world import rag as cloths
from cleancli.world.multibody import NOTHING, Link, assemble
from cleancli.world.physics import Engine
from cleancli.world.robots import constants

JOINTS = tuple(range(7))
TOOL = 7  # the link whose frame is the tool's
SEED = 1  # of the path planner: what it draws is no part of a run's randomness


@dataclass(frozen=True, slots=True)
class Build:
    """What the physics needs of an arm besides its kinematics: kg and N m of each joint, joints at rest,
    colour."""

    masses: tuple[float, ...]
    torques: tuple[float, ...]
    rest: tuple[float, ...]
    colour: tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Held:
    """What an arm holds: `links` to mount on its tool's link, how that link itself looks, half its width (m),
    and what is to be set once the body is assembled."""

    links: tuple[Link, ...]
    seen: int
    half_width: float
    tune: Callable[[int], None]


def rag_for(engine: Engine, arm: Arm, rag: Rag, rng: np.random.Generator) -> Held:
    """The rag in the hand of an arm."""
    cloth = cloths.hang(engine, rag, TOOL, rng)
    holder = cloths.holder(engine, rag, max(arm.tool - par.FLAP_HEIGHT - par.HOLDER_SIZE[1], 0.01))
    return Held(cloth.links, holder, rag.width / 2, lambda body: cloths.spring(engine, body, TOOL + 1, cloth))


class ArmDrive:
    """A drive (`Drive`) with seven joints and a tool in its hand. Its links touch nothing in the engine:
    that they keep clear is checked before they move (`motion/clearance.py`)."""

    def __init__(self, engine: Engine, arm: Arm, build: Build, held: Held) -> None:
        self._engine, self._arm, self._build, self._held = engine, arm, build, held
        self._body = body(engine, arm, build, held.seen, held.links)
        held.tune(self._body)
        self._limits = SpeedLimits(arm.speed, arm.acceleration)
        self._target: Floats  # since it was placed

    def place(self) -> None:
        """Stand at rest at once; only before the clock starts."""
        self.stand(np.array(self._build.rest))

    def stand(self, joints: Floats) -> None:
        """Stand at `joints` (7,) at once."""
        for joint, value in zip(JOINTS, joints, strict=True):
            self._engine.resetJointState(self._body, joint, value)
        self.command(joints)

    def follow(self, path: ToolPath, offset: Floats) -> Floats:
        """(k, 7) joints of a way through the air to the first waypoint, then of the path."""
        return np.concatenate(self.pieces(path, offset, self.joints()))

    def pieces(self, path: ToolPath, offset: Floats, here: Floats) -> tuple[Floats, ...]:
        """As `follow`, from the joints `here` (7,), apart: (k, 7) joints through the air and of each leg."""
        parts = legs(path.waypoints, offset)
        if not parts:
            first = path.waypoints[0]
            point = np.array((first.x, first.y, first.z, first.yaw)) + offset
            return (self.through_air(here, nearest_pose(self._arm, point), first.speed),)
        strokes = stroke(self._arm, parts, path.interpolation, here, SEED)
        transit = self.through_air(here, strokes[0][0], path.waypoints[0].speed)
        return transit, *map(self.timed, strokes, parts)

    def timed(self, joints: Floats, leg: Leg) -> Floats:
        """(k, 7) joints for each physics step along a leg, given those for its points."""
        return timed(course(self._arm, joints, leg.speeds), self._limits, par.STEP)

    def withdraw(self) -> Floats:
        """(k, 7) joints of a way through the air to rest."""
        return self.through_air(self.joints(), np.array(self._build.rest), TRANSIT_SPEED)

    def lift(self) -> Floats:
        """(k, 7) joints straight up until the tool is clear of the surface, or as far as the arm can."""
        x, y, z, yaw = (float(value) for value in self.tool())
        corners = Waypoint(x, y, z, yaw, TRANSIT_SPEED), Waypoint(x, y, max(z, LIFT), yaw, TRANSIT_SPEED)
        (leg,) = legs(corners, np.zeros(4)) or (None,)
        joints = np.empty((0, 7)) if leg is None else rise(self._arm, self.joints(), leg)
        if leg is None or len(joints) < 2:
            return np.empty((0, 7))
        return timed(course(self._arm, joints, leg.speeds[: len(joints)]), self._limits, par.STEP)

    def command(self, joints: Floats) -> None:
        """Be at `joints` (7,) after the next step, as far as the joints' torques allow."""
        self._target = joints
        self._engine.setJointMotorControlArray(
            self._body,
            JOINTS,
            self._engine.POSITION_CONTROL,
            targetPositions=joints.tolist(),
            forces=self._build.torques,
            positionGains=(1.0,) * len(JOINTS),
            velocityGains=(1.0,) * len(JOINTS),
        )

    def joints(self) -> Floats:
        """Where the joints are, (7,)."""
        return np.array([state[0] for state in self._engine.getJointStates(self._body, JOINTS)])

    def commanded(self) -> Floats:
        """Where the joints were last commanded to be, (7,)."""
        return self._target

    def tool(self) -> Floats:
        """Where the tool is: x, y, z and yaw, (4,)."""
        frame = forward(self._arm, self.joints()[None])[0]
        return np.array((*frame[:3, 3], np.arctan2(-frame[0, 1], frame[1, 1])))

    def stray(self) -> float:
        """How far the tool is from where it was commanded to be, metres."""
        here, there = forward(self._arm, np.stack((self.joints(), self._target)))[:, :3, 3]
        return float(np.linalg.norm(here - there))

    def flaps(self) -> Floats:
        """(n, 3) middles of the flaps, metres."""
        return cloths.flap_middles(self._engine, self._body, TOOL + 1)

    def holds(self, points: Floats) -> Bools:
        """(n,) false: there is no dustpan."""
        return np.zeros(len(points), dtype=bool)

    def through_air(self, here: Floats, there: Floats, speed: float, lean: Lean = ANY_LEAN) -> Floats:
        """(k, 7) joints of a way between two joint positions that keeps clear and leans as allowed."""
        corners = through_air(self._arm, here, there, self._held.half_width, SEED, lean)
        pieces = [air_course(self._arm, begin, end, speed) for begin, end in pairwise(corners)]
        return np.concatenate([timed(piece, self._limits, par.STEP) for piece in pieces])


def body(engine: Engine, arm: Arm, build: Build, held: int, more: tuple[Link, ...]) -> int:
    """A body of the arm's seven links, the tool's link that looks like `held`, and `more` links."""
    base, looks = _looks(engine, arm, build)
    links = [_first(engine, arm, build, looks[1])]
    for row in range(1, 7):
        links.append(
            Link(
                parent=row - 1,
                joint=engine.JOINT_REVOLUTE,
                axis=(0, 0, 1),
                mass=build.masses[row],
                position=(arm.offsets[row - 1], 0, arm.lengths[row - 1]),
                orientation=engine.getQuaternionFromEuler([TWISTS[row - 1], 0, 0]),
                seen=looks[row + 1],
            )
        )
    flange = (0.0, 0.0, arm.lengths[6] + arm.tool)
    upright = engine.getQuaternionFromEuler([np.pi, 0, 0])
    tool = Link(6, engine.JOINT_FIXED, (0, 0, 1), constants.HELD_MASS, flange, upright, seen=held)
    number = assemble(engine, (*links, tool, *more), seen=base)
    for link in (*JOINTS, TOOL):
        engine.changeDynamics(
            number, link, localInertiaDiagonal=[constants.LINK_INERTIA] * 3, linearDamping=0, angularDamping=0
        )
    return number


def arm_extent(arm: Arm, build: Build) -> Floats:
    """(n, 3) corners of boxes around the ends of the arm's hulls, at rest and as it would rather be."""
    ends = hull_ends(arm, np.array((build.rest, arm.posture)))
    radii = np.array([hull.radius for hull in arm.hulls])[:, None, None]
    corners = [ends + radii * np.array(signs) for signs in product((-1, 1), repeat=3)]
    return np.stack(corners).reshape(-1, 3)


def _first(engine: Engine, arm: Arm, build: Build, seen: int) -> Link:
    base = np.array(arm.base)
    return Link(
        parent=-1,
        joint=engine.JOINT_REVOLUTE,
        axis=(0, 0, 1),
        mass=build.masses[0],
        position=tuple(base[:3, 3]),
        orientation=_quaternion(base[:3, :3]),
        seen=seen,
    )


def _looks(engine: Engine, arm: Arm, build: Build) -> tuple[int, dict[int, int]]:
    """Shapes of the base and of each link that has a hull, by row."""
    colour = [*(c / 255 for c in build.colour), 1]
    shapes = dict.fromkeys(range(8), NOTHING)
    for hull in arm.hulls:
        begin, end = (_in_link(arm, hull, point) for point in (hull.begin, hull.end))
        along = end - begin
        length = float(np.linalg.norm(along))
        shapes[hull.frame] = engine.createVisualShape(
            engine.GEOM_CAPSULE,
            radius=hull.radius,
            length=length,
            rgbaColor=colour,
            visualFramePosition=((begin + end) / 2).tolist(),
            visualFrameOrientation=_along(along / length),
        )
    return shapes[0], shapes


def _in_link(arm: Arm, hull: Capsule, point: tuple[float, float, float]) -> Floats:
    """A hull's point in the frame of its link, which turns with the joint before its row; the base's in the
    world."""
    if hull.frame == 0:
        base = np.array(arm.base)
        moved: Floats = base[:3, :3] @ point + base[:3, 3]
        return moved
    row = hull.frame - 1
    cos, sin = np.cos(TWISTS[row]), np.sin(TWISTS[row])
    x, y, z = point
    return np.array((x + arm.offsets[row], cos * y - sin * z, sin * y + cos * z + arm.lengths[row]))


def _along(direction: Floats) -> tuple[float, float, float, float]:
    """The quaternion that turns z to a direction."""
    x, y, z = (float(value) for value in direction)
    if z < -1 + 1e-9:
        return 1.0, 0.0, 0.0, 0.0
    size = float(np.sqrt(2 * (1 + z)))
    return -y / size, x / size, 0.0, size / 2


def _quaternion(turn: Floats) -> tuple[float, float, float, float]:
    """The quaternion (x, y, z, w) of a rotation (3, 3), by its own axis."""
    w = np.sqrt(max(0.0, 1 + np.trace(turn))) / 2
    if w > 1e-6:
        axis = np.array((turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1])) / (4 * w)
        return float(axis[0]), float(axis[1]), float(axis[2]), float(w)
    column = int(np.argmax(np.diag(turn)))
    half = (turn[:, column] + np.eye(3)[column]) / 2  # half a turn about an axis: axis times its component
    axis = half / np.linalg.norm(half)
    return float(axis[0]), float(axis[1]), float(axis[2]), 0.0
