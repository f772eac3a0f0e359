"""A robot that moves nothing: python examples/printing_robot.py SCENE FOLDER...

It prints where it is told to go, and shows the camera's frames of a folder for each look: the first until a
stroke was made, then the next, and the last from there on. `cleancli perceive SCENE --save-frames FOLDER`
makes such a folder of a simulated table; docs/recording.md says how to make one with a camera.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import cycle
from math import dist
from pathlib import Path

import cleancli
from cleancli.geometry.rgbd import Frame
from cleancli.motion.path import ToolPath, Waypoint
from cleancli.perception.recorded import load_frames
from cleancli.world.robot import Status

REST = Waypoint(0.0, 0.5, 0.3, 0.0, 0.4)
"""Where the tool is out of the camera's view: here 50 cm north of the middle, 30 cm above the surface."""


class PrintingRobot:
    """A `Robot` that says what it would do, and sees what was recorded."""

    def __init__(self, looks: Sequence[Sequence[Frame]]) -> None:
        self.looks = looks
        self.strokes = 0
        self.frames: Iterator[Frame] = cycle(looks[0])
        self.place, self.ahead = REST, list[Waypoint]()
        self.clock = 0.0
        self.failure = ""

    @property
    def tool(self) -> tuple[float, float, float]:
        """Where the rag's lower middle is."""
        return self.place.x, self.place.y, self.place.z

    def observe(self) -> Frame:
        """The next frame of the look that is due, as if it were taken now."""
        return replace(next(self.frames), clock=self.clock)

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """Whether all of a path is within a metre of the middle, as far as this robot would reach."""
        return all(dist((0, 0), (to.x, to.y)) < 1 for to in path.waypoints)

    def start(self, path: ToolPath) -> None:
        """A stroke: the way to its beginning, and the stroke itself."""
        print(f"at {self.clock:.1f} s a stroke, {path.interpolation.value} from waypoint to waypoint")
        self.ahead = list(path.waypoints)
        self.strokes += 1
        self.frames = cycle(self.looks[min(self.strokes, len(self.looks) - 1)])

    def withdraw(self) -> None:
        """Out of the camera's view."""
        if self.place != REST:
            print(f"at {self.clock:.1f} s out of view")
            self.ahead = [REST]

    def poll(self) -> Status:
        """Go to the next waypoint; a real robot would wait for one control period here."""
        if self.ahead:
            before, to = self.place, self.ahead.pop(0)
            print(f"  to ({100 * to.x:.1f}, {100 * to.y:.1f}, {100 * to.z:.1f}) cm at {to.speed:.2f} m/s")
            self.clock += dist((before.x, before.y, before.z), (to.x, to.y, to.z)) / to.speed
            self.place = to
        return Status.RUNNING if self.ahead else Status.DONE

    def stop(self) -> None:
        """A real robot would end its motion now, and raise its tool."""
        print(f"at {self.clock:.1f} s stopped")
        self.ahead = []


def main(scene: str, *folders: str) -> None:
    """Carry two actions out with this robot."""
    robot = PrintingRobot([load_frames(Path(folder)) for folder in folders])
    print(cleancli.execute("sweeping", scene, robot=robot, max_actions=2))


if __name__ == "__main__":
    main(*sys.argv[1:])
