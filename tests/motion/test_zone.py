"""Ways into a zone: where they begin and end, and what they take along (docs/world.md)."""

from __future__ import annotations

from dataclasses import replace
from math import cos, dist, hypot, pi, sin

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse, Point, boundary
from cleancli.motion.actions import tool_path
from cleancli.motion.zone import BESIDE, WITHIN, corners, inwards, way_in
from cleancli.scene.model import Scene, Zone
from support import synthetic

STEP = 0.004
"""Metres from which to which docs/world.md may be off: the search goes in steps."""


def table(zone: Zone | None) -> Scene:
    return replace(synthetic.scene(), zone=zone)


def drawn(seed: int) -> tuple[Scene, Ellipse, list[Ellipse]]:
    rng = np.random.default_rng(seed)
    zone = Zone(
        (float(rng.uniform(-0.2, 0.2)), float(rng.uniform(-0.15, 0.15))), 0.16, float(rng.uniform(0, 7))
    )
    found: list[Ellipse] = []
    while len(found) < 8:
        x, y, long, turn = rng.uniform((-0.38, -0.28, 0.005, -1.5), (0.38, 0.28, 0.02, 1.5)).tolist()
        area = Ellipse((x, y), (long, 0.005), turn)
        if inwards(zone, boundary(area)).max() < 0:
            found.append(area)
    return table(zone), found[0], found[1:]


def slowly_inwards(zone: Zone, point: Point) -> float:
    """By the four sides, each a line through two corners."""
    ends = corners(zone).tolist()
    gaps: list[float] = []
    for (x0, y0), (x1, y1) in zip(ends, ends[1:] + ends[:1], strict=True):
        side = hypot(x1 - x0, y1 - y0)
        gaps.append(((x1 - x0) * (point[1] - y0) - (y1 - y0) * (point[0] - x0)) / side)
    return min(gaps)


def test_how_far_within_a_zone_places_lie() -> None:
    zone = Zone((0.1, -0.2), 0.12, 0.3)
    assert dist(*corners(zone)[:2].tolist()) == pytest.approx(0.12)
    assert np.mean(corners(zone), axis=0) == pytest.approx((0.1, -0.2))
    first = corners(zone)[0] - (0.1, -0.2)
    assert np.arctan2(first[1], first[0]) == pytest.approx(pi / 4 + 0.3)
    places = np.random.default_rng(1).uniform((-0.1, -0.4), (0.3, 0.0), (200, 2))
    for place, found in zip(places.tolist(), inwards(zone, places), strict=True):
        expected = slowly_inwards(zone, (place[0], place[1]))
        assert (found >= 0) == (expected >= 0)
        if expected >= 0:
            assert found == pytest.approx(expected)


@pytest.mark.parametrize("seed", range(12))
def test_a_way_leads_straight_over_its_area_and_just_into_the_zone(seed: int) -> None:
    scene, area, others = drawn(seed)
    assert scene.zone is not None
    way = way_in(area, scene, others)
    length = dist(way.begin, way.end)
    x, y = (way.end[0] - way.begin[0]) / length, (way.end[1] - way.begin[1]) / length
    off = (area.centre[0] - way.begin[0]) * y - (area.centre[1] - way.begin[1]) * x
    assert off == pytest.approx(0, abs=1e-9), "over the middle"
    behind = min((px - way.begin[0]) * x + (py - way.begin[1]) * y for px, py in boundary(area).tolist())
    assert behind >= 0.02 - 1e-9, "the rag comes down behind all of the area"
    aside = [(px - way.begin[0]) * -y + (py - way.begin[1]) * x for px, py in boundary(area).tolist()]
    for other in way.takes:
        aside += [(px - way.begin[0]) * -y + (py - way.begin[1]) * x for px, py in boundary(other).tolist()]
    ends = [(way.end[0] - a * y, way.end[1] + a * x) for a in (min(aside), max(aside))]
    before = [(px - 2 * STEP * x, py - 2 * STEP * y) for px, py in ends]
    assert min(slowly_inwards(scene.zone, end) for end in ends) >= WITHIN - 1e-4
    assert min(slowly_inwards(scene.zone, end) for end in before) < WITHIN, "and no farther than that"


@pytest.mark.parametrize("seed", range(12))
def test_a_way_takes_along_what_lies_on_it_whole_and_comes_down_where_nothing_lies(seed: int) -> None:
    scene, area, others = drawn(seed)
    assert scene.zone is not None
    way = way_in(area, scene, others)
    length = dist(way.begin, way.end)
    x, y = (way.end[0] - way.begin[0]) / length, (way.end[1] - way.begin[1]) / length
    for other in others:
        points = boundary(other) - np.array(way.begin)
        along, aside = points @ (x, y), points @ (-y, x)
        ahead = float((np.array(other.centre) - way.begin) @ (x, y))
        lies = 0 < ahead < length and np.abs(aside).max() <= scene.symbols.traversal
        # What lies beside the zone, and no farther from its rim than where the rag stops, need not count.
        assert (other in way.takes) == lies or length - ahead < 0.05
        near = (np.abs(along) < 0.01 + BESIDE - 1e-6) & (np.abs(aside) < scene.rag.width / 2 + BESIDE - 1e-6)
        assert not near.any(), "nothing where the rag comes down"


def test_a_way_swerves_to_take_along_and_begins_farther_back_where_it_must() -> None:
    scene = table(Zone((0.2, 0.0), 0.2, 0.0))
    area = Ellipse((-0.2, 0.0), (0.01, 0.01), 0.0)
    straight = way_in(area, scene, ())
    assert abs(straight.begin[1]) < STEP
    assert straight.begin == pytest.approx((-0.23, 0.0), abs=STEP)
    assert straight.end[0] == pytest.approx(0.10 + WITHIN, abs=STEP)
    aslant = Ellipse((0.0, -0.05), (0.01, 0.01), 0.0)
    assert way_in(area, scene, [aslant]).takes == {aslant}
    right_behind = Ellipse((-0.235, 0.0), (0.01, 0.03), 0.0)
    way = way_in(area, scene, [right_behind])
    assert way.begin[0] < -0.245 - 0.01 or abs(way.begin[1]) > 0.03


def test_the_stroke_goes_the_way_and_needs_a_zone() -> None:
    area = Ellipse((-0.2, 0.05), (0.01, 0.01), 0.0)
    scene = table(Zone((0.1, 0.1), 0.12, pi / 6))
    way = way_in(area, scene, ())
    down, *_, up = tool_path("pushToZone", (area,), scene).waypoints
    assert (down.x, down.y) == pytest.approx(way.begin)
    assert (up.x, up.y) == pytest.approx(way.end)
    heading = cos(down.yaw), sin(down.yaw)
    assert heading == pytest.approx(tuple((np.array(way.end) - way.begin) / dist(way.begin, way.end)))
    with pytest.raises(ValueError, match="has no zone"):
        way_in(area, table(None), ())
