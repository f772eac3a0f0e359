"""What an arm hides stays as it was believed; what is in plain view is as it is seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse, contains, points_within
from cleancli.perception.area import Area
from cleancli.perception.occlusion import Known, find_unseen, remember
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.tracking import Stroke, track
from support import synthetic
from support.synthetic import Box

RNG = np.random.default_rng(5)
WEST = synthetic.grouped(RNG, 14, (-0.2, 0.1), 0.025)
MIDDLE = synthetic.grouped(RNG, 16, (0.0, -0.05), 0.035)
EAST = synthetic.grouped(RNG, 9, (0.25, 0.12), 0.02)
ALL = np.vstack([WEST, MIDDLE, EAST])

ARM = Box((-0.3, 0.02), (-0.1, 0.2), 0.1)
"""It stands over the western group; from above, 0.1 m up, it hides an eighth more than it covers."""
HALF = Box((-0.06, -0.12), (-0.007, 0.03), 0.02)
"""With its rim of 8 pixels it hides the western half of the middle group."""


@cache
def look(which: str, boxes: tuple[Box, ...] = (), seed: int = 1) -> Observation:
    lentils = {
        "all": ALL,
        "without west": np.vstack([MIDDLE, EAST]),
        "without east": np.vstack([WEST, MIDDLE]),
    }
    frames = [synthetic.frame(lentils[which], seed + n, boxes=boxes) for n in range(3)]
    return perceive(frames, synthetic.scene(), np.random.default_rng(0))


def before() -> tuple[Area, ...]:
    return track((), look("all", seed=9).areas, None, 1).areas


def known(observation: Observation, areas: Sequence[Area], stroke: Stroke | None = None) -> Known:
    return remember(areas, observation, synthetic.scene().surface, stroke, 4)


def test_with_nothing_in_front_it_is_what_tracking_says() -> None:
    seen = known(look("all"), before())
    assert seen.areas == track(before(), look("all").areas, None, 4).areas
    assert seen.hidden == {"a1": 0, "a2": 0, "a3": 0}
    assert seen.unseen.share < 0.001
    assert seen.unseen.outlines() == ()


def test_what_is_hidden_stays_as_it_was_believed() -> None:
    seen = known(look("all", (ARM,)), before())
    assert [area.name for area in seen.areas] == ["a1", "a2", "a3"]
    assert seen.areas[0] == before()[0]
    assert seen.hidden == {"a1": 1.0, "a2": 0.0, "a3": 0.0}


def test_hidden_or_not_what_is_gone_from_plain_view_is_gone() -> None:
    seen = known(look("without east", (ARM,)), before())
    assert [area.name for area in seen.areas] == ["a1", "a2"]


def test_what_was_taken_away_behind_the_arm_is_believed_until_it_can_be_seen() -> None:
    behind = known(look("without west", (ARM,)), before())
    assert [area.name for area in behind.areas] == ["a1", "a2", "a3"]
    assert [area.name for area in known(look("without west"), behind.areas).areas] == ["a2", "a3"]


def test_an_area_hidden_in_part_keeps_its_name_its_place_and_its_dirt() -> None:
    observation = look("all", (HALF,))
    seen = known(observation, before())
    middle, was = seen.areas[1], before()[1]
    assert middle.name == "a2"
    assert 0.3 < seen.hidden["a2"] < 0.7
    assert middle.ellipse.centre == pytest.approx(was.ellipse.centre, abs=0.006)
    assert middle.ellipse.axes == pytest.approx(was.ellipse.axes, rel=0.2)
    assert middle.covered == pytest.approx(was.covered, rel=0.25)
    fragment = min(observation.areas, key=lambda area: abs(area.ellipse.centre[0]))
    assert fragment.covered < 0.8 * was.covered


def test_believing_again_and_again_adds_nothing() -> None:
    areas = before()
    for seed in range(2, 12):
        areas = known(look("all", (HALF,), seed), areas).areas
    assert areas[1] == before()[1]


def test_what_has_grown_in_plain_view_has_grown() -> None:
    was = [replace(area, ellipse=Ellipse((-0.005, -0.05), (0.036, 0.012), 0.0)) for area in before()[1:2]]
    seen = known(look("all", (HALF,)), was)
    middle = next(area for area in seen.areas if area.name == "a2")
    assert contains(middle.ellipse, MIDDLE[MIDDLE[:, 0] > 0]).all()
    assert middle.covered > was[0].covered


def test_what_has_shrunk_in_plain_view_has_shrunk() -> None:
    was = tuple(replace(area, covered=4 * area.covered) for area in before())
    middle = known(look("all", (HALF,)), was).areas[1]
    assert middle.name == "a2"
    assert middle.covered < 0.8 * was[1].covered


def test_of_an_area_whose_larger_part_is_clean_in_plain_view_nothing_is_believed() -> None:
    edge = Box((-0.3, 0.0), (-0.212, 0.2), 0.02)
    observation = look("without west", (edge,))
    share = find_unseen(observation, synthetic.scene().surface).share_of(before()[0].ellipse)
    assert 0.1 < share < 0.5
    assert [area.name for area in known(observation, before()).areas] == ["a2", "a3"]


def test_what_was_pushed_away_is_not_believed_where_it_lay() -> None:
    pushed = Stroke(("a1",), ((-0.25, 0.1), (0.1, 0.1)), 0.06)
    assert [a.name for a in known(look("without west", (ARM,)), before(), pushed).areas] == ["a2", "a3"]
    target = Stroke(("a2", "a1"), ((-0.1, 0.05), (-0.2, 0.1)), 0.06)
    assert [a.name for a in known(look("without west", (ARM,)), before(), target).areas] == ["a1", "a2", "a3"]


def test_the_unseen_part_lies_behind_the_arm() -> None:
    """The camera is 0.9 m above the table and 0.8 m above the box: what it hides is 9/8 as far out."""
    unseen = find_unseen(look("all", (ARM,)), synthetic.scene().surface)
    (outline,) = unseen.outlines()
    low, high = np.min(outline, axis=0), np.max(outline, axis=0)
    margin = 4 * 0.9 / 525 + 0.005
    assert low == pytest.approx(np.array(ARM.low) * 9 / 8 - margin, abs=0.008)
    assert high == pytest.approx(np.array(ARM.high) * 9 / 8 + margin, abs=0.012)
    assert unseen.share == pytest.approx(look("all", (ARM,)).hidden, abs=0.01)
    assert unseen.at(np.array([[-0.2, 0.1], [0.2, -0.1]])).tolist() == [True, False]


@pytest.mark.parametrize("boxes", [(ARM, HALF), (HALF, ARM)])
def test_the_largest_unseen_part_is_told_first(boxes: tuple[Box, ...]) -> None:
    outlines = find_unseen(look("all", boxes), synthetic.scene().surface).outlines()
    extents = [np.ptp(outline, axis=0).prod() for outline in outlines]
    assert len(extents) == 2
    assert extents[0] > 2 * extents[1]


def test_outside_the_image_nothing_is_seen() -> None:
    surface = synthetic.scene().surface
    camera = synthetic.camera()
    pose = camera.pose.copy()
    pose[0, 3] = 0.4
    unseen = find_unseen(replace(look("all"), camera=replace(camera, pose=pose)), surface)
    seen_from = 0.4 - 320 / 525 * 0.9
    assert unseen.share == pytest.approx((seen_from + 0.44) / 0.88, abs=0.01)
    assert unseen.at(np.array([[-0.45, 0.3], [0.45, 0.3]])).tolist() == [True, False]


def test_points_within_an_ellipse_are_spread_evenly() -> None:
    ellipse = Ellipse((0.3, -0.2), (0.1, 0.03), 0.7)
    points = points_within(ellipse)
    assert contains(ellipse, points).all()
    assert points.mean(axis=0) == pytest.approx(ellipse.centre, abs=1e-3)
    # The variance of a uniform ellipse along its axis is a quarter of the half length squared.
    along = (points - ellipse.centre) @ (np.cos(0.7), np.sin(0.7))
    assert along.std() == pytest.approx(0.05, rel=0.03)
