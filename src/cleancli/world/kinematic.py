"""A fast stand-in for the simulated table with a gantry, for studies and tests: no forces, no engine.

A particle that the cloth reaches is carried along in front of it, unless it slips below the flap that it
meets; that is chance, by how high the stroke comes down and how the flaps hang. Carried particles leave the
cloth where they are past its ends. So it has the errors of strokes, and the times of the real motions within
a few hundredths; it has no heaps, no friction, nothing that rolls, no ink and no dustpan, and its particles
lie where they are dropped (docs/world.md).
"""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Bools, Floats, Points
from cleancli.motion.legs import Leg, legs, lengths
from cleancli.motion.path import ToolPath
from cleancli.scene.model import Ink, Scene
from cleancli.world.particles import places
from cleancli.world.rag import edge_heights, flap_offsets
from cleancli.world.robot import Status
from cleancli.world.robots import constants
from cleancli.world.robots.gantry import resting_pose, transit
from cleancli.world.table import Truth, stroke_error

SLIPS = 2.1e-3
"""Metres between the lower edge of a flap and the surface from which on half of the particles slip below it;
a lentil is 2.5 mm thick. Measured (python benchmarks/stand_in.py --part height --repeat 4 --seed 900)."""

SLIPS_SPREAD = 0.12e-3
"""Standard deviation of that from particle to particle. Measured with it: flaps differ far more."""

AHEAD = 6e-3
"""Metres before the flaps at which carried particles lie: half a flap's thickness and a particle's radius."""


def refuse_without_stand_in(scene: Scene) -> None:
    """Raises ValueError for a scene for which there is no stand-in: with another robot, with ink, or with a
    zone, where dirt lies in heaps."""
    has_ink = any(isinstance(dirt, Ink) for dirt in scene.dirt)
    if scene.robot != "gantry" or has_ink or scene.zone is not None:
        raise ValueError("only tables with a gantry and without ink or a zone have a fast stand-in")


