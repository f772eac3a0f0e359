"""What the executor needs of a robot, simulated or real: look, start a motion, poll it, stop."""

from __future__ import annotations

import enum
import time
from collections.abc import Iterator
from typing import Protocol

from cleancli.geometry.rgbd import Frame
from cleancli.motion.path import ToolPath

LONGEST = 300.0
"""Seconds of the robot's clock after which a motion has failed; strokes take seconds. Chosen."""
STILL = 10.0
"""Real seconds for which the clock may stand still in a motion. Chosen."""


class Status(enum.Enum):
    """Where a started motion stands."""

    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"


class Mover(Protocol):
    """A robot with one tool."""

    @property
    def clock(self) -> float:
        """Seconds of robot time since the start."""

    @property
    def tool(self) -> tuple[float, float, float]:
        """Where the robot says that the rag's lower middle is: x, y, z in metres."""

    @property
    def failure(self) -> str:
        """Why the last motion failed, or nothing."""

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """Whether it can carry out a path from where it is, with errors of so many standard deviations.

        Nothing moves.
        """

    def start(self, path: ToolPath) -> None:
        """Begin a motion: a transit from the present pose to its first waypoint, then the path."""

    def withdraw(self) -> None:
        """Begin a motion to the resting pose outside the camera's view."""

    def poll(self) -> Status:
        """Let up to one control period pass and say where the motion stands."""

    def stop(self) -> None:
        """End the motion now, with the tool raised."""


class Robot(Mover, Protocol):
    """A robot with a tool and one fixed camera. Only `observe` tells anything about the dirt."""

    def observe(self) -> Frame:
        """Take one RGB-D image from where everything stands now."""


def polled(robot: Mover) -> Iterator[Status]:
    """What each poll of the motion that is under way says, to its end; RUNNING last of all, where it has
    none."""
    began = clock = robot.clock
    since = time.monotonic()
    while True:
        status = robot.poll()
        yield status
        if robot.clock > clock:
            clock, since = robot.clock, time.monotonic()
        is_late = clock - began > LONGEST or time.monotonic() - since > STILL
        if status is not Status.RUNNING or is_late:
            return


def finish(robot: Mover) -> Status:
    """Let the motion that is under way go on to its end, and say how it ended. One that has none is
    stopped."""
    *_, status = polled(robot)
    if status is Status.RUNNING:
        robot.stop()
        return Status.FAILED
    return status
