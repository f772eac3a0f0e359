"""The pybullet table: a `Robot` that drags a rag over lentils, and tells the truth to reports alone."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from math import atan2
from types import TracebackType
from typing import Self

import numpy as np

from cleancli.array_types import Bools, Floats, Image, Points
from cleancli.geometry.rgbd import Frame
from cleancli.motion.path import ToolPath, Unreachable
from cleancli.motion.zone import inwards
from cleancli.scene.model import Ink, Scene
from cleancli.world import camera, furniture, particles
from cleancli.world import constants as par
from cleancli.world.image_effects import Finish
from cleancli.world.ink import InkLayer
from cleancli.world.onlooker import Onlooker
from cleancli.world.physics import Engine
from cleancli.world.robot import Status
from cleancli.world.robots import constants
from cleancli.world.robots.drive import Drive
from cleancli.world.robots.registry import ROBOTS
from cleancli.world.state import TableState, bodies, put
from cleancli.world.viewpoint import around

BLOCKED = "something holds the tool back"


@dataclass(frozen=True, slots=True)
class Truth:
    """Where all dirt really is; for reports and tests, never for planning.

    `positions` (total, 3) of all particles, and `left` (on_table, 3) of those still on the table, in metres.
    `in_zone`: those whose middle lies in the scene's zone, and which do not count as on the table; None
    without a zone.
    `ink` (n, 3): x, y and amount of the cells whose ink can be seen; `ink_left`: the share of all ink,
    None where there was none.
    """

    on_table: int
    in_container: int
    in_zone: int | None
    in_dustpan: int
    on_floor: int
    total: int
    positions: Floats
    left: Floats
    ink: Floats
    ink_left: float | None


class PybulletTable:
    """A simulated table, robot and camera (`Robot`); `close` it, or use it in a `with` statement.

    Everything random, from where lentils drop to the noise of each stroke and image, comes from `seed`. Given
    the `state` that a table of this scene and seed was in, it goes on from there.
    Raises `MissingPhysics` without pybullet, ValueError for a robot that it doesn't have, or a state that is
    another table's.
    """

    _engine: Engine
    _drive: Drive
    _ink: InkLayer | None
    _finish: Finish
    _shown: Finish
    _top: int
    _particles: tuple[int, ...]
    _stroke_noise: np.random.Generator
    _image_noise: np.random.Generator
    _steps: int
    _ahead: Floats
    _status: Status
    _failure: str

    def __init__(
        self, scene: Scene, seed: int, window: bool = False, state: TableState | None = None
    ) -> None:
        _refuse_unknown(scene)
        self._scene, self._seed, self._window = scene, seed, window
        self._camera = camera.overhead(scene.camera)
        self._onlookers: dict[tuple[int, int], Onlooker] = {}
        self._build()
        if state is None:
            particles.settle(self._engine, self._particles)
        else:
            try:
                self._put(state)
            except BaseException:
                self.close()
                raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free the engine; the table can't be used afterwards."""
        self._engine.close()
        for onlooker in self._onlookers.values():
            onlooker.close()
        self._onlookers.clear()

    @property
    def clock(self) -> float:
        """Seconds of robot time since the lentils came to rest."""
        return self._steps * par.STEP

    def observe(self) -> Frame:
        """One noisy RGB-D image of the table, and of the tool if it is in the way. Takes no robot time."""
        return camera.photograph(
            self._engine, self._camera, self._scene.light, self._finish, self.clock, self._image_noise
        )

    @property
    def tool(self) -> tuple[float, float, float]:
        """Where the rag's lower middle is, by the robot's joints: x, y, z in metres."""
        x, y, z, _ = self._drive.tool().tolist()
        return x, y, z

    @property
    def failure(self) -> str:
        """Why the last motion FAILED, or nothing."""
        return self._failure

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """Whether the drive plans it from where the joints are, with errors of so many standard
        deviations to either side across its way, in height and in yaw."""
        try:
            for side, turn in product((-errors, errors), repeat=2):
                self._drive.follow(path, _error(path, side, turn, turn, self._scene.height_noise))
        except Unreachable:
            return False
        return True

    def start(self, path: ToolPath) -> None:
        """Begin a transit above the surface to the path's first waypoint, then the path, with tool noise.

        Raises ValueError while another motion is under way. A path out of reach fails at once.
        """
        offset = stroke_error(path, self._stroke_noise, self._scene.height_noise)
        self._begin(lambda: self._drive.follow(path, offset))

    def withdraw(self) -> None:
        """Begin a transit to rest, out of the camera's view. Raises ValueError while a motion is under
        way."""
        self._begin(self._drive.withdraw)

    def poll(self) -> Status:
        """Let one control period pass, or what is left of the motion; no time passes when none is under way.

        FAILED when the path was out of reach, or something holds the tool back; `failure` says which.
        """
        if self._status is not Status.RUNNING:
            return self._status
        now, self._ahead = self._ahead[: par.STEPS_PER_PERIOD], self._ahead[par.STEPS_PER_PERIOD :]
        self._follow(now)
        if self._drive.stray() > constants.TRACKING_LIMIT:
            self._status, self._failure = Status.FAILED, BLOCKED
        elif not len(self._ahead):
            self._status = Status.DONE
        return self._status

    def stop(self) -> None:
        """End the motion now and raise the tool straight up; the clock runs until it is up."""
        self._follow(self._drive.lift())
        self._ahead = self._ahead[:0]
        self._status = Status.DONE

    def save(self) -> TableState:
        """What everything is like now, for another table to go on from.

        This table goes on from it too, built anew: whatever follows is then the same bit for bit in both, in
        whichever process. What is lost are the engine's contacts of the step before, found again in the next.
        """
        places, joints = bodies(self._engine, self._particles)
        ink, uses = self._ink, {"strokes": self._stroke_noise, "images": self._image_noise}
        state = TableState(
            particles=places,
            joints=joints,
            commanded=self._drive.commanded(),
            ahead=self._ahead,
            ink=np.empty((0, 0), np.float32) if ink is None else ink.amount,
            flaps=np.empty((0, 3)) if ink is None or ink.flaps is None else ink.flaps,
            steps=self._steps,
            status=self._status.value,
            failure=self._failure,
            generators={use: generator.bit_generator.state for use, generator in uses.items()},
        )
        self._engine.close()
        self._build()
        self._put(state)
        return state

    def truth(self) -> Truth:
        """Where all dirt is. For reports: whoever plans or learns from this cheats."""
        places = particles.positions(self._engine, self._particles)
        low, high = furniture.container_space(self._scene.container, self._scene.surface)
        inside = np.all((places >= low) & (places <= high), axis=1)
        half = np.array((self._scene.surface.width, self._scene.surface.depth)) / 2
        above = np.all(np.abs(places[:, :2]) <= half, axis=1) & (places[:, 2] > -par.TABLE_THICKNESS / 2)
        held = self._drive.holds(places) & ~inside
        above &= ~held
        arrived = above & _in_zone(places[:, :2], self._scene)
        above &= ~arrived
        contained, carried, remaining = int(inside.sum()), int(held.sum()), int(above.sum())
        return Truth(
            on_table=remaining,
            in_container=contained,
            in_zone=None if self._scene.zone is None else int(arrived.sum()),
            in_dustpan=carried,
            on_floor=len(places) - remaining - carried - contained - int(arrived.sum()),
            total=len(places),
            positions=places,
            left=places[above],
            ink=np.empty((0, 3)) if self._ink is None else self._ink.places(),
            ink_left=None if self._ink is None else self._ink.left(),
        )

    def show(self) -> None:
        """Let time pass in the window until somebody closes it; at once, if there is no window."""
        while self._window and self._engine.isConnected():
            self._engine.stepSimulation()
            time.sleep(par.STEP)

    def picture(self, width: int = 640, height: int = 480) -> Image:
        """The table and the robot as an onlooker sees them, (height, width, 3) uint8 RGB, with shadows and
        without noise, and with the scene's zone painted on the surface."""
        if (width, height) not in self._onlookers:
            self._onlookers[width, height] = self._onlooker((width, height))
        return self._onlookers[width, height].picture(self._engine, self._particles, self._shown)

    def _onlooker(self, size: tuple[int, int]) -> Onlooker:
        """A camera for people, before which everything stands as the seed has it at first."""
        robot, stage = ROBOTS[self._scene.robot], Engine()
        _, actors = _cast(stage, self._scene, self._seed)
        east, north = self._scene.outwards()
        azimuth = atan2(north, east) + robot.aspect
        points = np.concatenate((furniture.corners(self._scene), robot.extent(self._scene)))
        field, aspect = par.PICTURE_FIELD * par.PICTURE_FILLED, size[0] / size[1]
        view = around(points, azimuth, par.PICTURE_ELEVATION, field, aspect)
        return Onlooker(self._scene, stage, actors, replace(view, field=par.PICTURE_FIELD), points, size)

    def _build(self) -> None:
        """Everything in its place, dirt just above the surface, with what the seed draws first."""
        scene = self._scene
        _, _, strokes, images = np.random.default_rng(self._seed).spawn(4)
        self._engine = Engine(self._window)
        self._stroke_noise, self._image_noise = strokes, images
        self._top = furniture.build(self._engine, scene)
        self._ink = InkLayer(scene) if any(isinstance(dirt, Ink) for dirt in scene.dirt) else None
        self._finish = Finish(scene, self._ink)
        self._shown = Finish(scene, self._ink, scene.zone)
        self._drive, self._particles = _cast(self._engine, scene, self._seed)
        self._steps = 0
        self._ahead = np.empty((0, 0))
        self._status, self._failure = Status.DONE, ""

    def _put(self, state: TableState) -> None:
        """Bring a table that has just been built to a state. Raises ValueError for one of another table."""
        drives = self._drive.commanded().shape
        if state.commanded.shape != drives or (len(state.ahead) and state.ahead.shape[1:] != drives):
            raise ValueError("the saved state is of another table: its robot has other joints")
        if len(state.flaps) and state.flaps.shape != self._drive.flaps().shape:
            raise ValueError("the saved state is of another table: its rag has other flaps")
        put(self._engine, self._particles, state)
        particles.keep_in_room(self._engine, self._particles)
        self._drive.command(state.commanded)
        self._stroke_noise.bit_generator.state = state.generators["strokes"]
        self._image_noise.bit_generator.state = state.generators["images"]
        self._steps, self._ahead = state.steps, state.ahead
        self._status, self._failure = Status(state.status), state.failure
        if self._ink is not None:
            if state.ink.shape != self._ink.amount.shape:
                raise ValueError("the saved state is of another table: its surface has another size")
            self._ink.amount = state.ink.copy()
            self._ink.flaps = state.flaps if len(state.flaps) else None

    def _begin(self, plan: Callable[[], Floats]) -> None:
        """Start the motion that `plan` gives, or fail for the reason it raises."""
        if self._status is Status.RUNNING:
            raise ValueError("a motion is under way: poll it to its end, or stop it")
        try:
            self._ahead = plan()
        except Unreachable as reason:
            self._status, self._failure = Status.FAILED, str(reason)
        else:
            self._status, self._failure = Status.RUNNING, ""

    def _follow(self, motion: Floats) -> None:
        """One physics step for each row of joints."""
        for joints in motion:
            self._drive.command(joints)
            self._engine.stepSimulation()
        self._steps += len(motion)
        particles.keep_in_room(self._engine, self._particles)
        if self._ink is not None:
            self._ink.rub(self._engine, self._top, self._drive.flaps())