class KinematicTable:
    """A `Mover`: motions take their time at once, and `dirt` is where the particles lie.

    Everything random comes from `seed`, in the order in which `PybulletTable` draws it. Raises what
    `refuse_without_stand_in` does.
    """

    def __init__(self, scene: Scene, seed: int) -> None:
        refuse_without_stand_in(scene)
        layout, tool, strokes, _ = np.random.default_rng(seed).spawn(4)
        self._scene, self._noise = scene, strokes
        self._places = places(scene.dirt, layout).spots
        self._flaps = flap_offsets(scene.rag)
        self._edges = edge_heights(scene.rag, tool)
        self._on_table = np.ones(len(self._places), np.bool_)
        self._inside = np.zeros(len(self._places), np.bool_)
        self._pose = resting_pose(scene)
        self._ahead: list[tuple[float, Floats]] = []
        self.clock = 0.0
        self.failure = ""

    @property
    def tool(self) -> tuple[float, float, float]:
        """Where the rag's lower middle is: x, y, z in metres."""
        x, y, z, _ = self._pose.tolist()
        return x, y, z

    @property
    def pose(self) -> Floats:
        """Where the tool is: x, y, z and yaw, (4,)."""
        return self._pose

    @property
    def dirt(self) -> Points:
        """(n, 2) where particles lie on the table, metres."""
        return self._places[self._on_table]

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """A gantry goes everywhere."""
        return True

    def start(self, path: ToolPath) -> None:
        """Begin a motion: the transit is over after one poll, the stroke after the next."""
        offset = stroke_error(path, self._noise, self._scene.height_noise)
        first, *_, last = (np.array((w.x, w.y, w.z, w.yaw)) + offset for w in path.waypoints)
        strokes = legs(path.waypoints, offset)
        way = transit(self._pose, first, path.waypoints[0].speed)
        self._ahead = [(_seconds(way), first), (_seconds(strokes), last)]
        for leg in strokes:
            if leg.level:
                self._push(leg.points)

    def withdraw(self) -> None:
        """Begin a motion to the resting pose outside the camera's view."""
        rest = resting_pose(self._scene)
        self._ahead = [(_seconds(transit(self._pose, rest)), rest)]

    def poll(self) -> Status:
        """Let the transit or the stroke pass."""
        if self._ahead:
            seconds, self._pose = self._ahead.pop(0)
            self.clock += seconds
        return Status.RUNNING if self._ahead else Status.DONE

    def stop(self) -> None:
        """Nothing fails here, and so nothing is stopped."""
        self._ahead = []

    def truth(self) -> Truth:
        """Where all dirt is. For reports: whoever plans or learns from this cheats."""
        positions = np.column_stack((self._places, np.zeros(len(self._places))))
        contained, remaining = int(self._inside.sum()), int(self._on_table.sum())
        return Truth(
            on_table=remaining,
            in_container=contained,
            in_zone=None,
            in_dustpan=0,
            on_floor=len(positions) - remaining - contained,
            total=len(positions),
            positions=positions,
            left=positions[self._on_table],
            ink=np.empty((0, 3)),
            ink_left=None,
        )

    def _push(self, poses: Floats) -> None:
        """Carry along what the cloth meets on its way over `poses` (n, 4), at most millimetres apart."""
        gaps = poses[0, 2] + self._edges
        slips = gaps > SLIPS + SLIPS_SPREAD * self._noise.standard_normal((len(self._places), 1))
        before, place = self._before_cloth(poses[0])
        for pose in poses[1:]:
            ahead, aside = self._before_cloth(pose)
            met = (before >= 0) & (ahead < 0) & self._on_table
            flap = np.abs(aside[:, None] - self._flaps[:, 1]).argmin(axis=1)
            met &= (np.abs(aside) <= self._scene.rag.width / 2) & ~slips[np.arange(len(slips)), flap]
            self._places[met] = self._at_cloth(pose, place[met])
            before, place = np.where(met, 0.0, ahead), np.where(met, place, aside)
            self._let_fall()

    def _before_cloth(self, pose: Floats) -> tuple[Floats, Floats]:
        """How far before the cloth each particle is, and how far aside of its middle, metres, (n,) each."""
        cos, sin = np.cos(pose[3]), np.sin(pose[3])
        x, y = (self._places - pose[:2]).T
        aside: Floats = cos * y - sin * x
        return cos * x + sin * y - self._cloth(aside), aside

    def _at_cloth(self, pose: Floats, aside: Floats) -> Points:
        """(n, 2) places before the cloth, so far aside of its middle: a particle does not slide along the
        cloth, whose friction is greater than the slant of any push (docs/world.md)."""
        cos, sin = np.cos(pose[3]), np.sin(pose[3])
        forward = self._cloth(aside)
        offsets = np.column_stack((cos * forward - sin * aside, sin * forward + cos * aside))
        places: Points = pose[:2] + offsets
        return places

    def _cloth(self, aside: Floats) -> Floats:
        """How far before the tool carried particles lie that are so far aside of its middle, (n,)."""
        return AHEAD + np.interp(aside, self._flaps[:, 1], self._flaps[:, 0])

    def _let_fall(self) -> None:
        """What is past the table's edge falls: into the container below its mouth, or on the floor."""
        half = np.array((self._scene.surface.width, self._scene.surface.depth)) / 2
        falls = self._on_table & (np.abs(self._places) > half).any(axis=1)
        if falls.any():
            self._inside |= falls & self._over_container()
            self._on_table &= ~falls

    def _over_container(self) -> Bools:
        first, last = (np.array(end) for end in self._scene.mouth())
        along = (last - first) / np.linalg.norm(last - first)
        offset = self._places - (first + last) / 2
        within = np.abs(offset @ along) <= self._scene.container.width / 2
        return np.asarray(within & (offset @ np.array(self._scene.outwards()) > 0))


def _seconds(motion: tuple[Leg, ...]) -> float:
    """How long legs take, each from rest to rest, at their speeds and the gantry's accelerations."""
    total = 0.0
    for leg in motion:
        rise = abs(float(leg.points[-1, 2] - leg.points[0, 2]))
        ways = lengths(leg.points)
        acceleration = constants.JOINT_ACCELERATION[2 if rise > float(ways.sum()) / 2 else 0]
        total += float((ways / leg.speeds[1:]).sum() + leg.speeds[1:].max() / acceleration)
    return total
