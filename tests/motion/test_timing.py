"""Timed paths against the limits they promise to keep."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.motion.timing import Limits, parametrise

LIMITS = Limits((0.6, 0.6, 0.4, 3.0), (2.0, 2.0, 1.5, 10.0), 1 / 60)
poses = st.lists(
    st.tuples(st.floats(-0.5, 0.5), st.floats(-0.4, 0.4), st.floats(0, 0.1), st.floats(-3, 3)),
    min_size=2,
    max_size=7,
)


def test_one_straight_piece_is_a_trapezoid() -> None:
    path = parametrise(np.array([[0, 0, 0, 0], [0.6, 0, 0, 0]]), np.array([0.2]), LIMITS)
    assert path.duration == pytest.approx(0.6 / 0.2 + 0.2 / 2.0)
    halfway = path.poses(np.array([path.duration / 2]))
    assert halfway[0] == pytest.approx([0.3, 0, 0, 0])


def test_a_short_piece_never_reaches_its_speed() -> None:
    path = parametrise(np.array([[0, 0, 0, 0], [0.005, 0, 0, 0]]), np.array([0.5]), LIMITS)
    assert path.duration == pytest.approx(2 * np.sqrt(0.005 / 2.0))


def test_yaw_turns_the_shorter_way() -> None:
    path = parametrise(np.array([[0, 0, 0, 3.0], [0, 0, 0, -3.0]]), np.array([0.2]), LIMITS)
    turned = path.poses(np.linspace(0, path.duration, 50))[:, 3]
    assert np.abs(turned - np.pi).max() == pytest.approx(np.pi - 3.0)


def test_a_gentle_corner_is_passed_without_stopping_and_a_sharp_one_almost_stops() -> None:
    def time_of(angle: float) -> float:
        turn = [0.2 + 0.2 * np.cos(angle), 0.2 * np.sin(angle), 0, 0]
        corners = np.array([[0, 0, 0, 0], [0.2, 0, 0, 0], turn])
        return parametrise(corners, np.array([0.12, 0.12]), LIMITS).duration

    assert time_of(0.1) == pytest.approx(time_of(0.0), abs=1e-3)
    assert time_of(1.5) > time_of(0.0) + 0.02


def test_standing_still_takes_no_time() -> None:
    path = parametrise(np.zeros((3, 4)), np.array([0.1, 0.1]), LIMITS)
    assert path.duration == 0
    assert path.poses(np.array([0.0, 1.0])).tolist() == [[0, 0, 0, 0], [0, 0, 0, 0]]


def test_speeds_must_fit_the_poses() -> None:
    with pytest.raises(ValueError, match="don't fit"):
        parametrise(np.zeros((3, 4)), np.array([0.1]), LIMITS)


@settings(max_examples=60, deadline=None)
@given(poses, st.floats(0.05, 0.5))
def test_limits_hold_at_every_time_and_every_corner_is_visited(
    corners: list[tuple[float, ...]], speed: float
) -> None:
    path = parametrise(np.array(corners), np.full(len(corners) - 1, speed), LIMITS)
    if path.duration == 0:
        return
    step = 1e-3
    samples = path.poses(np.arange(0, path.duration + step, step))
    speeds = np.diff(samples, axis=0) / step
    assert (np.abs(speeds) <= np.array(LIMITS.speed) + 1e-6).all()
    assert (np.linalg.norm(speeds[:, :3], axis=1) <= speed + 1e-6).all()
    jumps = np.abs(np.diff(speeds, axis=0))
    assert (jumps <= np.array(LIMITS.acceleration) * (LIMITS.blend + 2 * step) + 1e-6).all()
    for corner in path.corners:
        reached = np.abs(samples - corner).max(axis=1).min()
        assert reached <= 3.1 * step
