"""Ways of the arm: straight lines that are straight, bows that bow, and neither breaks a limit."""

from __future__ import annotations

import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path
from cleancli.motion.arm import Arm, forward
from cleancli.motion.clearance import clear
from cleancli.motion.joint_path import AIR, air_course, course, nearest_pose, stroke, through_air
from cleancli.motion.legs import Leg, legs
from cleancli.motion.path import Interpolation, ToolPath, Unreachable, Waypoint
from cleancli.motion.search import way
from cleancli.motion.timing import SpeedLimits, timed
from cleancli.scene.model import Scene
from cleancli.world.robots.wam import BUILD, arm_for
from support.tables import PAPER

_Array = NDArray[np.float64]
REST = np.array(BUILD.rest)
STEP = 1 / 240


@pytest.fixture(scope="module")
def arm() -> Arm:
    return arm_for(PAPER)


def planned(arm: Arm, path: ToolPath, how: Interpolation | None = None) -> tuple[_Array, tuple[Leg, ...]]:
    """Joints (n, 7) of all legs of a path, and the legs."""
    parts = legs(path.waypoints, np.zeros(4))
    return np.concatenate(stroke(arm, parts, how or path.interpolation, REST, 1)), parts


def push(scene: Scene, x: float, y: float, action: str = "moveToContainerStraight") -> ToolPath:
    return tool_path(action, (Ellipse((x, y), (0.03, 0.02), 0.4),), scene)


def between_samples(arm: Arm, joints: _Array, parts: tuple[Leg, ...]) -> _Array:
    """(n, 3) where the tool is when the joints are driven along the timed level leg."""
    begin = 0
    for leg in parts:
        if leg.level:
            timing = timed(
                course(arm, joints[begin : begin + len(leg.points)], leg.speeds),
                SpeedLimits(arm.speed, arm.acceleration),
                STEP,
            )
            return forward(arm, timing)[:, :3, 3]
        begin += len(leg.points)
    raise AssertionError


@pytest.mark.parametrize(("x", "y"), [(-0.2, 0.1), (0.0, -0.2), (0.15, 0.05)])
def test_a_straight_push_is_straight(arm: Arm, x: float, y: float) -> None:
    path = push(PAPER, x, y)
    joints, parts = planned(arm, path)
    assert (joints >= np.array(arm.low)).all()
    assert (joints <= np.array(arm.high)).all()
    assert clear(arm, joints).all()
    tool = between_samples(arm, joints, parts)
    corners = np.array([(w.x, w.y) for w in path.waypoints if w.z == 0])
    if len(corners) == 2:
        along = (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0])
        off = (tool[:, :2] - corners[0]) @ np.array((-along[1], along[0]))
        assert np.abs(off).max() < 1e-3
    assert np.abs(tool[:, 2]).max() < 1e-3, "the rag keeps on the surface"


def test_a_fast_push_bows_and_keeps_on_the_surface(arm: Arm) -> None:
    path = push(PAPER, -0.15, 0.0, "moveToContainerFast")
    assert path.interpolation is Interpolation.JOINT
    joints, parts = planned(arm, path)
    tool = between_samples(arm, joints, parts)
    begin, end = (np.array((w.x, w.y)) for w in path.waypoints[1:3])
    np.testing.assert_allclose(tool[-1, :2], end, atol=1e-3)
    along = (end - begin) / np.linalg.norm(end - begin)
    off = np.abs((tool[:, :2] - begin) @ np.array((-along[1], along[0]))).max()
    assert 5e-3 < off < 0.2
    assert np.abs(tool[:, 2]).max() < 1e-3
    assert clear(arm, joints).all()


def test_the_bow_is_that_of_a_straight_line_between_joints(arm: Arm) -> None:
    """Where the joint-space motion happens to keep the height, nothing is corrected: so compare places."""
    path = push(PAPER, 0.1, 0.0, "moveToContainerFast")
    joints, parts = planned(arm, path)
    begin = len(parts[0].points)
    ends = joints[[begin, begin + len(parts[1].points) - 1]]
    shares = np.linspace(0, 1, 200)[:, None]
    plain = forward(arm, ends[0] + shares * (ends[1] - ends[0]))[:, :2, 3]
    driven = forward(arm, joints[begin : begin + len(parts[1].points)])[:, :2, 3]
    gaps = np.linalg.norm(driven[:, None] - plain[None], axis=2).min(axis=1)
    assert gaps.max() < 2e-3


