"""The dustpan: a flat wedge with three walls, held at its far end; its frame's x points from the lip to
there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cleancli.motion.arm import everywhere, forward, poses
from cleancli.motion.clearance import clear
from cleancli.motion.joint_path import Lean
from cleancli.motion.legs import legs
from cleancli.motion.pace import TRANSIT_SPEED
from cleancli.motion.path import Dustpan, Unreachable
from cleancli.motion.pick_up import CARRY_HEIGHT, PAN_LENGTH, PAN_SLOPE
from cleancli.motion.timing import Course, timed
from cleancli.world import parameters as par
from cleancli.world import robots
from cleancli.world.arm_drive import TOOL, ArmDrive, Held
from cleancli.world.links import UPRIGHT, Link
from cleancli.world.physics import Engine

_Array = NDArray[np.float64]

_TRIED = 3  # of several ways, nearest first
_TURNING = 30  # poses of a turn
_JUMP = 0.3  # rad a joint may turn from one pose to the next
_BACK = PAN_SLOPE * PAN_LENGTH  # height of the wedge where it is held


class PanDrive(ArmDrive):
    """An arm that puts a dustpan down, carries it level, and tips it."""

    def put_down(self, pan: Dustpan, here: _Array) -> tuple[_Array, _Array, _Array]:
        """(k, 7) joints from `here` (7,) to where the dustpan stands on the surface; of raising its lip
        there; of lifting it."""
        low, high = replace(pan.place, z=robots.PAN_GAP), replace(pan.place, z=CARRY_HEIGHT)
        (leg,) = legs((low, high), np.zeros(4))
        still = np.tile(leg.points[:1], (_TURNING, 1))
        tilts = np.linspace(0, robots.PAN_HELD, _TURNING)
        more = np.linspace(robots.PAN_HELD, robots.PAN_LEAN, len(leg.points))
        frames = poses(np.concatenate((still, leg.points)), np.concatenate((tilts, more)))
        for down in self._steadily(frames[::-1], here):
            lip, up = np.split(down[::-1], (_TURNING,))
            try:
                there = self.through_air(here, down[0], TRANSIT_SPEED)
            except Unreachable:
                continue
            turning, lifting = self._turned(lip, robots.PAN_HELD, low.speed), self.timed(up, leg)
            down_again = self.timed(up[::-1], leg), self._turned(lip[::-1], robots.PAN_HELD, low.speed)
            return np.concatenate((there, *down_again)), turning, lifting
        raise Unreachable(low.x, low.y, "the dustpan can't be put down there and lifted again")

    def emptied(self, pan: Dustpan, here: _Array) -> _Array:
        """(k, 7) joints from where the dustpan was lifted to, `here` (7,), to over the container, level all
        the way; tipped there; and to rest."""
        goal, tilts = pan.empty, np.linspace(robots.PAN_LEAN, pan.tip, _TURNING)
        frames = poses(np.tile((goal.x, goal.y, goal.z, goal.yaw), (len(tilts), 1)), tilts)
        for tipped in self._steadily(frames, here):
            try:
                carried = self.through_air(here, tipped[0], TRANSIT_SPEED, Lean(*robots.PAN_LEANS))
            except Unreachable:
                continue
            over = self._turned(tipped, pan.tip, TRANSIT_SPEED)
            still = np.repeat(over[-1:], round(robots.PAN_HOLD / par.STEP), axis=0)
            rest = self.through_air(tipped[0], np.array(self._build.rest), TRANSIT_SPEED)
            return np.concatenate((carried, over, still, over[::-1], rest))
        raise Unreachable(pan.empty.x, pan.empty.y, "the dustpan can't be carried there level and tipped")

    def holds(self, points: _Array) -> NDArray[np.bool_]:
        """(n,) which of `points` (n, 3) lie in the dustpan."""
        return within(forward(self._arm, self.joints()[None])[0], points)

    def _turned(self, joints: _Array, angle: float, speed: float) -> _Array:
        """(k, 7) joints of a turn about the held end through `joints` (n, 7), the lip at that speed, m/s."""
        ways = np.linspace(0, PAN_LENGTH * abs(angle), len(joints))
        return timed(Course(joints, ways, np.full(len(joints), speed)), self._limits, par.STEP)

    def _steadily(self, frames: _Array, here: _Array) -> Iterator[_Array]:
        """Joints (n, 7) for `frames` (n, 4, 4) with one swivel of the elbow, those first that begin near the
        joints `here` (7,)."""
        found = everywhere(self._arm, frames)
        found = found.transpose(1, 2, 0, 3).reshape(-1, len(frames), 7)
        found = found[np.isfinite(found).all(axis=(1, 2))]
        found = found[[bool(clear(self._arm, joints).all()) for joints in found]]
        found = found[np.abs(np.diff(found, axis=1)).max(axis=(1, 2), initial=0) < _JUMP]
        yield from found[np.argsort(np.abs(found[:, 0] - here).max(axis=1), kind="stable")][:_TRIED]


def dustpan_for(engine: Engine) -> Held:
    """The dustpan in the hand of an arm."""
    half = robots.PAN_WIDTH / 2
    lip, wall, high = robots.PAN_LIP, robots.PAN_WALL, robots.PAN_WALL_HEIGHT
    colour = [*(c / 255 for c in robots.PAN_COLOUR), 1]
    # A box leaning back, its upper front edge the lip: what would be in the table touches nothing (below).
    lean = float(np.arctan(PAN_SLOPE))
    thick = robots.PAN_WALL
    normal = np.array((-np.sin(lean), 0.0, np.cos(lean)))
    middle = np.array((-PAN_LENGTH / 2, 0.0, lip + _BACK / 2)) - thick / 2 * normal
    turn = (0.0, -float(np.sin(lean / 2)), 0.0, float(np.cos(lean / 2)))
    plate = (PAN_LENGTH / 2 / np.cos(lean), half, thick / 2), tuple(middle), turn
    walls = (
        plate,
        ((PAN_LENGTH / 2, wall / 2, high / 2), (-PAN_LENGTH / 2, half + wall / 2, high / 2), UPRIGHT),
        ((PAN_LENGTH / 2, wall / 2, high / 2), (-PAN_LENGTH / 2, -half - wall / 2, high / 2), UPRIGHT),
        ((wall / 2, half + wall, (_BACK + high) / 2), (wall / 2, 0.0, (_BACK + high) / 2), UPRIGHT),
    )
    links = []
    for extent, place, turn in walls:
        box = engine.createCollisionShape(engine.GEOM_BOX, halfExtents=extent)
        look = engine.createVisualShape(engine.GEOM_BOX, halfExtents=extent, rgbaColor=colour)
        links.append(
            Link(TOOL, engine.JOINT_FIXED, (0, 0, 1), robots.PAN_MASS, place, turn, touched=box, seen=look)
        )

    def tune(body: int) -> None:
        for link in range(TOOL + 1, TOOL + 1 + len(links)):
            engine.changeDynamics(
                body, link, lateralFriction=robots.PAN_FRICTION, rollingFriction=0, spinningFriction=0
            )
            for other in range(body):  # the furniture: where the dustpan goes is planned, not felt
                engine.setCollisionFilterPair(body, other, link, -1, 0)

    return Held(tuple(links), -1, half, tune)


def outline(frames: _Array) -> _Array:
    """(n, 4, 2, 3) both ends of the upper edges of the three walls, and of the plate's middle line, of
    dustpans with `frames` (n, 4, 4), metres."""
    y, side = robots.PAN_WIDTH / 2 + robots.PAN_WALL, robots.PAN_WALL_HEIGHT
    ends = np.array(
        [
            [(-PAN_LENGTH, -y, side), (0, -y, side)],
            [(-PAN_LENGTH, y, side), (0, y, side)],
            [(0, -y, _BACK + side), (0, y, _BACK + side)],
            [(-PAN_LENGTH, 0, robots.PAN_LIP), (0, 0, _BACK)],
        ]
    )
    turned: _Array = np.einsum("nij,skj->nski", frames[:, :3, :3], ends)
    return turned + frames[:, None, None, :3, 3]


def within(frame: _Array, points: _Array) -> NDArray[np.bool_]:
    """(n,) whether each of `points` (n, 3) lies in a dustpan whose frame is `frame` (4, 4)."""
    local = (points - frame[:3, 3]) @ frame[:3, :3]
    half = robots.PAN_WIDTH / 2
    low, high = np.array((-PAN_LENGTH, -half, 0)), np.array((0, half, _BACK + robots.PAN_WALL_HEIGHT))
    inside: NDArray[np.bool_] = np.asarray(((local >= low) & (local <= high)).all(axis=1))
    return inside
