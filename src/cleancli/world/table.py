"""The pybullet table: a `Robot` that drags a rag over lentils, and tells the truth to reports alone."""

from __future__ import annotations

import time
from dataclasses import dataclass
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cleancli.motion.actions import LIFT, TRANSIT_SPEED
from cleancli.motion.path import ToolPath
from cleancli.motion.timing import Limits, Trajectory, parametrise
from cleancli.perception.frame import Frame
from cleancli.scene.model import Scene
from cleancli.world import camera, furniture, particles, robots
from cleancli.world import parameters as par
from cleancli.world.gantry import Gantry
from cleancli.world.physics import Engine
from cleancli.world.robot import Status

_LIMITS = Limits(robots.JOINT_SPEED, robots.JOINT_ACCELERATION, par.STEPS_PER_PERIOD * par.STEP)
_Pose = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Truth:
    """Where every lentil really is; for reports and tests, never for planning.

    `positions` (total, 3) of all lentils, and `left` (on_table, 3) of those still on the table, in metres.
    """

    on_table: int
    in_container: int
    on_floor: int
    total: int
    positions: NDArray[np.float64]
    left: NDArray[np.float64]


class PybulletTable:
    """A simulated table, gantry and camera (`Robot`); `close` it, or use it in a `with` statement.

    Everything random, from where lentils drop to the noise of each stroke and image, comes from `seed`.
    Raises `MissingPhysics` without pybullet, ValueError for a drive that it doesn't have.
    """

    def __init__(self, scene: Scene, seed: int, window: bool = False) -> None:
        _refuse_unknown(scene)
        layout, tool, strokes, images = np.random.default_rng(seed).spawn(4)
        self._scene = scene
        self._window = window
        self._engine = Engine(window)
        self._stroke_noise, self._image_noise = strokes, images
        furniture.build(self._engine, scene)
        self._gantry = Gantry(self._engine, scene.rag, tool)
        self._pose = resting_pose(scene)
        self._gantry.place(self._pose)
        self._particles = particles.drop(self._engine, particles.places(scene.dirt, layout), layout)
        particles.settle(self._engine, self._particles)
        self._camera = camera.overhead(scene.camera)
        self._steps = 0
        self._ahead: NDArray[np.float64] = np.empty((0, 4))
        self._status = Status.DONE

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free the engine; the table can't be used afterwards."""
        self._engine.close()

    @property
    def clock(self) -> float:
        """Seconds of robot time since the lentils came to rest."""
        return self._steps * par.STEP

    def observe(self) -> Frame:
        """One noisy RGB-D image of the table, and of the tool if it is in the way. Takes no robot time."""
        return camera.photograph(self._engine, self._camera, self._scene.light, self.clock, self._image_noise)

    def start(self, path: ToolPath) -> None:
        """Begin a transit above the surface to the path's first waypoint, then the path, with tool noise.

        Raises ValueError while another motion is under way. A path out of the gantry's reach fails at once.
        """
        poses = np.array([(w.x, w.y, w.z, w.yaw) for w in path.waypoints])
        offset = self._draw_noise(poses)
        self._begin(poses + offset, [w.speed for w in path.waypoints])

    def withdraw(self) -> None:
        """Begin a transit to the resting pose. Raises ValueError while another motion is under way."""
        self._begin(resting_pose(self._scene)[None], [TRANSIT_SPEED])

    def poll(self) -> Status:
        """Let one control period pass, or what is left of the motion; no time passes when none is under way.

        FAILED when the path was out of reach, or something holds the tool back.
        """
        if self._status is not Status.RUNNING:
            return self._status
        now, self._ahead = self._ahead[: par.STEPS_PER_PERIOD], self._ahead[par.STEPS_PER_PERIOD :]
        self._follow(now)
        if np.linalg.norm(self._gantry.pose()[:3] - self._pose[:3]) > robots.TRACKING_LIMIT:
            self._status = Status.FAILED
        elif not len(self._ahead):
            self._status = Status.DONE
        return self._status

    def stop(self) -> None:
        """End the motion now and raise the tool straight up; the clock runs until it is up."""
        here = self._gantry.pose()
        up = here.copy()
        up[2] = max(here[2], LIFT)
        self._follow(_sampled(parametrise(np.stack((here, up)), np.array([TRANSIT_SPEED]), _LIMITS)))
        self._ahead = self._ahead[:0]
        self._status = Status.DONE

    def truth(self) -> Truth:
        """Where every lentil is. For reports: whoever plans or learns from this cheats."""
        places = particles.positions(self._engine, self._particles)
        low, high = furniture.container_space(self._scene.container, self._scene.surface)
        inside = np.all((places >= low) & (places <= high), axis=1)
        half = np.array((self._scene.surface.width, self._scene.surface.depth)) / 2
        above = np.all(np.abs(places[:, :2]) <= half, axis=1) & (places[:, 2] > -par.TABLE_THICKNESS / 2)
        contained, remaining = int(inside.sum()), int(above.sum())
        return Truth(
            remaining, contained, len(places) - remaining - contained, len(places), places, places[above]
        )

    def show(self) -> None:
        """Let time pass in the window until somebody closes it; at once, if there is no window."""
        while self._window and self._engine.isConnected():
            self._engine.stepSimulation()
            time.sleep(par.STEP)

    def picture(self, width: int = 640, height: int = 480) -> NDArray[np.uint8]:
        """The table as an onlooker sees it from its corner, (height, width, 3) uint8 RGB, without noise."""
        return camera.onlook(self._engine, self._scene.surface, self._scene.light, width, height)

    def _draw_noise(self, poses: NDArray[np.float64]) -> _Pose:
        """This stroke's offset (4,): height, sideways to the first push, and yaw."""
        height, side, yaw = self._stroke_noise.normal(0, (par.HEIGHT_NOISE, par.SIDE_NOISE, par.YAW_NOISE))
        across = poses[0, 3] + np.pi / 2
        return np.array((side * np.cos(across), side * np.sin(across), height, yaw))

    def _begin(self, poses: NDArray[np.float64], speeds: list[float]) -> None:
        """Time the way to the first of `poses` (n, 4) and on through them; `speeds` (n,) go to each."""
        if self._status is Status.RUNNING:
            raise ValueError("a motion is under way: poll it to its end, or stop it")
        if not _within_reach(poses, self._scene):
            self._status = Status.FAILED
            return
        transit, paces = _transit(self._gantry.pose(), poses[0], speeds[0])
        whole = np.concatenate((transit, poses[1:]))
        self._ahead = _sampled(parametrise(whole, np.array([*paces, *speeds[1:]]), _LIMITS))
        self._status = Status.RUNNING

    def _follow(self, poses: NDArray[np.float64]) -> None:
        """One physics step for each of `poses` (n, 4)."""
        for pose in poses:
            self._gantry.command(pose)
            self._engine.stepSimulation()
            self._pose = pose
        self._steps += len(poses)


