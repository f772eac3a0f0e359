"""The simulated arm: it is where its kinematics say, pushes lentils, and refuses what it can't reach."""

from __future__ import annotations

from contextlib import closing

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path
from cleancli.motion.arm import everywhere, forward, frames, poses
from cleancli.motion.clearance import hull_ends, segment_gaps
from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.scene.model import Group, Scene
from cleancli.world import camera
from cleancli.world.robot import Status, finish
from cleancli.world.robots.arm_drive import TOOL, ArmDrive
from cleancli.world.robots.registry import ROBOTS
from cleancli.world.table import PybulletTable
from support.tables import in_two_processes, scene

AREA = Ellipse((0.1, 0.0), (0.02, 0.02), 0.0)


def small(edge: str = "east", robot: str = "wam") -> Scene:
    return scene(Group(12, (0.1, 0.0), 0.02), edge=edge, robot=robot, size=(0.60, 0.55))


def drive_of(table: PybulletTable) -> ArmDrive:
    drive = table._drive
    assert isinstance(drive, ArmDrive)
    return drive


def test_the_links_are_where_the_kinematics_say() -> None:
    with closing(PybulletTable(small(), 1)) as table:
        drive, engine = drive_of(table), table._engine
        arm = drive._arm
        for joints in np.random.default_rng(1).uniform(arm.low, arm.high, (10, 7)):
            for joint, angle in enumerate(joints):
                engine.resetJointState(drive._body, joint, angle)
            state = engine.getLinkState(drive._body, TOOL, computeForwardKinematics=1)
            tool = forward(arm, joints[None])[0]
            np.testing.assert_allclose(state[4], tool[:3, 3], atol=1e-6)
            turn = np.array(engine.getMatrixFromQuaternion(state[5])).reshape(3, 3)
            np.testing.assert_allclose(turn, tool[:3, :3], atol=1e-6)
            elbow = engine.getLinkState(drive._body, 3, computeForwardKinematics=1)[4]
            np.testing.assert_allclose(elbow, frames(arm, joints[None])[0, 3, :3, 3], atol=1e-6)


def test_distances_between_hulls_are_the_engines() -> None:
    with closing(PybulletTable(small(), 1)) as table:
        arm, engine = drive_of(table)._arm, table._engine
        joints = np.random.default_rng(2).uniform(arm.low, arm.high, (6, 7))
        for ends in hull_ends(arm, joints):
            bodies = []
            for hull, (begin, end) in zip(arm.hulls, ends, strict=True):
                along = (end - begin) / np.linalg.norm(end - begin)
                turn = (-along[1], along[0], 0.0, 1 + along[2]) / np.sqrt(2 * (1 + along[2]))
                shape = engine.createCollisionShape(
                    engine.GEOM_CAPSULE, radius=hull.radius, height=float(np.linalg.norm(end - begin))
                )
                bodies.append(engine.createMultiBody(0, shape, -1, ((begin + end) / 2).tolist(), turn))
            for first, second in arm.apart:
                ours = segment_gaps(ends[None, first], ends[None, second])[0]
                ours -= arm.hulls[first].radius + arm.hulls[second].radius
                points = engine.getClosestPoints(bodies[first], bodies[second], 3.0)
                assert min(point[8] for point in points) == pytest.approx(ours, abs=2e-3)
            for body in bodies:
                engine.removeBody(body)


@pytest.mark.parametrize("action", ["moveToContainerFast", "moveToContainerStraight"])
def test_most_lentils_of_a_push_end_in_the_container(action: str) -> None:
    setting = small()
    with closing(PybulletTable(setting, 4)) as table:
        table.start(tool_path(action, (AREA,), setting))
        assert finish(table) is Status.DONE
        truth = table.truth()
        assert truth.in_container >= 6
        assert truth.on_table + truth.in_container == 12
        table.withdraw()
        assert finish(table) is Status.DONE
        assert drive_of(table).stray() < 1e-3


def test_a_stopped_arm_rises_as_far_as_its_joints_let_it() -> None:
    """What is stopped is raised straight up (docs/execution.md); near its limits an arm cannot rise all the
    way."""
    rng, heights = np.random.default_rng(1), []
    with closing(PybulletTable(small(), 1)) as table:
        drive = drive_of(table)
        points = np.column_stack((rng.uniform(-0.4, 0.4, (60, 2)), np.zeros(60), rng.uniform(-3, 3, 60)))
        for point, found in zip(points, everywhere(drive._arm, poses(points, np.zeros(60))), strict=True):
            able = found.reshape(-1, 7)[np.isfinite(found.reshape(-1, 7)).all(axis=1)]
            for joints in able[:4]:
                drive.stand(joints)
                motion = drive.lift()
                assert np.isfinite(motion).all()
                tools = forward(drive._arm, np.concatenate((joints[None], motion)))[:, :3, 3]
                assert np.abs(tools[:, :2] - point[:2]).max() < 1e-3, "straight up"
                heights.append(tools[-1, 2])
    assert max(heights) > 0.04
    assert min(heights) < 0.02, "some cannot rise all the way"


