"""The points of ellipses against what geometry says of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.geometry.ellipse import (
    Ellipse,
    boundary,
    contains,
    farthest,
    major_ends,
    nearest,
    reach,
)

ellipses = st.builds(
    lambda x, y, longer, share, angle: Ellipse((x, y), (longer, share * longer), angle),
    st.floats(-0.4, 0.4),
    st.floats(-0.3, 0.3),
    st.floats(0.005, 0.15),
    st.floats(0.1, 1.0),
    st.floats(-1.57, 1.57),
)


def test_circles_face_each_other_along_the_line_of_their_middles() -> None:
    left, right = Ellipse((-0.2, 0.0), (0.05, 0.05), 0.0), Ellipse((0.1, 0.0), (0.02, 0.02), 0.3)
    assert farthest(left, right) == pytest.approx((-0.25, 0.0), abs=1e-3)
    ends = nearest(left, right)
    assert ends[0] == pytest.approx((-0.15, 0.0), abs=1e-3)
    assert ends[1] == pytest.approx((0.08, 0.0), abs=1e-3)


def test_major_ends_lie_along_the_angle() -> None:
    first, second = major_ends(Ellipse((0.1, 0.2), (0.05, 0.01), np.pi / 2))
    assert first == pytest.approx((0.1, 0.25))
    assert second == pytest.approx((0.1, 0.15))


@given(ellipses, st.floats(-np.pi, np.pi))
def test_an_ellipse_reaches_as_far_as_its_outermost_point(ellipse: Ellipse, angle: float) -> None:
    direction = np.cos(angle), np.sin(angle)
    outermost = ((boundary(ellipse) - ellipse.centre) @ direction).max()
    assert reach(ellipse, direction) == pytest.approx(outermost, abs=1e-4)


def test_an_ellipse_covered_by_the_other_is_left_from_its_middle() -> None:
    big = Ellipse((0.0, 0.0), (0.1, 0.1), 0.0)
    for x, y in ((0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02)):
        small = Ellipse((x, y), (0.01, 0.01), 0.0)
        assert farthest(small, big) == pytest.approx((1.5 * x, 1.5 * y), abs=1e-3)


@given(ellipses)
def test_boundary_points_satisfy_the_equation_of_the_ellipse(ellipse: Ellipse) -> None:
    points = boundary(ellipse) - np.array(ellipse.centre)
    along = points @ (np.cos(ellipse.angle), np.sin(ellipse.angle)) / ellipse.axes[0]
    across = points @ (-np.sin(ellipse.angle), np.cos(ellipse.angle)) / ellipse.axes[1]
    np.testing.assert_allclose(along**2 + across**2, 1, rtol=1e-9)


@settings(max_examples=30, deadline=None)
@given(ellipses, ellipses)
def test_nearest_and_farthest_points_bound_every_gap(one: Ellipse, other: Ellipse) -> None:
    first, second = nearest(one, other)
    gap = np.hypot(first[0] - second[0], first[1] - second[1])
    sample, theirs = boundary(one)[::7], boundary(other)[::7]
    gaps = np.linalg.norm(sample[:, None] - theirs[None], axis=2)
    assert gap <= gaps.min() + 1e-12
    far = np.array(farthest(one, other))
    outside = np.where(contains(other, sample), 0, gaps.min(axis=1))
    if outside.any():
        assert np.linalg.norm(boundary(other) - far, axis=1).min() >= outside.max() - 2e-3


@settings(max_examples=30, deadline=None)
@given(ellipses, ellipses)
def test_ellipses_that_overlap_share_their_nearest_point(one: Ellipse, other: Ellipse) -> None:
    first, second = nearest(one, other)
    overlap = contains(one, boundary(other)).any() or contains(other, boundary(one)).any()
    assert (first == second) == overlap


@settings(max_examples=60, deadline=None)
@given(ellipses, ellipses)
def test_points_are_those_of_a_search_over_all(first: Ellipse, second: Ellipse) -> None:
    mine, theirs = boundary(first), boundary(second)
    gaps = np.linalg.norm(mine[:, None] - theirs[None], axis=2)
    away = np.where(contains(second, mine), 0.0, gaps.min(axis=1))
    found = np.array(farthest(first, second))
    if away.any():
        there = np.linalg.norm(found - theirs, axis=1).min()
        assert there == pytest.approx(away.max(), abs=1e-7)
    if not contains(second, mine).any() and not contains(first, theirs).any():
        near, far = (np.array(point) for point in nearest(first, second))
        assert np.linalg.norm(near - far) == pytest.approx(gaps.min(), abs=1e-6)
