"""Kinematics against a slow reference made of single turns and shifts, and against pybullet's own."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from cleancli.motion.arm import (
    BRANCHES,
    SWIVELS,
    TWISTS,
    Arm,
    costs,
    everywhere,
    forward,
    frames,
    inverse,
    poses,
    swivel_of,
    why_not,
)
from cleancli.motion.clearance import clear, segment_gaps
from cleancli.motion.joint_path import reached
from cleancli.world.robots.wam import arm_for
from support.tables import PAPER

_Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def arm() -> Arm:
    return arm_for(PAPER)


def some_joints(arm: Arm, count: int, seed: int = 1) -> _Array:
    return np.random.default_rng(seed).uniform(arm.low, arm.high, (count, 7))


def turned(axis: int, angle: float) -> _Array:
    first, second = [(1, 2), (2, 0), (0, 1)][axis]
    matrix = np.eye(4)
    matrix[first, first] = matrix[second, second] = np.cos(angle)
    matrix[first, second], matrix[second, first] = -np.sin(angle), np.sin(angle)
    return matrix


def shifted(x: float, y: float, z: float) -> _Array:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def slow_frames(arm: Arm, joints: _Array) -> list[_Array]:
    found = [np.array(arm.base)]
    for angle, a, twist, d in zip(joints, arm.offsets, TWISTS, arm.lengths, strict=True):
        found.append(found[-1] @ turned(2, angle) @ shifted(0, 0, d) @ shifted(a, 0, 0) @ turned(0, twist))
    return found


def test_forward_kinematics_is_that_of_single_turns_and_shifts(arm: Arm) -> None:
    joints = some_joints(arm, 50)
    for row, found, tool in zip(joints, frames(arm, joints), forward(arm, joints), strict=True):
        slow = slow_frames(arm, row)
        np.testing.assert_allclose(found, slow, atol=1e-12)
        np.testing.assert_allclose(tool, slow[-1] @ shifted(0, 0, arm.tool) @ turned(0, np.pi), atol=1e-12)


def test_every_solution_brings_the_tool_back_and_keeps_the_limits(arm: Arm) -> None:
    targets = forward(arm, some_joints(arm, 60))
    found = everywhere(arm, targets)
    exists = ~np.isnan(found[..., 0])
    assert exists.any(axis=(1, 2)).all(), "a pose that joints made can be reached"
    again = forward(arm, found[exists])
    wanted = np.repeat(targets, exists.reshape(len(targets), -1).sum(axis=1), axis=0)
    np.testing.assert_allclose(again, wanted, atol=1e-9)
    assert (found[exists] >= np.array(arm.low)).all()
    assert (found[exists] <= np.array(arm.high)).all()


def test_any_joints_are_found_again_by_their_swivel_and_branch(arm: Arm) -> None:
    joints = some_joints(arm, 100, seed=2)
    for row, target in zip(joints, forward(arm, joints), strict=True):
        swivel, branch = swivel_of(arm, row)
        again = inverse(arm, target[None], np.array([swivel]), branch[None])[0]
        np.testing.assert_allclose(again, row, atol=1e-6)


def test_the_swivel_moves_the_elbow_alone(arm: Arm) -> None:
    found = everywhere(arm, poses(np.array([[0.0, 0.0, 0.05, 0.3]]), np.zeros(1)))[0, :, 0]
    found = found[~np.isnan(found[:, 0])]
    carriers = frames(arm, found)
    assert np.ptp(carriers[:, 3, :3, 3], axis=0).max() > 0.1
    for still in (5, 7):
        assert np.ptp(carriers[:, still, :3, 3], axis=0).max() < 1e-9


def test_what_is_out_of_reach_says_why(arm: Arm) -> None:
    far = poses(np.array([[2.0, 0.0, 0.0, 0.0]]), np.zeros(1))
    assert np.isnan(everywhere(arm, far)).all()
    assert "too far" in why_not(arm, far[0])
    base = np.array(arm.base)[:3, 3]
    near = poses(np.array([[*(base - (0, 0, 0.16)), 0.0]]), np.zeros(1))
    assert np.isnan(everywhere(arm, near)).all()
    assert "too near" in why_not(arm, near[0])


def test_the_arm_reaches_the_area_it_was_measured_on(arm: Arm) -> None:
    grid = np.meshgrid(
        np.linspace(-0.30, 0.30, 13), np.linspace(-0.275, 0.275, 12), np.linspace(-np.pi, np.pi, 9)[:-1]
    )
    x, y, yaw = (axis.ravel() for axis in grid)
    points = np.stack((x, y, np.zeros_like(x), yaw), axis=1)
    down = [
        np.isfinite(costs(arm, everywhere(arm, poses(some, np.zeros(len(some)))))).any(axis=(1, 2))
        for some in np.array_split(points, 12)
    ]
    assert np.concatenate(down).mean() >= 0.98
    assert reached(arm, points).mean() >= 0.99


def fastest(measured: Callable[[], object]) -> float:
    """Seconds of CPU time that a call takes at least."""
    took = []
    for _ in range(50):
        began = time.process_time()
        measured()
        took.append(time.process_time() - began)
    return min(took)


def test_one_pose_costs_less_than_inverting_a_matrix_for_each_joint(arm: Arm) -> None:
    """Half as much where this was written, some two milliseconds: compared in one run, because a busy machine
    is slower in both."""
    target = poses(np.array([[0.1, 0.1, 0.0, 0.5]]), np.zeros(1))
    matrices = np.random.default_rng(1).normal(size=(len(SWIVELS) * len(BRANCHES) * 7, 4, 4))
    everywhere(arm, target)
    ratio = fastest(lambda: everywhere(arm, target)) / fastest(lambda: np.linalg.inv(matrices))
    assert ratio < 1
    assert everywhere(arm, target).shape == (1, len(SWIVELS), len(BRANCHES), 7)


def test_distances_of_segments_are_those_of_many_points_on_them() -> None:
    ends = np.random.default_rng(3).uniform(-1, 1, (2, 100, 2, 3))
    shares = np.linspace(0, 1, 101)[:, None]
    for first, second, gap in zip(*ends, segment_gaps(*ends), strict=True):
        one = first[0] + shares * (first[1] - first[0])
        other = second[0] + shares * (second[1] - second[0])
        slow = np.linalg.norm(one[:, None] - other[None], axis=2).min()
        assert gap == pytest.approx(slow, abs=0.02)
        assert gap <= slow + 1e-9


def test_links_in_the_table_or_in_each_other_are_not_clear(arm: Arm) -> None:
    comfortable = np.array(arm.posture)
    folded = comfortable.copy()
    folded[3] = 3.1
    folded[5] = -1.6
    low = comfortable.copy()
    low[1], low[3] = 2.0, 0.0
    assert clear(arm, np.stack((comfortable, folded, low))).tolist() == [True, False, False]
