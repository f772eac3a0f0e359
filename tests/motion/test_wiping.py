"""Wiping, against what docs/world.md says of it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import cos, sin

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.array_types import Longs, Points
from cleancli.geometry.ellipse import Ellipse, boundary, points_within
from cleancli.motion import wiping
from cleancli.motion.actions import WIPES, tool_path
from cleancli.motion.duration import expected_seconds
from cleancli.motion.path import ToolPath
from support.shipped import shipped_scene

SCENE = shipped_scene("whiteboard")
ellipses = st.builds(
    lambda x, y, long, share, angle: Ellipse((x, y), (long, long * share), angle),
    st.floats(-0.25, 0.25),
    st.floats(-0.15, 0.15),
    st.floats(0.004, 0.15),
    st.floats(0.02, 1),
    st.floats(-1.57, 1.57),
)


def times_wiped(path: ToolPath, points: Points, rag: float) -> Longs:
    """How often the rag, so wide, goes over each of points (n, 2) on pieces that it does not turn on."""
    counts = np.zeros(len(points), np.int64)
    for begin, end in pairwise([w for w in path.waypoints if w.z <= 0]):
        if begin.yaw != end.yaw:
            continue
        ahead = np.array((cos(begin.yaw), sin(begin.yaw)))
        along, reach = (points - (begin.x, begin.y)) @ ahead, (end.x - begin.x, end.y - begin.y) @ ahead
        share = along / (reach or 1e-12)
        slant = (end.x - begin.x) * -ahead[1] + (end.y - begin.y) * ahead[0]
        aside = (points - (begin.x, begin.y)) @ (-ahead[1], ahead[0]) - share * slant
        counts += (share >= 0) & (share <= 1) & (np.abs(aside) <= rag / 2)
    return counts


@settings(max_examples=60, deadline=None)
@given(st.lists(ellipses, min_size=1, max_size=3, unique=True), st.lists(ellipses, max_size=4))
def test_all_of_each_area_is_wiped_as_often_as_it_takes_and_the_rag_is_lifted_once(
    areas: list[Ellipse], others: list[Ellipse]
) -> None:
    path = tool_path(WIPES[len(areas) - 1], tuple(areas), SCENE, others)
    assert [w.z > 0 for w in path.waypoints] == [True, *(False,) * (len(path.waypoints) - 2), True]
    for area in areas:
        points = np.concatenate((points_within(area), boundary(area)[::20]))
        assert times_wiped(path, points, SCENE.rag.width).min() >= wiping.PASSES


@settings(max_examples=60, deadline=None)
@given(ellipses, st.lists(ellipses, min_size=1, max_size=6, unique=True))
def test_what_strokes_cover_the_path_wipes(area: Ellipse, others: list[Ellipse]) -> None:
    strokes, path = wiping.strokes_over(area, SCENE, others), tool_path("wipe", (area,), SCENE, others)
    for covered in strokes.covers:
        assert times_wiped(path, boundary(covered)[::20], SCENE.rag.width).min() >= wiping.PASSES


def test_strokes_are_moved_aside_to_take_a_mark_along() -> None:
    line, mark = Ellipse((0.0, 0.0), (0.15, 0.004), 0.0), Ellipse((0.05, 0.06), (0.01, 0.01), 0.0)
    (lane,) = wiping.strokes_over(line, SCENE, [mark]).lanes
    assert wiping.strokes_over(line, SCENE, [mark]).covers == {mark}
    assert lane[0][1] > 0, "towards the mark"
    ((begin, end),) = wiping.strokes_over(line, SCENE, []).lanes
    assert begin[1] == end[1] == 0, "no farther than it is worth"


def test_what_is_wider_than_the_rag_takes_several_lanes_and_what_is_narrower_one() -> None:
    widths = {short: len(wiping.strokes_over(Ellipse((0, 0), (0.2, short), 0.3), SCENE, []).lanes)
              for short in (0.01, 0.049, 0.051, 0.099, 0.101)}  # fmt: skip
    assert widths == {0.01: 1, 0.049: 1, 0.051: 2, 0.099: 2, 0.101: 3}


def test_the_rag_goes_back_without_turning_round() -> None:
    path = tool_path(
        "wipe2", (Ellipse((-0.2, 0), (0.1, 0.01), 0.0), Ellipse((0.2, 0), (0.1, 0.01), 1.5)), SCENE
    )
    yaws = [w.yaw for w in path.waypoints]
    assert yaws[0] == yaws[wiping.PASSES]
    assert all(abs(after - before) <= np.pi / 2 for before, after in pairwise(yaws))


def test_where_the_container_stands_does_not_matter() -> None:
    area = Ellipse((0.1, 0.1), (0.1, 0.03), 0.5)
    paths = {
        edge: tool_path("wipe", (area,), replace(SCENE, container=replace(SCENE.container, edge=edge)))
        for edge in ("north", "east", "south", "west")
    }
    assert len(set(paths.values())) == 1


def test_two_areas_side_by_side_take_less_time_together_than_one_after_the_other() -> None:
    one, other = Ellipse((-0.1, 0), (0.05, 0.01), 0.0), Ellipse((0.1, 0), (0.05, 0.01), 0.0)
    apart = sum(expected_seconds(tool_path("wipe", (area,), SCENE), (0.0, 0.0)) for area in (one, other))
    assert expected_seconds(tool_path("wipe2", (one, other), SCENE), (0.0, 0.0)) < apart - 1
