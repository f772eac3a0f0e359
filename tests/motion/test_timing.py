"""Timed paths against the limits they promise to keep."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.motion.legs import Leg, legs, lengths
from cleancli.motion.path import Waypoint
from cleancli.motion.timing import Course, SpeedLimits, timed

LIMITS = SpeedLimits((0.6, 0.6, 0.4, 3.0), (2.0, 2.0, 1.5, 10.0))
STEP = 1 / 240
STILL = np.zeros(4)


def course(leg: Leg) -> Course:
    return Course(leg.points, np.append(0, np.cumsum(lengths(leg.points))), leg.speeds)


def line(*poses: tuple[float, float, float, float], speed: float = 0.2) -> tuple[Leg, ...]:
    return legs(tuple(Waypoint(*pose, speed) for pose in poses), STILL)


def seconds(*poses: tuple[float, float, float, float], speed: float = 0.2) -> float:
    return sum(len(timed(course(leg), LIMITS, STEP)) for leg in line(*poses, speed=speed)) * STEP


def test_one_straight_piece_takes_as_long_as_a_trapezoid() -> None:
    assert seconds((0, 0, 0, 0), (0.6, 0, 0, 0)) == pytest.approx(0.6 / 0.2 + 0.2 / 2.0, abs=0.01)


def test_a_short_piece_never_reaches_its_speed() -> None:
    took = seconds((0, 0, 0, 0), (0.005, 0, 0, 0), speed=0.5)
    assert took == pytest.approx(2 * np.sqrt(0.005 / 2.0), abs=0.01)


def test_yaw_turns_the_shorter_way() -> None:
    (leg,) = line((0, 0, 0, 3.0), (0, 0, 0, -3.0))
    turned = timed(course(leg), LIMITS, STEP)[:, 3]
    assert np.abs(turned - np.pi).max() == pytest.approx(np.pi - 3.0, abs=1e-3)


def test_a_corner_is_passed_without_stopping_unless_the_tool_turns_back() -> None:
    def time_of(angle: float) -> float:
        turn = (0.2 + 0.2 * np.cos(angle), 0.2 * np.sin(angle), 0.0, 0.0)
        return seconds((0, 0, 0, 0), (0.2, 0, 0, 0), turn, speed=0.12)

    assert time_of(0.1) == pytest.approx(time_of(0.0), abs=0.02)
    assert time_of(1.5) == pytest.approx(time_of(0.0), abs=0.02)
    assert time_of(2.5) > time_of(0.0) + 0.05


def test_the_tool_stops_where_it_comes_down_and_runs_on_around_a_corner() -> None:
    parts = line((0, 0, 0.05, 0), (0, 0, 0, 0), (0.2, 0, 0, 0), (0.2, 0.2, 0, 0), (0.2, 0.2, 0.05, 0))
    assert [leg.level for leg in parts] == [False, True, False]
    along = timed(course(parts[1]), LIMITS, STEP)
    speeds = np.linalg.norm(np.diff(along, axis=0), axis=1) / STEP
    assert speeds[20:-20].min() > 0.05
    off = np.abs(along - np.array((0.2, 0, 0, 0))).max(axis=1).min()
    assert off < 2e-3, "a corner is rounded off by less than a lentil"


def test_the_tool_stops_between_a_slope_and_the_way_up() -> None:
    parts = line((0, 0, 0, 0), (0.1, 0, 0, 0), (0.15, 0, 0.008, 0), (0.15, 0, 0.058, 0))
    assert [leg.points[-1].tolist()[:3] for leg in parts] == [[0.1, 0, 0], [0.15, 0, 0.008], [0.15, 0, 0.058]]


def test_standing_still_takes_no_time() -> None:
    assert line((0, 0, 0, 0), (0, 0, 0, 0), (0, 0, 0, 0)) == ()
    assert len(timed(Course(np.zeros((1, 4)), np.zeros(1), np.ones(1)), LIMITS, STEP)) == 0


def test_an_offset_moves_every_pose() -> None:
    offset = np.array((0.01, -0.02, 0.003, 0.1))
    waypoints = Waypoint(0, 0, 0.05, 0, 0.2), Waypoint(0.1, 0, 0.05, 0, 0.2)
    plain, moved = legs(waypoints, STILL)[0], legs(waypoints, offset)[0]
    np.testing.assert_allclose(moved.points - plain.points, np.tile(offset, (len(plain.points), 1)))


poses = st.lists(
    st.tuples(
        st.floats(-0.5, 0.5), st.floats(-0.4, 0.4), st.sampled_from((0.0, 0.05, 0.1)), st.floats(-3, 3)
    ),
    min_size=2,
    max_size=4,
)


@settings(max_examples=20, deadline=None)
@given(poses, st.floats(0.05, 0.5))
def test_limits_hold_at_every_time_and_every_leg_is_gone_to_its_end(
    corners: list[tuple[float, float, float, float]], speed: float
) -> None:
    for leg in line(*corners, speed=speed):
        assert (lengths(leg.points) > 0).all()
        samples = timed(course(leg), LIMITS, STEP)
        np.testing.assert_allclose(samples[-1], leg.points[-1], atol=1e-6)
        path = np.concatenate((leg.points[:1], samples))
        speeds = np.diff(path, axis=0) / STEP
        assert (np.abs(speeds) <= 1.02 * np.array(LIMITS.speed)).all()
        assert (np.linalg.norm(speeds[:, :3], axis=1) <= 1.02 * speed).all()
        jumps = np.abs(np.diff(speeds, axis=0)) / STEP
        # Between the places where limits are kept a joint may pass its acceleration a little.
        assert (jumps[:-1] <= 1.3 * np.array(LIMITS.acceleration)).all()
        off = np.abs(samples[:, None] - leg.points[None]).max(axis=2).min(axis=1)
        assert off.max() <= 0.06
