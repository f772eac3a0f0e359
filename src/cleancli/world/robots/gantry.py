"""The gantry: a drive with the joints x, y, z and yaw, and the rag below it."""

from __future__ import annotations

from itertools import product

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.motion.legs import Leg, legs, lengths
from cleancli.motion.pace import LIFT, TRANSIT_SPEED
from cleancli.motion.path import ToolPath, Unreachable, Waypoint
from cleancli.motion.timing import Course, SpeedLimits, timed
from cleancli.scene.model import Rag, Scene
from cleancli.world import constants as par
from cleancli.world import rag as cloths
from cleancli.world.multibody import NOTHING, Link, assemble
from cleancli.world.physics import Engine
from cleancli.world.robots import constants

_DRIVES = (0, 1, 2, 3)  # joint numbers of x, y, z, yaw
_LIMITS = SpeedLimits(constants.JOINT_SPEED, constants.JOINT_ACCELERATION)
_STILL = np.zeros(4)


class Gantry:
    """A drive (`Drive`) whose joints are the tool's pose: x, y, z, yaw of the rag's lower middle.

    Its shortest motion in joint space is straight in x, y, z, and turns yaw on the way: both interpolations
    of a `ToolPath` are the same to it.
    """

    def __init__(self, engine: Engine, scene: Scene, rng: np.random.Generator) -> None:
        self._engine, self._scene = engine, scene
        cloth = cloths.hang(engine, scene.rag, _DRIVES[-1], rng)
        self._body = assemble(engine, (*_carriages(engine, scene.rag), *cloth.links))
        for joint in _DRIVES:
            engine.changeDynamics(
                self._body, joint, localInertiaDiagonal=[constants.CARRIAGE_INERTIA] * 3, linearDamping=0
            )
        cloths.spring(engine, self._body, len(_DRIVES), cloth)
        self._target: Floats  # since it was placed

    def place(self) -> None:
        """Stand at rest at once; only before the clock starts."""
        self.stand(resting_pose(self._scene))

    def stand(self, pose: Floats) -> None:
        """Stand at `pose` (4,) at once."""
        for joint, value in zip(_DRIVES, pose, strict=True):
            self._engine.resetJointState(self._body, joint, value)
        self.command(pose)

    def follow(self, path: ToolPath, offset: Floats) -> Floats:
        """(k, 4) poses of a transit above the surface to the first waypoint, then of the path."""
        strokes = legs(path.waypoints, offset)
        first = np.array([(w.x, w.y, w.z, w.yaw) for w in path.waypoints[:1]])[0] + offset
        for point in (first, *(point for leg in strokes for point in leg.points[[0, -1]])):
            _refuse_far(point, self._scene)
        return _timed((*transit(self.tool(), first, path.waypoints[0].speed), *strokes))

    def withdraw(self) -> Floats:
        """(k, 4) poses of a transit to rest."""
        return _timed(transit(self.tool(), resting_pose(self._scene)))

    def lift(self) -> Floats:
        """(k, 4) poses straight up until the tool is clear of the surface."""
        here = self.tool()
        above = _waypoint((*here[:2], max(here[2], LIFT), here[3]), TRANSIT_SPEED)
        return _timed(legs((_waypoint(here, TRANSIT_SPEED), above), _STILL))

    def command(self, joints: Floats) -> None:
        """Be at `joints` (4,) after the next step, as far as the joints' forces allow."""
        self._target = joints
        self._engine.setJointMotorControlArray(
            self._body,
            _DRIVES,
            self._engine.POSITION_CONTROL,
            targetPositions=joints.tolist(),
            forces=constants.JOINT_FORCE,
            positionGains=(1.0, 1.0, 1.0, 1.0),
            velocityGains=(1.0, 1.0, 1.0, 1.0),
        )

    def commanded(self) -> Floats:
        """Where the joints were last commanded to be, (4,)."""
        return self._target

    def tool(self) -> Floats:
        """Where the joints are, (4,)."""
        return np.array([state[0] for state in self._engine.getJointStates(self._body, _DRIVES)])

    def stray(self) -> float:
        """How far the tool is from where it was commanded to be, metres."""
        return float(np.linalg.norm((self.tool() - self._target)[:3]))

    def flaps(self) -> Floats:
        """(n, 3) middles of the flaps, metres."""
        return cloths.flap_middles(self._engine, self._body, len(_DRIVES))

    def holds(self, points: Floats) -> Bools:
        """(n,) false: there is no dustpan."""
        return np.zeros(len(points), dtype=bool)


