"""What is raised without a physics engine, and of robots elsewhere. The module loads nothing, since every
command catches both."""

from __future__ import annotations


class MissingPhysics(ImportError):
    """pybullet isn't installed, so there is no table to simulate."""

    def __init__(self) -> None:
        super().__init__("the simulated table needs pybullet: pip install 'pybullet>=3.2.7'")


class RobotError(OSError):
    """A robot's driver cannot be worked with: it does not answer, breaks the protocol, or has tripped."""
