"""Names keep off dirt, ways, each other and the borders; lines can be told from every colour."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
import pytest

from cleancli.array_types import Floats, Longs, Mask
from cleancli.geometry.ellipse import Ellipse
from cleancli.perception import marks
from cleancli.perception.area import Area
from cleancli.perception.labels import DIRECTIONS, DISTANCES, Box, box_of, placed
from cleancli.perception.pictures import busy, draw, outline, project
from support import synthetic

SIZE = 480, 640


def covered(box: Box, mask: Mask) -> int:
    return sum(bool(mask[y, x]) for y in range(box[1], box[3]) for x in range(box[0], box[2]))


def random_areas(seed: int, count: int) -> list[Area]:
    rng = np.random.default_rng(seed)
    return [
        Area(
            Ellipse(tuple(rng.uniform((-0.4, -0.3), (0.4, 0.3))), tuple(rng.uniform(0.005, 0.06, 2)), x),
            1e-4,
            f"a{x}",
        )
        for x in range(1, count + 1)
    ]


def around(areas: list[Area]) -> list[Longs]:
    return [outline(area.ellipse, synthetic.camera())[:, 0, :].astype(np.int64) for area in areas]


@pytest.mark.parametrize("seed", range(12))
def test_names_meet_no_dirt_no_way_and_no_other_name(seed: int) -> None:
    areas = random_areas(seed, 7)
    way = project(synthetic.camera(), np.random.default_rng(seed).uniform(-0.4, 0.4, (3, 2)))
    rng = np.random.default_rng(1000 + seed)
    dirt = rng.random(SIZE) < 2e-4
    mask = busy(SIZE, [outline(area.ellipse, synthetic.camera()) for area in areas], way, dirt)
    sizes = [tuple(rng.integers((25, 15), (60, 50))) for _ in areas]
    boxes = placed(sizes, [box_of(each) for each in around(areas)], mask)
    for box, size in zip(boxes, sizes, strict=True):
        assert (box[2] - box[0], box[3] - box[1]) == size
        assert box[0] >= 0
        assert box[1] >= 0
        assert box[2] <= SIZE[1]
        assert box[3] <= SIZE[0]
        assert covered(box, mask) == 0
    for first, second in combinations(boxes, 2):
        apart = (
            first[2] <= second[0] or second[2] <= first[0] or first[3] <= second[1] or second[3] <= first[1]
        )
        assert apart


@pytest.mark.parametrize("seed", range(6))
def test_where_there_is_no_room_a_name_covers_as_little_as_it_can(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mask, named, size = rng.random((90, 120)) < 0.3, (50, 40, 60, 50), (30, 20)
    (box,) = placed([size], [named], mask)
    found = []
    for away, (across, down) in product(DISTANCES, DIRECTIONS):
        x = {-1: 50 - away - 30, 0: 40, 1: 60 + away}[across]
        y = {-1: 40 - away - 20, 0: 35, 1: 50 + away}[down]
        x, y = min(max(x, 0), 90), min(max(y, 0), 70)
        found.append(covered((x, y, x + 30, y + 20), mask))
    assert covered(box, mask) == min(found)


def luminance(colour: Floats) -> float:
    """As WCAG 2 defines it, of sRGB."""
    linear = np.where(colour <= 10.31, colour / 255 / 12.92, ((colour / 255 + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


@pytest.mark.parametrize("paint", [marks.ELLIPSE, marks.STROKE])
def test_a_line_or_its_edge_stands_out_on_every_colour(paint: marks.Colour) -> None:
    """WCAG 2.1, 1.4.11 asks for a contrast of 3 of what is no text."""
    tones = [luminance(np.array(tone, float)) for tone in (paint, marks.EDGE)]
    for ground in product((0, 51, 102, 153, 204, 255), repeat=3):
        bright = luminance(np.array(ground, float))
        ratios = [(max(bright, tone) + 0.05) / (min(bright, tone) + 0.05) for tone in tones]
        assert max(ratios) >= 3


def test_a_line_is_light_with_a_dark_edge_on_both_sides() -> None:
    for ground in (0, 128, 255):
        picture = np.full((60, 80, 3), ground, np.uint8)
        marks.line(picture, np.array([[[10, 30]], [[70, 30]]], np.int32), marks.ELLIPSE)
        column = picture[:, 40].astype(int)
        light = np.flatnonzero((np.abs(column - marks.ELLIPSE) < 40).all(axis=1))
        assert len(light) >= 2
        for beside in (light.min() - 1, light.max() + 1):
            assert (column[beside] < 140).all()


def test_the_line_of_an_ellipse_leaves_its_dirt_to_be_seen() -> None:
    frame = synthetic.frame(np.zeros((0, 2)), 1, noise=False)
    small = Ellipse((0.05, 0.02), (0.004, 0.003), 0.3)
    picture = draw(frame, [Area(small, 1e-5, "a1")])
    x, y = project(frame.camera, np.array([small.centre]))[0]
    dirt = np.s_[round(y) - 1 : round(y) + 2, round(x) - 1 : round(x) + 2]
    np.testing.assert_array_equal(picture[dirt], frame.colour[dirt])


def test_heads_point_along_the_way() -> None:
    corners = marks.head(np.array((10.0, 20.0)), np.array((50.0, 20.0)), 10.0)[:, 0]
    assert sorted(map(tuple, corners.tolist())) == [(40, 15), (40, 25), (50, 20)]


def test_a_way_is_drawn_to_its_end() -> None:
    frame = synthetic.frame(np.zeros((0, 2)), 1, noise=False)
    stroke = np.array([(-0.2, 0.1), (0.1, 0.1)])
    picture = draw(frame, [], stroke=stroke)
    light = (np.abs(picture.astype(int) - marks.STROKE) < 40).all(axis=2)
    rows, columns = np.nonzero(light)
    (x0, y0), (x1, _) = project(frame.camera, stroke)
    assert abs(columns.min() - x0) <= 2
    assert abs(columns.max() - x1) <= 2
    assert abs(np.median(rows) - y0) <= 2
