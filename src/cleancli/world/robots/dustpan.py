"""The dustpan: a sloping plate with a thin lip and three walls, held at its far end; its frame's x points
from the lip to there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.motion.arm import everywhere, forward, poses
from cleancli.motion.clearance import clear
from cleancli.motion.joint_path import Lean
from cleancli.motion.legs import legs
from cleancli.motion.pace import TRANSIT_SPEED
from cleancli.motion.path import Dustpan, Unreachable
from cleancli.motion.pick_up import CARRY_HEIGHT, PAN_LENGTH, PAN_SLOPE
from cleancli.motion.timing import Course, timed
from cleancli.world import constants as par
from cleancli.world.multibody import Link
from cleancli.world.physics import Engine
from cleancli.world.robots import constants
from cleancli.world.robots.arm_drive import TOOL, ArmDrive, Held

_Triple = tuple[float, float, float]

_TRIED = 3  # of several ways, nearest first
_TURNING = 30  # poses of a turn
_JUMP = 0.3  # rad a joint may turn from one pose to the next
_BACK = PAN_SLOPE * PAN_LENGTH  # how much higher the slope is where it is held


class PanDrive(ArmDrive):
    """An arm that puts a dustpan down, carries it level, and tips it."""

    def put_down(self, pan: Dustpan, here: Floats) -> tuple[Floats, Floats, Floats]:
        """(k, 7) joints from `here` (7,) to where the dustpan stands on the surface; of raising its lip
        there; of lifting it."""
        low, high = replace(pan.place, z=constants.PAN_GAP), replace(pan.place, z=CARRY_HEIGHT)
        (leg,) = legs((low, high), np.zeros(4))
        still = np.tile(leg.points[:1], (_TURNING, 1))
        tilts = np.linspace(0, constants.PAN_HELD, _TURNING)
        more = np.linspace(constants.PAN_HELD, constants.PAN_LEAN, len(leg.points))
        frames = poses(np.concatenate((still, leg.points)), np.concatenate((tilts, more)))
        for down in self._steadily(frames[::-1], here):
            lip, up = np.split(down[::-1], (_TURNING,))
            try:
                there = self.through_air(here, down[0], TRANSIT_SPEED)
            except Unreachable:
                continue
            turning, lifting = self._turned(lip, constants.PAN_HELD, low.speed), self.timed(up, leg)
            down_again = self.timed(up[::-1], leg), self._turned(lip[::-1], constants.PAN_HELD, low.speed)
            return np.concatenate((there, *down_again)), turning, lifting
        raise Unreachable(low.x, low.y, "the dustpan can't be put down there and lifted again")

    def emptied(self, pan: Dustpan, here: Floats) -> Floats:
        """(k, 7) joints from where the dustpan was lifted to, `here` (7,), to over the container, level all
        the way; tipped there; and to rest."""
        goal, tilts = pan.empty, np.linspace(constants.PAN_LEAN, pan.tip, _TURNING)
        frames = poses(np.tile((goal.x, goal.y, goal.z, goal.yaw), (len(tilts), 1)), tilts)
        for tipped in self._steadily(frames, here):
            try:
                carried = self.through_air(here, tipped[0], TRANSIT_SPEED, Lean(*constants.PAN_LEANS))
            except Unreachable:
                continue
            over = self._turned(tipped, pan.tip, TRANSIT_SPEED)
            still = np.repeat(over[-1:], round(constants.PAN_HOLD / par.STEP), axis=0)
            rest = self.through_air(tipped[0], np.array(self._build.rest), TRANSIT_SPEED)
            return np.concatenate((carried, over, still, over[::-1], rest))
        raise Unreachable(pan.empty.x, pan.empty.y, "the dustpan can't be carried there level and tipped")

    def holds(self, points: Floats) -> Bools:
        """(n,) which of `points` (n, 3) lie in the dustpan."""
        return within(forward(self._arm, self.joints()[None])[0], points)

    def _turned(self, joints: Floats, angle: float, speed: float) -> Floats:
        """(k, 7) joints of a turn about the held end through `joints` (n, 7), the lip at that speed, m/s."""
        ways = np.linspace(0, PAN_LENGTH * abs(angle), len(joints))
        return timed(Course(joints, ways, np.full(len(joints), speed)), self._limits, par.STEP)

    def _steadily(self, frames: Floats, here: Floats) -> Iterator[Floats]:
        """Joints (n, 7) for `frames` (n, 4, 4) with one swivel of the elbow, those first that begin near the
        joints `here` (7,)."""
        found = everywhere(self._arm, frames)
        found = found.transpose(1, 2, 0, 3).reshape(-1, len(frames), 7)
        found = found[np.isfinite(found).all(axis=(1, 2))]
        found = found[[bool(clear(self._arm, joints).all()) for joints in found]]
        found = found[np.abs(np.diff(found, axis=1)).max(axis=(1, 2), initial=0) < _JUMP]
        yield from found[np.argsort(np.abs(found[:, 0] - here).max(axis=1), kind="stable")][:_TRIED]


def plate() -> Floats:
    """(10, 3) corners of the hull whose upper side is the slope, without the margin that the engine adds all
    around; metres in the dustpan's frame. Its underside is flat behind the lip, then it slopes as well."""
    margin, level = par.PARTICLE_MARGIN, float(np.hypot(1, PAN_SLOPE))  # a plane's height, its thickness 1
    front, back = margin - PAN_LENGTH, -margin
    top = constants.PAN_LIP - margin * level + PAN_SLOPE * (np.array((front, back)) + PAN_LENGTH)
    under = top - (constants.PAN_WALL - 2 * margin) * level
    bend = front + (margin - under[0]) / PAN_SLOPE
    side = [(front, margin), (front, top[0]), (back, top[1]), (back, under[1]), (bend, margin)]
    half = constants.PAN_WIDTH / 2 - margin
    return np.array([(x, y, z) for y in (-half, half) for x, z in side])


