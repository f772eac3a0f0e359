"""Between the protocol and a robot: refuses what is beyond its limits, and stops it when nobody asks any
more.

For drivers, which need nothing but NumPy beside it. It is no emergency stop: it runs where the driver runs,
and can do no more than call the driver's `stop` (docs/protocol.md).
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

import numpy as np

from cleancli.array_types import Floats, Points
from cleancli.motion.path import ToolPath, Waypoint
from cleancli.remote.messages import DUSTPAN, Description, FramePair, Limits, Poll, State
from cleancli.world.robot import Mover, Status

MOST_TOLD = 1000
"""Texts that wait to be told."""
CLOSING = 1.0
"""Seconds in which they are, when the driver ends."""
SLACK = 1e-9
"""Metres and m/s by which rounded numbers may miss a limit that they equal."""


Told = Callable[[str], object]
"""Is told what a person at the driver's terminal should know."""


class Teller:
    """Tells by a thread of its own: who watches over a robot must not wait for a terminal that is paused, a
    pipe that nobody reads, or what has gone. What is told meanwhile waits, up to `MOST_TOLD` texts."""

    def __init__(self, told: Told) -> None:
        self._told = told
        self._waiting = queue.Queue[str | None](MOST_TOLD)
        self._thread = threading.Thread(target=self._tell, name="teller", daemon=True)
        self._thread.start()

    def __call__(self, text: str) -> None:
        """Returns at once."""
        with suppress(queue.Full):
            self._waiting.put_nowait(text)

    def close(self) -> None:
        """Let what waits be told, for `CLOSING` seconds at most, and nothing more."""
        with suppress(queue.Full):
            self._waiting.put_nowait(None)
        self._thread.join(CLOSING)

    def _tell(self) -> None:
        while (text := self._waiting.get()) is not None:
            with suppress(Exception):
                self._told(text)


class Driver(Mover, Protocol):
    """A robot behind the guard. `clock`, `tool` and `stop` may be used by any thread, also while another
    method is being carried out; all else is done by one at a time. `start` plans, and returns when the motion
    begins. What a method raises trips the guard."""

    def observe(self) -> FramePair:
        """A pair that is taken after the call."""


class Guard:
    """A driver that is only told what its `description` allows, and is stopped after `lease` seconds without
    a poll while it moves. What stops it trips the guard, which `told` is told: it then refuses all motions
    until a person has said `rearm`. The watch is kept by a thread of its own, until `close`; `tell` is for
    what else a person should know."""

    def __init__(self, driver: Driver, description: Description, told: Told = lambda reason: None) -> None:
        self.driver, self.description = driver, description
        self.tell = Teller(told)
        # A signal's handler may close, and close again, in a thread that holds them.
        self._beginning = threading.RLock()  # held while a motion is planned, and begins
        self._tripping = threading.RLock()  # held while a robot that trips comes to a stop
        self._state = threading.Condition()
        self._due: float | None = None  # when the lease of the motion under way ends; None without one
        self._motion, self._ended = 0, Poll(Status.DONE, "")
        self._trip = ""
        self._is_open = True
        self._watch = threading.Thread(target=self._watched, name="watchdog", daemon=True)
        self._watch.start()

    def close(self) -> None:
        """End the watch; a motion that is under way is stopped first, and one that is being planned is waited
        for and stopped."""
        with self._state:
            self._is_open = False
        with self._beginning:
            self.lost("the driver ends")
        with self._state:
            self._state.notify_all()
        self._watch.join()

    @property
    def state(self) -> State:
        """Where the robot is."""
        return State(self.driver.clock, self.driver.tool, self._trip)

    def start(self, path: ToolPath) -> int | str:
        """The number of the motion that has begun, or why there is none."""
        reason = beyond(path, self.description)
        return reason or self._begun(lambda: self.driver.start(path))

    def withdraw(self) -> int | str:
        """The same out of the camera's view: where to is the driver's own choice."""
        return self._begun(self.driver.withdraw)

    def poll(self, motion: int) -> Poll | None:
        """Where a motion stands, which renews the lease; None for one that there was not, or that another one
        has followed."""
        if motion != self._motion or not motion:
            return None
        if self._due is None:
            return self._ended
        try:
            status = self.driver.poll()
            now = Poll(status, self.driver.failure if status is Status.FAILED else "")
        except Exception as error:  # whatever the driver raises: nobody knows what the robot does now
            self.trip(f"the driver failed: {error!r}")
            return self._ended
        with self._state:
            if self._due is None:  # tripped meanwhile
                return self._ended
            if status is Status.RUNNING:
                self._due = time.monotonic() + self.description.lease
            else:
                self._due, self._ended = None, now
            self._state.notify_all()
        return now

    def stop(self) -> None:
        """End the motion now, with the tool raised. No trip: this is asked for."""
        with self._state:
            was_moving, self._due = self._due is not None, None
            if was_moving:
                self._ended = Poll(Status.DONE, "")
            self._state.notify_all()
        try:
            self.driver.stop()
        except Exception as error:
            self.trip(f"the driver failed to stop: {error!r}")

    def trip(self, reason: str) -> None:
        """Stop the robot, and refuse all motions from now on."""
        with self._tripping:
            with self._state:
                if self._trip:
                    return
                self._trip, self._due = reason, None
                self._ended = Poll(Status.FAILED, reason)
                self._state.notify_all()
            try:
                self.driver.stop()
            except Exception as error:
                self._trip = f"{reason}; and the driver failed to stop: {error!r}"
            self.tell(f"tripped: {self._trip}")

    def lost(self, reason: str) -> None:
        """Nobody will poll any more: trip, if a motion is under way."""
        if self._due is not None:
            self.trip(reason)

    def rearm(self) -> None:
        """Carry motions out again, once a robot that trips stands still. For a person to say, who sees that
        nobody and nothing is in the way."""
        with self._tripping:
            self._trip = ""

    def _begun(self, begin: Callable[[], None]) -> int | str:
        if self._trip:
            return f"it has tripped: {self._trip}"
        if self._due is not None:
            return "a motion is under way"
        with self._beginning:
            if not self._is_open:
                return "the driver ends"
            try:
                begin()
            except Exception as error:
                self.trip(f"the driver failed: {error!r}")
                return f"it has tripped: {self._trip}"
            with self._state:
                # Planning takes its time: the lease begins when the motion does.
                self._due = time.monotonic() + self.description.lease
                self._motion += 1
                self._state.notify_all()
        return self._motion

    def _watched(self) -> None:
        while True:
            with self._state:
                if not self._is_open:
                    return
                left = None if self._due is None else self._due - time.monotonic()
                if left is None or left > 0:
                    self._state.wait(left)
                    continue
            self.trip(f"nobody has asked for {self.description.lease:g} s how a motion goes on")