def _cast(engine: Engine, scene: Scene, seed: int) -> tuple[Drive, tuple[int, ...]]:
    """All that moves: the robot at rest, and particles just above the surface, as the seed has them."""
    layout, tool, *_ = np.random.default_rng(seed).spawn(4)
    drive = ROBOTS[scene.robot].build(engine, scene, tool)
    drive.place()
    return drive, particles.drop(engine, particles.places(scene.dirt, layout), layout)


def stroke_error(path: ToolPath, rng: np.random.Generator, height_noise: float | None) -> Floats:
    """How far off the tool is during a stroke, (4,): x, y, z in metres, and yaw. Drawn across the way of the
    first push, in height, by the scene's `height_noise`, and in yaw; a rag is pressed as well, if no dustpan
    takes part."""
    height, side, yaw = rng.normal(size=3)
    return _error(path, side, height, yaw, height_noise)


def _error(path: ToolPath, side: float, height: float, yaw: float, height_noise: float | None) -> Floats:
    """The same for errors given in standard deviations."""
    across = path.waypoints[0].yaw + np.pi / 2
    press = par.PRESS if path.dustpan is None else 0.0
    aside = side * par.SIDE_NOISE
    lift = height * (par.HEIGHT_NOISE if height_noise is None else height_noise) - press
    turn = yaw * par.YAW_NOISE
    return np.array((aside * np.cos(across), aside * np.sin(across), lift, turn))


def _in_zone(places: Points, scene: Scene) -> Bools:
    """(n,) which of places (n, 2) lie in the scene's zone."""
    if scene.zone is None:
        return np.zeros(len(places), np.bool_)
    return np.asarray(inwards(scene.zone, places) >= 0)


def _refuse_unknown(scene: Scene) -> None:
    if scene.robot not in ROBOTS:
        raise ValueError(f"no robot is called `{scene.robot}`; this table has {', '.join(ROBOTS)}")
