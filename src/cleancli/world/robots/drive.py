"""What the simulated table needs of a robot's drive: joints to follow for a path, and their command."""

from __future__ import annotations

from typing import Protocol

from cleancli.array_types import Bools, Floats
from cleancli.motion.path import ToolPath


class Drive(Protocol):
    """A drive with `d` joints. The motions it makes are rows of joints (k, d), one for each physics step."""

    def place(self) -> None:
        """Stand at rest at once; only before the clock starts."""

    def follow(self, path: ToolPath, offset: Floats) -> Floats:
        """From where the joints are to the path's first waypoint, and along it, each pose moved by `offset`
        (4,).

        Raises Unreachable if the drive can't.
        """

    def withdraw(self) -> Floats:
        """From where the joints are to rest, out of the camera's view. Raises Unreachable if there is no
        way."""

    def lift(self) -> Floats:
        """From where the joints are straight up, until the tool is clear of the surface."""

    def command(self, joints: Floats) -> None:
        """Be at `joints` (d,) after the next step, as far as forces allow."""

    def commanded(self) -> Floats:
        """Where it was last commanded to be, (d,)."""

    def tool(self) -> Floats:
        """Where the tool is: x, y, z and yaw, (4,)."""

    def stray(self) -> float:
        """How far the tool is from where it was commanded to be, metres."""

    def flaps(self) -> Floats:
        """(n, 3) middles of the rag's flaps, metres."""

    def holds(self, points: Floats) -> Bools:
        """(n,) which of `points` (n, 3) lie in its dustpan; none without one."""