def beyond(path: ToolPath, description: Description) -> str:
    """Why a path is not carried out, or nothing: its skills, and all of its waypoints against the limits."""
    asked = {path.interpolation.value} | ({DUSTPAN} if path.dustpan is not None else set())
    if missing := asked - set(description.skills):
        return f"the path asks for a skill that the robot has not: {min(missing)}"
    others = () if path.dustpan is None else (path.dustpan.place, path.dustpan.empty)
    return _beyond(path.waypoints, description.limits) or _beyond(others, description.limits)


def _beyond(waypoints: tuple[Waypoint, ...], limits: Limits) -> str:
    points = np.array([(w.x, w.y, w.z) for w in waypoints]).reshape(-1, 3)
    return points_beyond(points, limits) or speeds_beyond(np.array([w.speed for w in waypoints]), limits)


def points_beyond(points: Points, limits: Limits) -> str:
    """Why no tool may go to all of `points` (n, 3), or nothing. A box holds the straight lines between its
    points; who goes otherwise asks about the points on the way."""
    out = np.maximum(np.array(limits.low) - points, points - np.array(limits.high)).max(axis=1, initial=0)
    if (far := _worst(out)) is not None:
        x, y, z = 100 * points[far]
        return (
            f"point {far + 1} of the path, ({x:.1f}, {y:.1f}, {z:.1f}) cm, is {1000 * out[far]:.2f} mm "
            "outside of the workspace"
        )
    deep = -points[:, 2] - limits.depth
    if (far := _worst(deep)) is not None:
        return (
            f"point {far + 1} of the path is {-1000 * points[far, 2]:.2f} mm below the surface, and "
            f"{1000 * limits.depth:g} mm is the limit"
        )
    return ""


def speeds_beyond(speeds: Floats, limits: Limits) -> str:
    """Why no tool may go at all of these `speeds` (n,), or nothing."""
    fast = _worst(speeds - limits.speed)
    if fast is None:
        return ""
    at, most = f"{speeds[fast]:.4g} m/s", f"{limits.speed:g} is the limit"
    return f"point {fast + 1} of the path is reached at {at}, and {most}"


def _worst(excess: Floats) -> int | None:
    """The number of the first of the farthest beyond, None where none is."""
    return int(excess.argmax()) if len(excess) and excess.max() > SLACK else None
