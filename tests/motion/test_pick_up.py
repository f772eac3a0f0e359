"""Where the dustpan waits: docs/world.md says on which sides of the dirt, and how far from it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path, tool_paths
from cleancli.motion.path import ToolPath
from cleancli.motion.pick_up import pick_ups
from support.tables import scene

TURNS = (0.0, 30.0, 60.0, 90.0)
LEFT = {"south": (-1, 0), "north": (1, 0), "east": (0, -1), "west": (0, 1)}


def lip(path: ToolPath) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array((path.waypoints[2].x, path.waypoints[2].y))


@pytest.mark.parametrize("edge", LEFT)
def test_it_waits_on_the_left_or_else_turned_towards_the_robot(edge: str) -> None:
    setting = scene(edge=edge, robot="reem")
    paths = list(pick_ups(Ellipse((0.0, 0.0), (0.03, 0.03), 0.0), setting))
    assert paths[0] == tool_path("pickUp", (Ellipse((0.0, 0.0), (0.03, 0.03), 0.0),), setting)
    left, out = np.array(LEFT[edge]), np.array(setting.outwards())
    ways = [lip(path) for path in paths]
    turns = [np.degrees(np.arctan2(way @ out, way @ left)) for way in ways]
    np.testing.assert_allclose(turns, TURNS, atol=5)
    np.testing.assert_allclose([np.linalg.norm(way) for way in ways], 0.04, atol=1e-3)
    for path, way in zip(paths, ways, strict=True):
        first, pan = path.waypoints[1], path.dustpan
        assert pan is not None
        assert np.array((first.x, first.y)) @ way < 0, "the rag comes down on the other side"
        assert np.array((pan.place.x, pan.place.y)) @ way > way @ way, "the dustpan lies beyond its lip"


def test_it_does_not_wait_beside_the_surface() -> None:
    setting = scene(edge="south", robot="reem")
    corner = Ellipse((-0.42, -0.32), (0.03, 0.03), 0.0)
    first, *others = pick_ups(corner, setting)
    assert first == tool_path("pickUp", (corner,), setting)
    assert all((np.abs(lip(path)) < (0.45, 0.35)).all() for path in others)
    assert len(others) < len(TURNS) - 1


@given(st.floats(-0.4, 0.4), st.floats(-0.3, 0.3), st.sampled_from(sorted(LEFT)))
def test_at_last_the_rag_alone_brings_the_dirt_nearer_to_the_middle(x: float, y: float, edge: str) -> None:
    setting, area = scene(edge=edge, robot="reem"), Ellipse((x, y), (0.03, 0.02), 0.4)
    paths = [path for path in tool_paths("pickUp", (area,), setting) if path.dustpan is None]
    if np.hypot(x, y) < 0.1:
        assert not paths, "what lies near the middle stays there"
        return
    assert len(paths) == 3
    first, last = (np.array((w.x, w.y)) for w in (paths[0].waypoints[1], paths[0].waypoints[-1]))
    assert np.linalg.norm(last) <= 0.05 < np.linalg.norm(first)
