"""What a robot reaches of the surface."""

from __future__ import annotations

import numpy as np
import pytest

from cleancli.recording.overlay import BORDER, SCALE, legend, overlay
from cleancli.scene.robots import ARMS
from cleancli.world.reach_map import STEP, reach
from cleancli.world.robots.registry import ROBOTS
from support.tables import scene


def test_the_gantry_reaches_every_place_and_places_cover_the_surface() -> None:
    places, reached = reach(scene())
    assert reached.all()
    assert np.abs(places).max(axis=0).tolist() == [0.45, 0.35]
    gaps = np.diff(np.unique(places[:, 0]))
    assert gaps.max() <= STEP + 1e-9


@pytest.mark.parametrize("edge", ["north", "east", "south", "west"])
def test_maps_show_the_surface_with_an_even_border(edge: str) -> None:
    here = scene(edge=edge)
    below = len(legend(here, round(0.9 * SCALE) + 2 * BORDER))
    picture = overlay(here, [("", [])])[:-below]
    rows, columns = np.nonzero((picture == 120).all(axis=2))
    high, wide = picture.shape[:2]
    ends = (rows.min(), columns.min(), high - 1 - rows.max(), wide - 1 - columns.max())
    assert ends == pytest.approx([BORDER] * 4, abs=3)
    assert (np.ptp(columns), np.ptp(rows)) == pytest.approx((0.9 * SCALE, 0.7 * SCALE), abs=1)


def test_scenes_may_name_every_robot_that_there_is() -> None:
    assert set(ARMS) == set(ROBOTS)
