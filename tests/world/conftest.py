"""Scenes on the simulated table, and motions carried to their end."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable

import pytest

from cleancli.scene.grasps import WIDE
from cleancli.scene.model import (
    CameraSetup,
    Container,
    Group,
    Rag,
    Scattered,
    Scene,
    Surface,
    SymbolThresholds,
)
from cleancli.world.robot import Robot, Status


@pytest.fixture
def scene() -> Callable[..., Scene]:
    """A scene with the given dirt, robot and size, and the container at the given edge."""

    def make(
        *dirt: Group | Scattered,
        edge: str = "east",
        robot: str = "gantry",
        size: tuple[float, float] = (0.9, 0.7),
    ) -> Scene:
        return Scene(
            name="trial",
            surface=Surface(*size, 0.45, (205, 198, 184)),
            container=Container(edge, 0.0, 0.32, 0.16),
            robot=robot,
            rag=Rag(WIDE, 0.12),
            camera=CameraSetup(0.9, 640, 480, 525),
            dirt=dirt,
            symbols=SymbolThresholds(0.035, 0.05, 0.10, 0.3, 0.2, 0.06),
            seed=1,
        )

    return make


@pytest.fixture
def finish() -> Callable[[Robot], Status]:
    """Poll a robot until its motion is over."""

    def poll(robot: Robot) -> Status:
        while (status := robot.poll()) is Status.RUNNING:
            pass
        return status

    return poll


@pytest.fixture
def in_two_processes() -> Callable[[str], tuple[str, str]]:
    """What a script prints, in one process and in another."""

    def printed(script: str) -> tuple[str, str]:
        command = [sys.executable, "-c", script]
        first, second = (
            subprocess.run(command, capture_output=True, text=True, check=True).stdout for _ in range(2)
        )
        return first, second

    return printed
