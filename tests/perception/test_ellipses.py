"""Ellipses: the smallest that contains, and the gap between two."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.geometry.ellipse import Ellipse, extent, gap
from cleancli.perception.areas import enclosing_ellipses

ELLIPSES = st.builds(
    lambda x, y, long, share, angle: Ellipse((x, y), (long, long * share), angle),
    st.floats(-0.4, 0.4),
    st.floats(-0.3, 0.3),
    st.floats(0.003, 0.15),
    st.floats(0.1, 1.0),
    st.floats(-1.5, 1.57),
)


def boundary(ellipse: Ellipse, count: int = 1500) -> np.ndarray:
    turns = np.linspace(0, 2 * pi, count)
    x, y = ellipse.axes[0] * np.cos(turns), ellipse.axes[1] * np.sin(turns)
    c, s = cos(ellipse.angle), sin(ellipse.angle)
    return np.column_stack([ellipse.centre[0] + c * x - s * y, ellipse.centre[1] + s * x + c * y])


def level(ellipse: Ellipse, points: np.ndarray) -> np.ndarray:
    """Below 1 inside the ellipse, 1 on it."""
    offsets = points - ellipse.centre
    c, s = cos(ellipse.angle), sin(ellipse.angle)
    along, across = offsets @ (c, s), offsets @ (-s, c)
    return np.hypot(along / ellipse.axes[0], across / ellipse.axes[1])


def test_a_rectangles_ellipse_is_root_two_larger() -> None:
    corners = np.array([(-3.0, -1.0), (3.0, -1.0), (3.0, 1.0), (-3.0, 1.0)]) / 100
    (ellipse,) = enclosing_ellipses([corners + np.array([0.2, -0.1])])
    assert ellipse.centre == pytest.approx((0.2, -0.1))
    assert ellipse.axes == pytest.approx((0.03 * sqrt(2), 0.01 * sqrt(2)), rel=1e-3)
    assert ellipse.angle == pytest.approx(0, abs=1e-6)


@settings(max_examples=40, deadline=None)
@given(ELLIPSES)
def test_points_on_an_ellipse_give_it_back(ellipse: Ellipse) -> None:
    (found,) = enclosing_ellipses([boundary(ellipse, 40)])
    assert found.centre == pytest.approx(ellipse.centre, abs=1e-3)
    assert extent(found) == pytest.approx(extent(ellipse), rel=0.03)
    assert -pi / 2 < found.angle <= pi / 2


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(3, 30))
def test_every_point_is_inside_and_the_order_does_not_matter(seed: int, count: int) -> None:
    points = np.random.default_rng(seed).normal(0, 0.03, (count, 2))
    alone, beside = enclosing_ellipses([points, points[:3]]), enclosing_ellipses([points[:3], points])
    assert level(alone[0], points).max() <= 1 + 1e-9
    assert alone[0].centre == pytest.approx(beside[1].centre)
    assert alone[0].axes[0] >= alone[0].axes[1]


@settings(max_examples=60, deadline=None)
@given(ELLIPSES, ELLIPSES)
def test_gap_is_the_least_distance_between_boundary_points(first: Ellipse, second: Ellipse) -> None:
    one, other = boundary(first, 600), boundary(second, 600)
    overlap = level(second, one).min() <= 1 or level(first, other).min() <= 1
    least = 0.0 if overlap else np.linalg.norm(one[:, None] - other[None], axis=2).min()
    assert gap(first, second) == pytest.approx(least, abs=1.5e-3)
    assert gap(first, second) == pytest.approx(gap(second, first), abs=1e-9)


def test_gap_between_circles_is_exact() -> None:
    first, second = Ellipse((0, 0), (0.03, 0.03), 0.0), Ellipse((0.3, 0.4), (0.05, 0.05), 1.0)
    assert gap(first, second) == pytest.approx(hypot(0.3, 0.4) - 0.08, abs=1e-5)
    assert gap(first, first) == 0
