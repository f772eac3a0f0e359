"""The tool and the arm in the camera's view: what they hide is still known, and known to be hidden."""

from __future__ import annotations

import numpy as np
import pytest

from cleancli.motion.actions import tool_path
from cleancli.perception.area import Area
from cleancli.perception.occlusion import Known, remember
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.tracking import track
from cleancli.scene.model import Group, Scene
from cleancli.world.robot import Status, finish
from cleancli.world.table import PybulletTable
from support.tables import scene

GROUPS = (Group(9, (-0.2, 0.1), 0.03), Group(9, (0.0, -0.1), 0.03), Group(9, (0.2, 0.15), 0.03))


def observed(table: PybulletTable, scene: Scene) -> Observation:
    return perceive([table.observe() for _ in range(3)], scene, np.random.default_rng(1))


@pytest.mark.parametrize("robot", ["gantry", "wam"])
def test_through_a_whole_push_no_area_is_lost_or_invented_behind_the_tool(robot: str) -> None:
    """The middle group is pushed away; looks at every 0.8 s of it, with whatever hides what."""
    setting = scene(*GROUPS, robot=robot)
    with PybulletTable(setting, 1) as table:
        table.withdraw()
        finish(table)
        areas = track((), observed(table, setting).areas, None, 1).areas
        assert len(areas) == 3
        still = [area for area in areas if area.name != "a2"]
        table.start(tool_path("moveToContainerStraight", (areas[1].ellipse,), setting))
        looks: list[Known] = []
        while table.poll() is Status.RUNNING:
            if table.clock // 0.8 > len(looks):
                looks.append(_look(table, setting, areas))
                areas = looks[-1].areas
    assert max(look.unseen.share for look in looks) > 0.02
    assert any(share > 0 for look in looks for share in look.hidden.values())
    for look in looks:
        kept = {area.name: area for area in look.areas}
        for area in still:
            assert kept[area.name].ellipse.centre == pytest.approx(area.ellipse.centre, abs=0.01)
            assert kept[area.name].covered == pytest.approx(area.covered, rel=0.4)


def _look(table: PybulletTable, scene: Scene, areas: tuple[Area, ...]) -> Known:
    observation = observed(table, scene)
    known = remember(areas, observation, scene.surface, None, 10)
    assert known.unseen.share == pytest.approx(observation.hidden, abs=0.02)
    return known
