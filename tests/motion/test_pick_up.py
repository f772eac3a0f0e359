"""Where the dustpan waits: docs/world.md says on which sides of the dirt, and how far from it. And how the
rag goes to it over several areas."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cleancli.geometry.ellipse import Ellipse, boundary
from cleancli.motion.actions import tool_path, tool_paths
from cleancli.motion.path import ToolPath
from cleancli.motion.pick_up import PAN_LENGTH, pick_ups
from cleancli.scene.model import Scene
from support.tables import scene

TURNS = (0.0, 30.0, 60.0, 90.0)
ACTIONS = {2: "pickUp2", 3: "pickUp3"}
LEFT = {"south": (-1, 0), "north": (1, 0), "east": (0, -1), "west": (0, 1)}


def lip(path: ToolPath, number: int = 2) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array((path.waypoints[number].x, path.waypoints[number].y))


@pytest.mark.parametrize("edge", LEFT)
def test_it_waits_on_the_left_or_else_turned_towards_the_robot(edge: str) -> None:
    setting = scene(edge=edge, robot="reem")
    paths = list(pick_ups((Ellipse((0.0, 0.0), (0.03, 0.03), 0.0),), setting))
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


@pytest.mark.parametrize("edge", LEFT)
@pytest.mark.parametrize("slant", [-1.1, -0.5, 0.5, 1.1])
def test_what_lies_aslant_is_also_swept_straight_to_the_left(edge: str, slant: float) -> None:
    """From its farthest points the dustpan may be out of reach: a streak of 4 cm was left in the middle."""
    setting, left = scene(edge=edge, robot="reem"), np.array(LEFT[edge])
    area = Ellipse((0.01, 0.0), (0.021, 0.007), slant + np.arctan2(left[1], left[0]))
    paths = list(pick_ups((area,), setting))
    ways = [lip(path) - (path.waypoints[1].x, path.waypoints[1].y) for path in paths]
    turns = [np.degrees(np.arctan2(way @ setting.outwards(), way @ left)) for way in ways]
    assert abs(turns[0]) > 10, "first from its farthest point on the right to that on the left"
    np.testing.assert_allclose(turns[1:], TURNS, atol=1e-6)
    for path, way in zip(paths, ways, strict=True):
        along = boundary(area) @ way / np.linalg.norm(way)
        down, end = (np.array((w.x, w.y)) @ way / np.linalg.norm(way) for w in path.waypoints[1:3])
        assert down < along.min() < along.max() < end


def test_it_does_not_wait_beside_the_surface() -> None:
    setting = scene(edge="south", robot="reem")
    corner = Ellipse((-0.42, -0.32), (0.03, 0.03), 0.0)
    first, *others = pick_ups((corner,), setting)
    assert first == tool_path("pickUp", (corner,), setting)
    assert all((np.abs(lip(path)) < (0.45, 0.35)).all() for path in others)
    assert len(others) < len(TURNS) - 1


@given(st.floats(-0.4, 0.4), st.floats(-0.3, 0.3), st.sampled_from(sorted(LEFT)))
def test_at_last_the_rag_alone_brings_the_dirt_nearer_to_the_middle(x: float, y: float, edge: str) -> None:
    setting, area = scene(edge=edge, robot="reem"), Ellipse((x, y), (0.03, 0.02), 0.4)
    paths = [path for path in tool_paths("pickUp", (area,), setting) if path.dustpan is None]
    if np.hypot(x, y) < 0.05:
        assert not paths, "what lies near the middle stays there"
        return
    assert len(paths) == 7
    first, last = (np.array((w.x, w.y)) for w in (paths[0].waypoints[1], paths[0].waypoints[-1]))
    assert np.linalg.norm(last) <= 0.05 < np.linalg.norm(first)


def leftward(places: list[tuple[float, float]], setting: Scene) -> tuple[Ellipse, ...]:
    """Areas at least 3 cm farther on the left than those before."""
    left = np.array(LEFT[setting.container.edge])
    apart = [left * (0.03 + abs(x)) + (y * left[1], y * left[0]) for x, y in places]
    middles = np.cumsum(apart, axis=0) - np.mean(np.cumsum(apart, axis=0), axis=0)
    return tuple(
        Ellipse((float(x), float(y)), (0.03, 0.02), 0.4 * n) for n, (x, y) in enumerate(middles, start=1)
    )


def rag_ends(path: ToolPath, setting: Scene) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """(n, 2, 2) both ends of the rag from where it comes down to the lip, closely."""
    down = [w for w in path.waypoints if w.z <= 0]
    yaws = np.unwrap([w.yaw for w in down])
    steps = np.linspace(0, len(down) - 1, 50 * len(down))
    x, y, yaw = (
        np.interp(steps, range(len(down)), of) for of in ([w.x for w in down], [w.y for w in down], yaws)
    )
    aside = setting.rag.width / 2 * np.stack((-np.sin(yaw), np.cos(yaw)), axis=1)
    middle = np.stack((x, y), axis=1)
    return np.stack((middle - aside, middle + aside), axis=1)


place = st.tuples(st.floats(0, 0.08), st.floats(-0.12, 0.12))


@given(st.sampled_from([2, 3]), st.lists(place, min_size=3, max_size=3), st.sampled_from(sorted(LEFT)))
def test_several_areas_are_swept_to_the_dustpan_beyond_the_last(
    number: int, places: list[tuple[float, float]], edge: str
) -> None:
    setting = scene(edge=edge, robot="reem")
    areas, left = leftward(places[:number], setting), np.array(LEFT[edge])
    path = tool_path(ACTIONS[number], areas, setting)
    corners = np.array([(w.x, w.y) for w in path.waypoints if w.z <= 0])
    first, second = (np.array(area.centre) for area in areas[:2])
    assert ((boundary(areas[0]) - corners[0]) @ (second - first) > 0).all(), "it comes down behind the first"
    for area in areas[1:]:
        assert np.abs(corners - area.centre).sum(axis=1).min() < 1e-9, "over its middle"
    ahead = lip(path, -3) @ left
    assert all((boundary(area) @ left < ahead - 0.009).all() for area in areas), "the lip is beyond all dirt"
    assert path.dustpan is not None
    pan = np.array((path.dustpan.place.x, path.dustpan.place.y))
    np.testing.assert_allclose(pan - lip(path, -3), PAN_LENGTH * left, atol=1e-9)
    assert (rag_ends(path, setting) @ left <= ahead + 1e-6).all(), "the rag touches it nowhere on its way"


@given(st.lists(place, min_size=3, max_size=3), st.sampled_from(sorted(LEFT)))
def test_the_dustpan_waits_nowhere_where_another_area_lies_beyond(
    places: list[tuple[float, float]], edge: str
) -> None:
    """Then the stroke would turn by more than 90 degrees before it."""
    setting = scene(edge=edge, robot="reem")
    areas = leftward(places, setting)
    for path in list(pick_ups(areas, setting))[1:]:
        assert path.dustpan is not None
        yaw = path.dustpan.place.yaw
        along = np.array([area.centre for area in areas]) @ (np.cos(yaw), np.sin(yaw))
        assert (along[:-1] < along[-1]).all()
        came = np.subtract(areas[-1].centre, areas[-2].centre)
        assert came @ (np.cos(yaw), np.sin(yaw)) > 0


def test_what_lies_apart_is_not_brought_nearer_in_one_go() -> None:
    setting = scene(edge="south", robot="reem")
    areas = tuple(Ellipse((x, 0.2), (0.03, 0.02), 0.0) for x in (0.3, 0.1))
    assert all(path.dustpan for path in tool_paths("pickUp2", areas, setting))


def test_one_area_named_several_times_is_swept_too() -> None:
    area = Ellipse((0.1, 0.0), (0.03, 0.02), 0.0)
    path = tool_path("pickUp3", (area, area, area), scene(edge="south", robot="reem"))
    assert all(np.isfinite((w.x, w.y, w.yaw)).all() for w in path.waypoints)
