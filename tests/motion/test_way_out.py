"""Ways into the container against a slow search over all places of the mouth."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import cos, hypot, radians

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse, Point, boundary
from cleancli.motion.way_out import GREATEST_SLANT, WORTH, way_out
from cleancli.scene.model import Scene
from support import synthetic

OUTWARDS = {"north": (0.0, 1.0), "east": (1.0, 0.0), "south": (0.0, -1.0), "west": (-1.0, 0.0)}


def beside(area: Ellipse, begin: Point, end: Point, half: float) -> bool:
    """docs/perception.md: the middle strictly between both ends, and nothing farther beside the line."""
    x, y = end[0] - begin[0], end[1] - begin[1]
    length = hypot(x, y)
    if length == 0:
        return False
    along = ((area.centre[0] - begin[0]) * x + (area.centre[1] - begin[1]) * y) / length
    across = [((px - begin[0]) * y - (py - begin[1]) * x) / length for px, py in boundary(area)]
    return 0 < along < length and max(map(abs, across)) <= half


def slow(start: Point, scene: Scene, dirt: list[Ellipse]) -> tuple[float, set[Ellipse]]:
    """The worth of the best way, and what it takes along, as docs/world.md says it."""
    (x0, y0), (x1, y1) = scene.mouth()
    out, rag = OUTWARDS[scene.container.edge], scene.rag.width
    found = []
    for share in np.linspace(0, 1, 161):
        place = x0 + share * (x1 - x0), y0 + share * (y1 - y0)
        room = hypot(x1 - x0, y1 - y0) * min(share, 1 - share)
        far = hypot(place[0] - start[0], place[1] - start[1])
        straight = ((place[0] - start[0]) * out[0] + (place[1] - start[1]) * out[1]) / far
        corners: tuple[Point, ...] = (start, place)
        if straight < cos(radians(GREATEST_SLANT)) or room < rag / 2 / straight:
            corners = (start, (place[0] - rag * out[0], place[1] - rag * out[1]), place)
        if room < rag / 2:
            continue
        pieces = list(pairwise(corners))
        taken = {
            area for area in dirt if any(beside(area, *piece, scene.symbols.traversal) for piece in pieces)
        }
        length = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pieces)
        found.append((WORTH * len(taken) - length, taken))
    return max(found, key=lambda each: each[0])


@pytest.mark.parametrize("seed", range(20))
def test_the_way_is_the_best_of_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = synthetic.scene(str(rng.choice(list(OUTWARDS))), float(rng.uniform(-0.1, 0.1)))
    low, high = (-0.44, -0.34, 0.0, -1.5), (0.44, 0.34, 0.05, 1.5)
    drawn = rng.uniform(low, high, (int(rng.integers(0, 7)), 4)).tolist()
    dirt = [Ellipse((x, y), (long, long / 3), angle) for x, y, long, angle in drawn]
    x, y = rng.uniform((-0.44, -0.34), (0.44, 0.34))
    found = way_out((float(x), float(y)), scene, dirt)
    worth, taken = slow((float(x), float(y)), scene, dirt)
    length = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(found.corners))
    assert WORTH * len(found.takes) - length == pytest.approx(worth)
    assert found.takes == taken


def test_a_push_swerves_for_dirt_but_not_too_far() -> None:
    scene = synthetic.scene()
    alone = way_out((0.0, 0.0), scene, ())
    assert np.array(alone.corners) == pytest.approx(np.array(((0.0, 0.0), (0.45, 0.0))))
    lentil = Ellipse((0.4, 0.13), (0.003, 0.003), 0.0)
    swerved = way_out((0.0, 0.0), scene, [lentil])
    assert swerved.takes == {lentil}
    assert 0 < swerved.corners[-1][1] <= 0.10 + 1e-9
    for far in (Ellipse((0.2, 0.3), (0.003, 0.003), 0.0), Ellipse((0.4, 0.1), (0.07, 0.01), 1.5)):
        assert way_out((0.0, 0.0), scene, [far]).corners == alone.corners, "out of reach, or too long"


def test_a_rag_as_wide_as_the_mouth_goes_over_its_middle() -> None:
    scene = synthetic.scene()
    wide = replace(scene, rag=replace(scene.rag, width=0.5))
    *_, turn, crossing = way_out((-0.2, 0.2), wide, ()).corners
    assert np.array((turn, crossing)) == pytest.approx(np.array(((-0.05, 0.0), (0.45, 0.0))))