def _refuse_unknown(scene: Scene) -> None:
    if scene.robot != "gantry":
        raise ValueError(f"no drive is called `{scene.robot}`; this table has `gantry`")


def resting_pose(scene: Scene) -> _Pose:
    """Pose (4,) beside the table, outside the camera's view, on the nearest side without the container."""
    setup = scene.camera
    tool = scene.rag.width / 2 + robots.REST_CLEARANCE
    views = setup.height / (2 * setup.focal) * np.array((setup.image_width, setup.image_height))
    x, y = np.maximum(views, (scene.surface.width / 2, scene.surface.depth / 2)) + tool
    places = {"north": (0.0, y), "south": (0.0, -y), "west": (-x, 0.0), "east": (x, 0.0)}
    del places[scene.container.edge]
    nearest = min(places.values(), key=lambda place: abs(place[0]) + abs(place[1]))
    return np.array((*nearest, LIFT, 0.0))


def _transit(here: _Pose, there: _Pose, speed: float) -> tuple[NDArray[np.float64], list[float]]:
    """Poses from `here` up, across above the surface, to `there`; and the speeds to each after the first."""
    height = max(LIFT, here[2], there[2])
    up, across = here.copy(), there.copy()
    up[2] = across[2] = height
    return np.stack((here, up, across, there)), [TRANSIT_SPEED, speed, speed]


def _sampled(trajectory: Trajectory) -> NDArray[np.float64]:
    """(steps, 4) poses to be at after each physics step, the last of them the trajectory's end."""
    steps = int(np.ceil(trajectory.duration / par.STEP - 1e-9))
    return trajectory.poses(np.arange(1, steps + 1, dtype=np.float64) * par.STEP)


def _within_reach(poses: NDArray[np.float64], scene: Scene) -> bool:
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 + robots.REACH_MARGIN
    low, high = robots.REACH_HEIGHT
    return bool(np.all(np.abs(poses[:, :2]) <= half) and np.all((poses[:, 2] >= low) & (poses[:, 2] <= high)))