@pytest.mark.parametrize("edge", ["north", "south", "west"])
def test_the_arm_stands_beside_any_edge(edge: str) -> None:
    setting = scene(edge=edge, robot="wam", size=(0.55, 0.55))
    inside = np.array([(x, y, 0.0, 1.0) for x in (-0.2, 0.0, 0.2) for y in (-0.2, 0.0, 0.2)])
    assert ROBOTS["wam"].reaches(inside, setting).all()


def test_the_resting_arm_hides_nothing_of_the_surface() -> None:
    setting = small()
    with closing(PybulletTable(setting, 1)) as table:
        eye = camera.overhead(setting.camera)
        _, depth = camera.render(table._engine, eye, setting.light)
    half = np.array((0.60, 0.55)) / 2 * setting.camera.focal / setting.camera.height
    (left, top), (right, bottom) = np.array(eye.centre) - half, np.array(eye.centre) + half
    seen = depth[int(top) + 2 : int(bottom) - 1, int(left) + 2 : int(right) - 1]
    assert seen.min() > setting.camera.height - 0.02
    assert seen.max() < setting.camera.height + 0.02


def test_a_moving_arm_hides_dirt_from_the_camera() -> None:
    setting = small()
    with closing(PybulletTable(setting, 1)) as table:
        table.start(tool_path("moveToContainerStraight", (AREA,), setting))
        while drive_of(table).tool()[2] > 0.01:
            assert table.poll() is Status.RUNNING
        _, depth = camera.render(table._engine, camera.overhead(setting.camera), setting.light)
    assert (depth < setting.camera.height - 0.2).sum() > 3000


def test_what_is_out_of_reach_fails_with_its_reason_and_nothing_moves() -> None:
    with closing(PybulletTable(small(), 1)) as table:
        corners = [(-0.9, -0.5, 0.05), (-0.9, -0.5, 0.0), (-0.5, -0.5, 0.0), (-0.5, -0.5, 0.05)]
        for how in Interpolation:
            table.start(ToolPath(tuple(Waypoint(*corner, 0.0, 0.1) for corner in corners), how))
            assert table.poll() is Status.FAILED
            assert "too far" in table.failure
            assert table.clock == 0
        table.stop()
        table.withdraw()
        assert table.poll() is not Status.FAILED
        assert table.failure == ""


def test_a_stopped_arm_raises_its_tool_and_can_go_on() -> None:
    setting = small()
    with closing(PybulletTable(setting, 1)) as table:
        drive = drive_of(table)
        table.start(tool_path("moveToContainerStraight", (AREA,), setting))
        while drive.tool()[2] > 0.005 or table.poll() is not Status.RUNNING:
            table.poll()
        table.stop()
        assert drive.tool()[2] == pytest.approx(0.05, abs=5e-3)
        table.withdraw()
        assert finish(table) is Status.DONE


def test_a_path_of_one_point_brings_the_tool_there_through_the_air() -> None:
    point = Waypoint(-0.1, 0.05, 0.06, 0.4, 0.2)
    with closing(PybulletTable(small(), 3)) as table:
        before = table.truth().positions
        table.start(ToolPath((point,), Interpolation.STRAIGHT))
        assert finish(table) is Status.DONE
        np.testing.assert_allclose(drive_of(table).tool()[:3], (point.x, point.y, point.z), atol=0.015)
        assert np.abs(table.truth().positions - before).max() < 1e-3


_TWICE = """
from cleancli.motion.actions import tool_path
from cleancli.perception.area import Ellipse
from cleancli.scene.grasps import WIDE
from cleancli.scene.model import *
from cleancli.world.robot import finish
from cleancli.world.table import PybulletTable
scene = Scene("twice", Surface(0.60, 0.55, 0.45, (205, 198, 184)), Container("east", 0.0, 0.32, 0.16), "wam",
              Rag(WIDE, 0.12), CameraSetup(0.9, 64, 48, 52.5), (Group(12, (0.15, 0.0), 0.02),),
              SymbolThresholds(0.035, 0.05, 0.10, 0.3, 0.2, 0.06), 1)
table = PybulletTable(scene, 9)
table.start(tool_path("moveToContainerStraight", (Ellipse((0.15, 0.0), (0.02, 0.02), 0.0),), scene))
finish(table)
print(table.truth().positions.tobytes().hex(), table.observe().depth.tobytes().hex(), table.clock)
"""


@pytest.mark.needs_pybullet
def test_the_same_seed_is_the_same_run_bit_for_bit_in_another_process() -> None:
    first, second = in_two_processes(_TWICE)
    assert len(first) > 1000
    assert first == second
