"""Scenes for the simulated table, and scripts that are run twice."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

from cleancli.scene.grasps import WIDE
from cleancli.scene.model import (
    CameraSetup,
    Container,
    Group,
    Ink,
    Rag,
    Scattered,
    Scene,
    Surface,
    SymbolThresholds,
)


def scene(
    *dirt: Group | Scattered | Ink,
    edge: str = "east",
    robot: str = "gantry",
    size: tuple[float, float] = (0.9, 0.7),
) -> Scene:
    """A scene with the given dirt, robot and size, and the container at the given edge."""
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


PAPER = replace(scene(Group(12, (0.0, 0.0), 0.02), robot="wam", size=(0.60, 0.55)), name="paper")
"""The scene of the paper's size, cleaned by the arm of the paper."""


def in_two_processes(script: str) -> tuple[str, str]:
    """What a script prints, in one process and in another."""
    command = [sys.executable, "-c", script]
    first, second = (
        subprocess.run(command, capture_output=True, text=True, check=True).stdout for _ in range(2)
    )
    return first, second
