"""What a robot reaches of the surface."""

from __future__ import annotations

import numpy as np

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


def test_scenes_may_name_every_robot_that_there_is() -> None:
    assert set(ARMS) == set(ROBOTS)
