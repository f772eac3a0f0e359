"""What is believed of an area that is hidden in part, by the shares that docs/perception.md names."""

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
from support import synthetic

HALF = 0.10
AREA = Area(Ellipse((0.0, 0.0), (HALF, HALF), 0.0), 2e-3, "a1")


@cache
def clean() -> Observation:
    return perceive([synthetic.frame(np.zeros((0, 2)), 1)], synthetic.scene(), np.random.default_rng(0))


def shown(up_to: float, *seen: Area) -> Observation:
    """The areas seen, and all that lies west of an x hidden."""
    camera = clean().camera
    x = (np.arange(camera.width) - camera.centre[0]) / camera.focal * 0.9
    mask = np.broadcast_to(x < up_to, (camera.height, camera.width)).copy()
    return replace(clean(), areas=tuple(replace(area, name="") for area in seen), hidden_mask=mask)


def west_of(share: float) -> float:
    """The x west of which this share of the area lies."""
    points = np.sort(points_within(AREA.ellipse)[:, 0])
    return float(points[round(share * (len(points) - 1))])


def known(share: float, *seen: Area) -> Known:
    observation = shown(west_of(share), *seen)
    surface = synthetic.scene().surface
    assert find_unseen(observation, surface).share_of(AREA.ellipse) == pytest.approx(share, abs=0.035)
    return remember((AREA,), observation, surface, None, 2)


def patch(x: float, half: float = 0.01, covered: float = 1.5e-3) -> Area:
    return Area(Ellipse((x, 0.0), (half, half), 0.0), covered, "")


def names(found: Known) -> Sequence[str]:
    return [area.name for area in found.areas]


@pytest.mark.parametrize(("share", "believed"), [(0.05, False), (0.44, False), (0.56, True), (1.0, True)])
def test_an_area_of_which_nothing_is_seen(share: float, believed: bool) -> None:
    found = known(share)
    assert names(found) == (["a1"] if believed else [])
    assert found.areas == ((AREA,) if believed else ())
    assert dict(found.hidden) == ({"a1": 1.0} if believed else {})


def test_what_is_hardly_hidden_is_what_is_seen() -> None:
    seen = patch(0.0, 0.05)
    found = known(0.05, seen)
    assert names(found) == ["a1"]
    assert found.areas[0].ellipse == seen.ellipse
    assert found.hidden["a1"] == 0
    assert known(0.2, seen).areas == (AREA,), "a part is hidden, so it stays as it was believed"


@pytest.mark.parametrize(("covered", "as_believed"), [(0.56e-3, True), (0.44e-3, False)])
def test_half_the_dirt_that_the_seen_part_should_show_is_enough(covered: float, as_believed: bool) -> None:
    found = known(0.5, patch(0.05, covered=covered))
    assert names(found) == ["a1"]
    assert (found.areas[0] == AREA) == as_believed
    assert found.hidden["a1"] == pytest.approx(0.5, abs=0.04)
    if not as_believed:
        assert found.areas[0].covered == pytest.approx(covered + 0.5 * AREA.covered, rel=0.05)


@pytest.mark.parametrize(("within", "as_believed"), [(0.85, True), (0.65, False)])
def test_three_quarters_of_what_is_seen_lie_in_the_ellipse_that_stays(
    within: float, as_believed: bool
) -> None:
    """A small patch at the eastern end of the ellipse, farther in or out."""
    places = np.linspace(HALF - 0.02, HALF + 0.02, 81)
    shares = [float(contains(AREA.ellipse, points_within(patch(x, 0.02).ellipse)).mean()) for x in places]
    x = float(places[np.argmin(np.abs(np.array(shares) - within))])
    found = known(0.5, patch(x, 0.02))
    assert names(found) == ["a1"]
    assert (found.areas[0] == AREA) == as_believed
    if not as_believed:
        assert contains(found.areas[0].ellipse, points_within(patch(x, 0.02).ellipse)).all()
        assert not contains(found.areas[0].ellipse, np.array([[-0.09, 0.09]])).any()


@pytest.mark.parametrize(("within", "a_part"), [(0.35, True), (0.15, False)])
def test_a_quarter_in_the_ellipse_makes_it_a_part(within: float, a_part: bool) -> None:
    places = np.linspace(HALF - 0.02, HALF + 0.03, 101)
    shares = [float(contains(AREA.ellipse, points_within(patch(x, 0.02).ellipse)).mean()) for x in places]
    x = float(places[np.argmin(np.abs(np.array(shares) - within))])
    found = known(0.6, patch(x, 0.02))
    assert names(found) == (["a1"] if a_part else ["a1", "a2"])
    if not a_part:
        assert found.areas[0] == AREA
        assert dict(found.hidden) == {"a1": 1.0, "a2": 0.0}