def transit(here: Floats, there: Floats, speed: float = TRANSIT_SPEED) -> tuple[Leg, ...]:
    """From `here` (4,) up, across above the surface, and down to `there` (4,)."""
    height = max(LIFT, here[2], there[2])
    corners = (
        _waypoint(here, TRANSIT_SPEED),
        _waypoint((*here[:2], height, here[3]), TRANSIT_SPEED),
        _waypoint((*there[:2], height, there[3]), speed),
        _waypoint(there, speed),
    )
    return legs(corners, _STILL)


def within_reach(points: Floats, scene: Scene) -> Bools:
    """(n,) whether the gantry can bring its tool to each of `points` (n, 4)."""
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 + constants.REACH_MARGIN
    low, high = constants.REACH_HEIGHT
    corner = np.array((*half, high))
    inside = (points[:, :3] <= corner) & (points[:, :3] >= np.array((*-half, low)))
    within: Bools = np.asarray(inside.all(axis=1))
    return within


def resting_pose(scene: Scene) -> Floats:
    """Pose (4,) beside the table, outside the camera's view, on the nearest side without the container."""
    setup = scene.camera
    tool = scene.rag.width / 2 + constants.REST_CLEARANCE
    views = setup.height / (2 * setup.focal) * np.array((setup.image_width, setup.image_height))
    x, y = np.maximum(views, (scene.surface.width / 2, scene.surface.depth / 2)) + tool
    places = {"north": (0.0, y), "south": (0.0, -y), "west": (-x, 0.0), "east": (x, 0.0)}
    del places[scene.container.edge]
    nearest = min(places.values(), key=lambda place: abs(place[0]) + abs(place[1]))
    return np.array((*nearest, LIFT, 0.0))


def gantry_extent(scene: Scene) -> Floats:
    """(n, 3) ends of the post above the corners of the surface, and where it rests."""
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    top = LIFT + par.FLAP_HEIGHT + par.HOLDER_SIZE[1] + par.POST_HEIGHT
    spots = [half * sign for sign in product((-1, 1), repeat=2)] + [resting_pose(scene)[:2]]
    return np.array([(x, y, z) for x, y in spots for z in (0.0, top)])


def _refuse_far(point: Floats, scene: Scene) -> None:
    if not within_reach(point[None], scene)[0]:
        raise Unreachable(point[0], point[1], "outside the gantry's frame")


def _timed(strokes: tuple[Leg, ...]) -> Floats:
    courses = [
        Course(leg.points, np.append(0, np.cumsum(lengths(leg.points))), leg.speeds) for leg in strokes
    ]
    return np.concatenate([np.empty((0, 4)), *(timed(course, _LIMITS, par.STEP) for course in courses)])


def _waypoint(pose: Floats | tuple[float, ...], speed: float) -> Waypoint:
    x, y, z, yaw = (float(value) for value in pose)
    return Waypoint(x, y, z, yaw, speed)


def _carriages(engine: Engine, rag: Rag) -> tuple[Link, ...]:
    """Carriages for x, y and z, and the turning holder."""
    slide, turn = engine.JOINT_PRISMATIC, engine.JOINT_REVOLUTE
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    looks = (NOTHING, NOTHING, NOTHING, cloths.holder(engine, rag, par.POST_HEIGHT))
    return tuple(
        Link(parent, joint, axis, mass, seen=seen)
        for parent, joint, axis, mass, seen in zip(
            (-1, 0, 1, 2), (slide, slide, slide, turn), axes, constants.CARRIAGE_MASS, looks, strict=True
        )
    )
