"""What is asked too much of each robot: areas off the table, places too far, the container at each edge, a
tilted surface, very many particles. There is a result, or a motion that fails at once and says why."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import PICK_UP, can_execute, tool_path
from cleancli.perception.perceive import perceive
from cleancli.scene.model import Group, Scattered, Scene
from cleancli.scene.robots import ARMS
from cleancli.world.robot import Status, finish
from cleancli.world.robots.registry import ROBOTS
from cleancli.world.table import PybulletTable, Truth
from support.tables import scene

SIZES = {"gantry": (0.9, 0.7), "wam": (0.55, 0.55), "reem": (0.45, 0.45)}
"""Surfaces that the robots reach."""

FAR = Ellipse((-3.0, -2.0), (0.05, 0.03), 0.2)
NEARBY = Ellipse((0.0, 0.02), (0.03, 0.02), 0.4)
BESIDE_CONTAINER = 0.20  # metres from a disc's middle to the container's edge
LOW = {"gantry": 4, "wam": 4, "reem": 3}
"""Seeds whose first stroke comes down low, so that no lentil slips under the rag."""

each_robot = pytest.mark.parametrize("robot", sorted(ROBOTS))


def last_resort(robot: str) -> str:
    """The action with which a robot takes dirt off the table."""
    return PICK_UP if can_execute(PICK_UP, 1, ARMS[robot]) else "moveToContainerStraight"


def cleaned(setting: Scene, seed: int, middle: tuple[float, float]) -> Truth:
    """Where everything is after the robot was told to take the disc at `middle` off the table."""
    with closing(PybulletTable(setting, seed)) as table:
        path = tool_path(last_resort(setting.robot), (Ellipse(middle, (0.03, 0.03), 0.0),), setting)
        table.start(path)
        assert finish(table) is Status.DONE, table.failure
        return table.truth()


@each_robot
def test_areas_off_the_table_end_the_motion_or_fail_it_at_once(robot: str) -> None:
    setting = scene(edge="north", robot=robot, size=SIZES[robot])
    x, y = np.array(SIZES[robot]) / 2
    beyond, wide = Ellipse((x + 0.06, 0.1), (0.05, 0.03), 0.2), Ellipse((x / 2, y), (0.5, 0.3), 0.4)
    ends = {}
    with closing(PybulletTable(setting, 1)) as table:
        for action, areas in (
            ("moveToContainerFast", (beyond,)),
            ("moveToContainerFast", (wide,)),
            (last_resort(robot), (beyond,)),
            (last_resort(robot), (FAR,)),
            ("groupScattered", (wide,)),
            ("join2", (NEARBY, FAR)),
            ("join3", (beyond, wide, FAR)),
        ):
            clock = table.clock
            table.start(tool_path(action, areas, setting))
            ends[action, areas] = finish(table)
            failed = ends[action, areas] is Status.FAILED
            assert failed == table.failure.startswith("it can't reach (")
            assert (table.clock == clock) == failed, "what fails is not begun"
    joined = [end for (action, _), end in ends.items() if action.startswith("join")]
    assert joined == [Status.FAILED] * 2, "there is no way to an area three metres away"
    if robot == "gantry":
        assert all(end is Status.DONE for (_, areas), end in ends.items() if FAR not in areas)


@pytest.mark.parametrize("edge", ["north", "east", "south", "west"])
@pytest.mark.parametrize("robot", ["wam", "reem"])
def test_an_arm_cleans_with_the_container_at_each_edge(robot: str, edge: str) -> None:
    setting = scene(edge=edge, robot=robot, size=SIZES[robot])
    x, y = np.array(setting.outwards()) * (SIZES[robot][0] / 2 - BESIDE_CONTAINER)
    setting = replace(setting, dirt=(Group(8, (float(x), float(y)), 0.02),))
    truth = cleaned(setting, LOW[robot], (float(x), float(y)))
    assert truth.in_container >= 6
    assert truth.in_container + truth.on_table == 8


@each_robot
def test_a_tilted_table_is_cleaned_as_well(robot: str) -> None:
    setting = scene(Group(8, NEARBY.centre, 0.02), edge="south", robot=robot, size=SIZES[robot])
    tilted = replace(setting, surface=replace(setting.surface, tilt=(np.radians(4.0), np.radians(-5.0))))
    truth = cleaned(tilted, LOW[robot], NEARBY.centre)
    assert truth.in_container >= 6
    assert truth.in_container + truth.on_table == 8


@pytest.mark.parametrize("robot", ["gantry", "wam"])
def test_five_hundred_lentils_lie_and_are_seen(robot: str) -> None:
    width, depth = SIZES[robot]
    corner = 0.45 * width, 0.45 * depth
    setting = scene(Scattered(500, (-corner[0], -corner[1]), corner), robot=robot, size=SIZES[robot])
    with closing(PybulletTable(setting, 3)) as table:
        truth = table.truth()
        seen = perceive([table.observe()], setting, np.random.default_rng(1))
    assert truth.on_table == truth.total == 500
    assert sum(area.covered for area in seen.areas) == pytest.approx(500 * np.pi * 0.003**2, rel=0.25)