def walls() -> tuple[tuple[_Triple, _Triple], ...]:
    """Half the size, and the middle, of the three walls; metres in the dustpan's frame. The rear one, which
    is behind the edge about which the lip is raised, ends above it."""
    half, wall, high = constants.PAN_WIDTH / 2, constants.PAN_WALL, constants.PAN_WALL_HEIGHT
    side = (PAN_LENGTH / 2, wall / 2, high / 2)
    rear = (wall / 2, half + wall, (_BACK + high - wall) / 2)
    return (
        (side, (-PAN_LENGTH / 2, half + wall / 2, high / 2)),
        (side, (-PAN_LENGTH / 2, -half - wall / 2, high / 2)),
        (rear, (wall / 2, 0.0, (_BACK + high + wall) / 2)),
    )


def dustpan_for(engine: Engine) -> Held:
    """The dustpan in the hand of an arm."""
    colour = [*(c / 255 for c in constants.PAN_COLOUR), 1]
    middle = plate().mean(axis=0)
    parts = [(tuple(middle.tolist()), *_hull(engine, plate() - middle, colour))]
    for half, place in walls():
        box = engine.createCollisionShape(engine.GEOM_BOX, halfExtents=half)
        look = engine.createVisualShape(engine.GEOM_BOX, halfExtents=half, rgbaColor=colour)
        parts.append((place, box, look))
    links = tuple(
        Link(TOOL, engine.JOINT_FIXED, (0, 0, 1), constants.PAN_MASS, place, touched=box, seen=look)
        for place, box, look in parts
    )

    def tune(body: int) -> None:
        for link in range(TOOL + 1, TOOL + 1 + len(links)):
            engine.changeDynamics(
                body, link, lateralFriction=constants.PAN_FRICTION, rollingFriction=0, spinningFriction=0
            )
            for other in range(body):  # the furniture: where the dustpan goes is planned, not felt
                engine.setCollisionFilterPair(body, other, link, -1, 0)

    return Held(links, -1, constants.PAN_WIDTH / 2, tune)


def _hull(engine: Engine, corners: Floats, colour: list[float]) -> tuple[int, int]:
    """Shapes of a prism, to touch and to see.

    A hull has a margin of 1 mm around it, unless told otherwise. The engine can tell a body's base only, but
    what it sets holds for all that have the shape: so a body is told that goes again.
    """
    touched: int = engine.createCollisionShape(engine.GEOM_MESH, vertices=corners.tolist())
    spare = engine.createMultiBody(baseMass=0, baseCollisionShapeIndex=touched)
    engine.changeDynamics(spare, -1, collisionMargin=par.PARTICLE_MARGIN)
    engine.removeBody(spare)
    faces = corners[_faces(len(corners) // 2)]  # each has corners of its own, or edges would look round
    normals = np.cross(faces[1::3] - faces[::3], faces[2::3] - faces[::3])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    seen: int = engine.createVisualShape(
        engine.GEOM_MESH,
        vertices=faces.tolist(),
        indices=list(range(len(faces))),
        normals=np.repeat(normals, 3, axis=0).tolist(),
        rgbaColor=colour,
    )
    return touched, seen


def _faces(count: int) -> list[int]:
    """Corners of a prism's triangles, by number, counter-clockwise from outside: `count` of its end at low y,
    clockwise from outside, then those of the other."""
    faces: list[int] = []
    for k in range(1, count - 1):
        faces += [0, k + 1, k, count, count + k, count + k + 1]
    for k in range(count):
        following = (k + 1) % count
        faces += [k, following, count + k, following, count + following, count + k]
    return faces


def outline(frames: Floats) -> Floats:
    """(n, 4, 2, 3) both ends of the upper edges of the three walls, and of the plate's middle line, of
    dustpans with `frames` (n, 4, 4), metres."""
    y, side = constants.PAN_WIDTH / 2 + constants.PAN_WALL, constants.PAN_WALL_HEIGHT
    ends = np.array(
        [
            [(-PAN_LENGTH, -y, side), (0, -y, side)],
            [(-PAN_LENGTH, y, side), (0, y, side)],
            [(0, -y, _BACK + side), (0, y, _BACK + side)],
            [(-PAN_LENGTH, 0, constants.PAN_LIP), (0, 0, _BACK)],
        ]
    )
    turned: Floats = np.einsum("nij,skj->nski", frames[:, :3, :3], ends)
    return turned + frames[:, None, None, :3, 3]


def within(frame: Floats, points: Floats) -> Bools:
    """(n,) whether each of `points` (n, 3) lies in a dustpan whose frame is `frame` (4, 4)."""
    local = (points - frame[:3, 3]) @ frame[:3, :3]
    half = constants.PAN_WIDTH / 2
    low, high = np.array((-PAN_LENGTH, -half, 0)), np.array((0, half, _BACK + constants.PAN_WALL_HEIGHT))
    inside: Bools = np.asarray(((local >= low) & (local <= high)).all(axis=1))
    return inside