def test_a_place_too_far_is_refused_with_its_reason(arm: Arm) -> None:
    corners = (Waypoint(-1.2, 0, 0.05, 0, 0.2), Waypoint(-1.2, 0, 0, 0, 0.1), Waypoint(-0.9, 0, 0, 0, 0.1))
    for how in Interpolation:
        with pytest.raises(Unreachable, match=r"\(-120.0 cm, 0.0 cm\): [\d.]+ cm too far"):
            stroke(arm, legs(corners, np.zeros(4)), how, REST, 1)


def test_ways_through_the_air_keep_clear_and_high(arm: Arm) -> None:
    rng = np.random.default_rng(4)
    here = REST
    for x, y, yaw in rng.uniform((-0.25, -0.25, -3), (0.25, 0.25, 3), (8, 3)):
        there = nearest_pose(arm, np.array((x, y, 0.05, yaw)))
        corners = through_air(arm, here, there, 0.06, 1)
        np.testing.assert_array_equal(corners[[0, -1]], np.stack((here, there)))
        for begin, end in pairwise(corners):
            dense = begin + np.linspace(0, 1, 200)[:, None] * (end - begin)
            assert clear(arm, dense).all()
            assert forward(arm, dense)[:, 2, 3].min() > AIR - 2e-3
            timing = timed(air_course(arm, begin, end, 0.25), SpeedLimits(arm.speed, arm.acceleration), STEP)
            speeds = np.abs(np.diff(timing, axis=0)) / STEP
            assert (speeds <= 1.02 * np.array(arm.speed)).all()
        here = there


def test_a_search_finds_a_way_around_and_gives_up_where_there_is_none() -> None:
    def may_go(begin: _Array, end: _Array) -> bool:
        points = begin + np.linspace(0, 1, 60)[:, None] * (end - begin)
        return bool((np.hypot(points[:, 0] - 0.5, points[:, 1]) > 0.3).all())

    start, goal = np.array([[0.0, 0.0]]), np.array([[1.0, 0.0]])
    wide = np.array((0.0, -1.0)), np.array((1.0, 1.0))
    found = way(wide, start, goal, may_go, 1, 2000)
    assert found is not None
    assert all(may_go(a, b) for a, b in pairwise(found))
    assert np.linalg.norm(np.diff(found, axis=0), axis=1).sum() < 2.0, "no great detour"
    np.testing.assert_array_equal(found, way(wide, start, goal, may_go, 1, 2000))
    narrow = np.array((0.0, -0.2)), np.array((1.0, 0.2))
    assert way(narrow, start, goal, may_go, 1, 300) is None


def test_the_same_path_is_planned_bit_for_bit_in_another_process() -> None:
    script = (
        "import numpy as np\n"
        "from cleancli.scene.model import *\n"
        "from cleancli.motion.joint_path import nearest_pose, stroke, through_air\n"
        "from cleancli.motion.legs import legs\n"
        "from cleancli.motion.path import Interpolation, Waypoint\n"
        "from cleancli.world.robots.wam import BUILD, arm_for\n"
        "scene = Scene('s', Surface(.6, .55, .45, (0, 0, 0)), Container('east', 0, .32, .16), 'wam',"
        " Rag('wide', .12), CameraSetup(.9, 640, 480, 525), (),"
        " SymbolThresholds(.03, .05, .1, .3, .2, .06), 1)\n"
        "arm, rest = arm_for(scene), np.array(BUILD.rest)\n"
        "corners = (-.2, .2, .05), (-.2, .2, 0), (.2, -.1, 0), (.2, -.1, .05)\n"
        "parts = legs(tuple(Waypoint(*corner, -.64, .2) for corner in corners), np.zeros(4))\n"
        "joints = np.concatenate(stroke(arm, parts, Interpolation.STRAIGHT, rest, 1))\n"
        "there = nearest_pose(arm, np.array((.2, -.2, .05, 2.5)))\n"
        "print(joints.tobytes().hex(), through_air(arm, joints[0], there, .06, 1).tobytes().hex())\n"
    )
    command = [sys.executable, "-c", script]
    first, second = (
        subprocess.run(command, capture_output=True, text=True, check=True).stdout for _ in range(2)
    )
    assert len(first) > 1000
    assert first == second
