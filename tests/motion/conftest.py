"""The scene of the paper's size, cleaned by the arm of the paper."""

from __future__ import annotations

import pytest

from cleancli.scene.grasps import WIDE
from cleancli.scene.model import CameraSetup, Container, Group, Rag, Scene, Surface, SymbolThresholds


@pytest.fixture(scope="session")
def paper_scene() -> Scene:
    return Scene(
        name="paper",
        surface=Surface(0.60, 0.55, 0.45, (205, 198, 184)),
        container=Container("east", 0.0, 0.32, 0.16),
        robot="wam",
        rag=Rag(WIDE, 0.12),
        camera=CameraSetup(0.9, 640, 480, 525),
        dirt=(Group(12, (0.0, 0.0), 0.02),),
        symbols=SymbolThresholds(0.035, 0.05, 0.10, 0.3, 0.2, 0.06),
        seed=1,
    )
