"""What docs/world.md promises of every robot's motions, of its tool, and of where it stands."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path
from cleancli.motion.pace import LIFT
from cleancli.motion.path import ToolPath
from cleancli.scene.model import Scene
from cleancli.world import constants as par
from cleancli.world.robots import constants, reem, wam
from cleancli.world.robots.registry import ROBOTS
from cleancli.world.table import PybulletTable
from support.tables import scene

SPEEDS = {
    "gantry": constants.JOINT_SPEED,
    "wam": constants.WAM_SPEED,
    "reem": constants.REEM_SPEED * 2,
}
EDGES = ("north", "east", "south", "west")
OFFSET = np.array((0.004, -0.003, 0.001, 0.02))


def small(robot: str, edge: str = "north") -> Scene:
    """A table that all robots reach, across which a push towards the north has a quarter turn of yaw."""
    return scene(edge=edge, robot=robot, size=(0.50, 0.40))


@contextmanager
def pushing(robot: str) -> Iterator[tuple[PybulletTable, ToolPath]]:
    setting = small(robot)
    path = tool_path("moveToContainerStraight", (Ellipse((0.0, 0.02), (0.02, 0.02), 0.0),), setting)
    with PybulletTable(setting, 1) as table:
        yield table, path


def down(table: PybulletTable, path: ToolPath) -> None:
    """Begin a push, and stop in its midst: the tool is on the surface and moves."""
    table.start(path)
    while table.tool[2] > LIFT / 10:
        table.poll()
    for _ in range(10):
        table.poll()
    assert not table.failure


@pytest.mark.parametrize("robot", sorted(ROBOTS))
def test_motions_begin_where_the_joints_are_and_never_jump(robot: str) -> None:
    """Whatever the error of the tool, no joint is told to move faster than it can. A robot that is stopped
    raises its tool straight up."""
    with pushing(robot) as (table, path):
        drive = table._drive
        motions = [np.vstack((drive.commanded(), drive.follow(path, OFFSET)))]
        down(table, path)
        x, y, z, yaw = drive.tool()
        motions.append(np.vstack((drive.commanded(), drive.lift())))
        table.stop()
        raised = drive.tool()
        motions.append(np.vstack((drive.commanded(), drive.withdraw())))
    for motion in motions:
        assert len(motion) > 50
        assert (np.abs(np.diff(motion, axis=0)) <= np.array(SPEEDS[robot]) * par.STEP * 1.001).all()
    assert z < LIFT / 10
    assert yaw > 1
    assert raised == pytest.approx((x, y, LIFT, yaw), abs=1e-3)


def test_the_cloth_hangs_from_a_bar_and_the_bar_from_a_post() -> None:
    """Seen by the cameras: one stands on the other, up to the post's height above them."""
    with pushing("gantry") as (table, _):
        engine, body = table._engine, table._drive._body  # type: ignore[attr-defined]
        shapes = [(each[1], each[3], each[5]) for each in engine.getVisualShapeData(body)]
    (bar, post), flaps = [each for each in shapes if each[0] == 3], [each for each in shapes if each[0] > 3]
    ends = [(middle[2] - size[2] / 2, middle[2] + size[2] / 2) for _, size, middle in (bar, post)]
    assert ends[0] == pytest.approx((par.FLAP_HEIGHT, par.FLAP_HEIGHT + par.HOLDER_SIZE[1]))
    assert ends[1] == pytest.approx((ends[0][1], ends[0][1] + par.POST_HEIGHT))
    assert (bar[1][0], *post[1][:2]) == pytest.approx((par.HOLDER_SIZE[0], *[2 * par.POST_RADIUS] * 2))
    assert bar[1][1] == pytest.approx(small("gantry").rag.width)
    assert sum(size[1] for _, size, _ in flaps) == pytest.approx(0.96 * bar[1][1])


@pytest.mark.parametrize("edge", EDGES)
def test_the_shoulders_of_reem_stand_above_the_containers_edge(edge: str) -> None:
    """40 cm apart, 40 cm above the surface; right and left as the robot sees them, over the container."""
    setting = small("reem", edge)
    right, left = (np.array(reem.arm_for(setting, side).base)[:3, 3] for side in (1, -1))
    out = np.array((*setting.outwards(), 0.0))
    half = 0.25 if edge in ("east", "west") else 0.20
    assert (right + left) / 2 == pytest.approx(half * out + (0, 0, 0.40))
    assert right - left == pytest.approx(0.40 * np.cross(-out, (0, 0, 1)))


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize(("size", "beside"), [((0.60, 0.55), 0.53), ((0.90, 0.90), 0.65)])
def test_the_shoulder_of_the_wam_stands_beside_the_surface(
    edge: str, size: tuple[float, float], beside: float
) -> None:
    """53 cm from its middle, or 20 cm from the edge of a deeper table; 5 cm back from the container."""
    setting = scene(edge=edge, robot="wam", size=size)
    shoulder = np.array(wam.arm_for(setting).base)[:3, 3]
    out = np.array((*setting.outwards(), 0.0))
    left = np.cross((0, 0, 1), out)
    assert shoulder == pytest.approx(beside * left - 0.05 * out + (0, 0, 0.30))
