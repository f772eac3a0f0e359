"""The simulated table as a driver: in lockstep with its client, or in real time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from cleancli.motion.pace import TRANSIT_SPEED
from cleancli.motion.path import ToolPath
from cleancli.remote.messages import DUSTPAN, SKILLS, Description, FramePair, Limits
from cleancli.scene.model import Scene
from cleancli.world import constants as par
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable

PERIOD = par.STEP * par.STEPS_PER_PERIOD
"""Seconds of robot time that a poll lets pass."""


AROUND, HIGHEST, DEPTH = 0.25, 0.4, 5e-3
"""Metres of the workspace: beyond the surface's edges, above it, and below it. Chosen: strokes end above the
container, and a rag that was in vain is pressed up to 3 mm down."""

LATE = 3
"""Periods after which a poll is answered even if none has passed: the machine is slow."""


class SimulatedDriver:
    """A `Driver`. In lockstep the table moves while it is polled, as it does in process. In `real_time` it
    moves by itself, a period each period, and stands still between motions in both."""

    def __init__(self, table: PybulletTable, real_time: bool) -> None:
        self._table, self._real_time = table, real_time
        self._moved = threading.Condition()  # its lock also keeps the engine to one thread at a time
        self._periods, self._now = 0, Status.DONE
        self._motion = 0  # how many have begun
        self._error: Exception | None = None  # of the thread that moves the table

    @property
    def clock(self) -> float:
        """Seconds of robot time."""
        return self._table.clock

    @property
    def tool(self) -> tuple[float, float, float]:
        """Where the rag's lower middle is."""
        with self._moved:
            return self._table.tool

    @property
    def failure(self) -> str:
        """Why the last motion failed."""
        return self._table.failure

    def observe(self) -> FramePair:
        """A pair as the simulated camera takes it, both at one time."""
        with self._moved:
            frame = self._table.observe()
        camera = frame.camera
        stamps, focal = (frame.clock, frame.clock), (camera.focal, camera.focal)
        return FramePair(frame.colour, frame.depth, *stamps, focal, camera.centre, camera.pose)

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """By planning it."""
        with self._moved:
            return self._table.can_follow(path, errors)

    def start(self, path: ToolPath) -> None:
        """Plan, and set off."""
        self._set_off(lambda: self._table.start(path))

    def withdraw(self) -> None:
        """Set off out of view."""
        self._set_off(self._table.withdraw)

    def poll(self) -> Status:
        """Let a period pass, or wait for the one that passes."""
        with self._moved:
            if not self._real_time:
                return self._table.poll()
            periods = self._periods
            self._moved.wait_for(
                lambda: self._periods != periods or self._now is not Status.RUNNING, LATE * PERIOD
            )
            if self._error is not None:
                raise self._error
            return self._now

    def stop(self) -> None:
        """At the end of the period under way."""
        with self._moved:
            self._now = Status.DONE
            self._table.stop()

    def _set_off(self, begin: Callable[[], None]) -> None:
        with self._moved:
            begin()
            self._now, self._error = Status.RUNNING, None
            self._motion += 1
            number = self._motion
        if self._real_time:
            threading.Thread(target=self._go_on, args=(number,), name="motion", daemon=True).start()

    def _go_on(self, number: int) -> None:
        """A period of the table each period of real time, or later where it takes longer to compute, until
        the motion of this number is over, or another one has begun."""
        due = time.monotonic()
        while True:
            due = max(due + PERIOD, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))
            with self._moved:
                if self._motion != number or self._now is not Status.RUNNING:
                    return
                try:
                    self._now = self._table.poll()
                except Exception as error:  # for whoever polls: a thread has nobody to tell
                    self._now, self._error = Status.FAILED, error
                self._periods += 1
                self._moved.notify_all()


def description(scene: Scene, lease: float) -> Description:
    """What the robot of a scene's table says of itself."""
    x, y = scene.surface.width / 2 + AROUND, scene.surface.depth / 2 + AROUND
    limits = Limits((-x, -y, -DEPTH), (x, y, HIGHEST), TRANSIT_SPEED, DEPTH)
    skills = tuple(skill for skill in SKILLS if scene.arms > 1 or skill != DUSTPAN)
    return Description(f"simulated {scene.robot}", skills, limits, lease, PERIOD)
