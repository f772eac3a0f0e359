"""Of the many ways of an arm one is taken that begins near its joints; all parts of it are checked."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion import joint_path
from cleancli.motion.actions import tool_path
from cleancli.motion.arm import Arm, everywhere, poses
from cleancli.motion.clearance import clear
from cleancli.motion.joint_path import nearest_pose, stroke, through_air
from cleancli.motion.legs import legs
from cleancli.motion.path import Interpolation, ToolPath
from cleancli.world.robots.wam import BUILD, arm_for
from support.tables import PAPER

_Array = NDArray[np.float64]
REST = np.array(BUILD.rest)


@pytest.fixture(scope="module")
def arm() -> Arm:
    return arm_for(PAPER)


def seconds(arm: Arm, begin: _Array, end: _Array) -> _Array:
    """The shortest time between joints at full speed."""
    taken: _Array = (np.abs(end - begin) / np.array(arm.speed)).max(axis=-1)
    return taken


def beginning(arm: Arm, path: ToolPath, how: Interpolation, here: _Array) -> _Array:
    first: _Array = stroke(arm, legs(path.waypoints, np.zeros(4)), how, here, 1)[0][0]
    return first


@pytest.mark.parametrize("how", list(Interpolation))
@pytest.mark.parametrize(("x", "y"), [(0.1, 0.15), (0.1, -0.15)])
def test_a_stroke_begins_near_where_the_arm_is(arm: Arm, how: Interpolation, x: float, y: float) -> None:
    path = tool_path("moveToContainerStraight", (Ellipse((x, y), (0.03, 0.02), 0.4),), PAPER)
    usual = beginning(arm, path, how, REST)
    above = legs(path.waypoints, np.zeros(4))[0].points[:1]
    found = everywhere(arm, poses(above, np.zeros(1)))[0].reshape(-1, 7)
    found = found[np.isfinite(found).all(axis=1)]
    found = found[clear(arm, found)]
    for here in found[np.argsort(-seconds(arm, usual, found), kind="stable")][:3]:
        there = beginning(arm, path, how, here)
        assert seconds(arm, here, there) < seconds(arm, here, usual)


@pytest.mark.parametrize("half", [0, 1], ids=["first half", "second half"])
def test_both_halves_of_a_raised_way_are_looked_at(
    arm: Arm, half: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The straight way is blocked, and then one half of the way over a raised middle: neither is gone."""
    begin, end = REST, nearest_pose(arm, np.array((0.1, 0.1, 0.05, 0.5)))
    obstacles = [(begin + end) / 2]

    def away(dense: _Array) -> _Array:
        found: _Array = np.min([np.abs(dense - each).max(axis=1) for each in obstacles], axis=0)
        return found

    def in_air(_: Arm, dense: _Array, *rest: object) -> NDArray[np.bool_]:
        return away(dense) > 0.1

    monkeypatch.setattr(joint_path, "_in_air", in_air)
    raised = through_air(arm, begin, end, 0.06, 1)
    assert len(raised) == 3
    obstacles.append((raised[half] + raised[half + 1]) / 2)
    around = through_air(arm, begin, end, 0.06, 1)
    np.testing.assert_array_equal(around[[0, -1]], np.stack((begin, end)))
    for first, last in pairwise(around):
        # It is looked at every 0.04 rad.
        assert away(first + np.linspace(0, 1, 200)[:, None] * (last - first)).min() > 0.1 - 0.04
