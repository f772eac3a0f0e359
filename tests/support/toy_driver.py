"""A driver without physics, in real time: its tool goes straight from waypoint to waypoint."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from math import dist
from threading import Thread

import numpy as np

from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.remote.guard import Driver
from cleancli.remote.messages import Description, FramePair, Limits
from cleancli.remote.server import Server
from cleancli.scene.address import Address
from cleancli.world.robot import Status

Place = tuple[float, float, float]

ANYWHERE = Address("127.0.0.1", 0)
"""A port that is free."""
TOY = Description(
    "toy", ("straight", "joint"), Limits((-0.5, -0.4, -0.02), (0.5, 0.4, 0.3), 0.25, 0.005), 0.3, 0.01
)
REST = Waypoint(0.0, 0.39, 0.2, 0.0, 0.25)


def path(*points: Place, speed: float = 0.25) -> ToolPath:
    """Straight through these points."""
    return ToolPath(tuple(Waypoint(*point, 0.0, speed) for point in points), Interpolation.STRAIGHT)


class Toy:
    """A `Driver`; `size` (height, width) of its pictures, which are noise. Its clock goes `pace` times as
    fast as real time."""

    pace = 1.0

    def __init__(self, size: tuple[int, int] = (6, 8)) -> None:
        self.failure = ""
        self.stops = 0
        self._size, self._noise = size, np.random.default_rng(1)
        self._began = time.monotonic()
        self._corners: list[tuple[float, Place]] = [(0.0, (REST.x, REST.y, REST.z))]

    @property
    def clock(self) -> float:
        """Seconds since it was made."""
        return self.pace * (time.monotonic() - self._began)

    @property
    def tool(self) -> Place:
        """Between the two corners of this time."""
        now = self.clock
        for (before, a), (after, b) in pairwise(self._corners):
            if before <= now < after:
                share = (now - before) / (after - before)
                x, y, z = (p + share * (q - p) for p, q in zip(a, b, strict=True))
                return x, y, z
        return self._corners[-1][1]

    @property
    def ends(self) -> float:
        """When the motion under way is over."""
        return self._corners[-1][0]

    def observe(self) -> FramePair:
        """Noise, taken now."""
        colour = self._noise.integers(0, 256, (*self._size, 3), np.uint8)
        depth = self._noise.random(self._size, np.float32)
        height, width = self._size
        centre, now = (width / 2, height / 2), self.clock
        return FramePair(colour, depth, now, now, (525.0, 525.0), centre, np.eye(4))

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """Whatever the path."""
        return True

    def start(self, path: ToolPath) -> None:
        """From where the tool is."""
        corners, here = [(self.clock, self.tool)], self.tool
        for to in path.waypoints:
            there = to.x, to.y, to.z
            corners.append((corners[-1][0] + dist(here, there) / to.speed, there))
            here = there
        self._corners = corners

    def withdraw(self) -> None:
        """To rest."""
        self.start(ToolPath((REST,), Interpolation.STRAIGHT))

    def poll(self) -> Status:
        """After a period, or when the motion is over."""
        time.sleep(max(0.0, min(TOY.period, (self.ends - self.clock) / self.pace)))
        return Status.RUNNING if self.clock < self.ends else Status.DONE

    def stop(self) -> None:
        """Stand still at once, with the tool raised."""
        x, y, z = self.tool
        self.stops += 1
        self._corners = [(self.clock, (x, y, max(z, 0.05)))]


@contextmanager
def served(driver: Driver, description: Description = TOY, **changed: object) -> Iterator[Server]:
    """A server of a driver in this process; `changed`: fields of the description."""
    server = Server(driver, replace(description, **changed), ANYWHERE)  # type: ignore[arg-type]
    thread = Thread(target=server.serve, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.close()
        thread.join()
