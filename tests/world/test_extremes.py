"""Areas off the table and very many particles: a result, or a motion that fails at once."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing

import numpy as np
import pytest

from cleancli.motion.actions import tool_path
from cleancli.perception.area import Ellipse
from cleancli.perception.perceive import perceive
from cleancli.scene.model import Scattered, Scene
from cleancli.world.robot import Robot, Status
from cleancli.world.table import PybulletTable

MakeScene = Callable[..., Scene]
Finish = Callable[[Robot], Status]


def test_areas_off_the_table_end_the_motion_or_fail_it_at_once(scene: MakeScene, finish: Finish) -> None:
    setting = scene(edge="north")
    beyond, far = Ellipse((0.55, 0.1), (0.05, 0.03), 0.2), Ellipse((-3.0, -2.0), (0.05, 0.03), 0.2)
    wide = Ellipse((0.3, 0.3), (0.5, 0.3), 0.4)
    with closing(PybulletTable(setting, 1)) as table:
        for action, areas, end in (
            ("moveToContainerFast", (beyond,), Status.DONE),
            ("moveToContainerFast", (wide,), Status.DONE),
            ("join2", (wide, far), Status.FAILED),
            ("join3", (beyond, wide, far), Status.FAILED),
        ):
            clock = table.clock
            table.start(tool_path(action, areas, setting))
            assert finish(table) is end
            assert (table.clock == clock) == (end is Status.FAILED), "what fails is not begun"


def test_five_hundred_lentils_lie_and_are_seen(scene: MakeScene) -> None:
    setting = scene(Scattered(500, (-0.40, -0.30), (0.40, 0.30)))
    with closing(PybulletTable(setting, 3)) as table:
        truth = table.truth()
        seen = perceive([table.observe()], setting, np.random.default_rng(1))
    assert truth.on_table == truth.total == 500
    assert sum(area.covered for area in seen.areas) == pytest.approx(500 * np.pi * 0.003**2, rel=0.25)
