"""Tool paths against §3.2: where a stroke starts, leads and ends, and how the tool stands."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import atan2, cos, hypot, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.geometry.ellipse import Ellipse, boundary, farthest, nearest
from cleancli.motion import actions, corners
from cleancli.motion.actions import SKILLS, NoSkill, can_execute, tool_path
from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.scene.grasps import WIDE
from cleancli.scene.model import (
    CameraSetup,
    Container,
    Rag,
    Scene,
    Surface,
    SymbolThresholds,
)
from cleancli.scene.robots import ARMS

CLEANING = ("moveToContainerFast", "moveToContainerStraight", "sweep1", "sweep2", "sweep3")
SCENE = Scene(
    name="bare",
    surface=Surface(0.9, 0.7, 0.45, (205, 198, 184)),
    container=Container("east", 0.0, 0.32, 0.16),
    robot="gantry",
    rag=Rag(WIDE, 0.12),
    camera=CameraSetup(0.9, 640, 480, 525),
    dirt=(),
    symbols=SymbolThresholds(0.035, 0.05, 0.10, 0.3, 0.2, 0.06),
    seed=1,
)
EDGES = {"north": (0, 1), "east": (1, 0), "south": (0, -1), "west": (-1, 0)}

ellipses = st.builds(
    lambda x, y, longer, share, angle: Ellipse((x, y), (longer, share * longer), angle),
    st.floats(-0.35, 0.35),
    st.floats(-0.25, 0.25),
    st.floats(0.005, 0.08),
    st.floats(0.2, 1.0),
    st.floats(-1.57, 1.57),
)
scenes = st.builds(
    lambda edge, offset: replace(SCENE, container=replace(SCENE.container, edge=edge, offset=offset)),
    st.sampled_from(sorted(EDGES)),
    st.floats(-0.1, 0.1),
)


def contact(path: ToolPath) -> tuple[Waypoint, ...]:
    return tuple(point for point in path.waypoints if point.z == 0)


def passes(path: ToolPath, point: tuple[float, float]) -> bool:
    """Whether the stroke goes within a millimetre of a point."""
    stroke = np.array([(w.x, w.y) for w in contact(path)])
    for begin, end in pairwise(stroke):
        step = end - begin
        share = np.clip((point - begin) @ step / max(step @ step, 1e-12), 0, 1)
        if np.linalg.norm(begin + share * step - point) < 2e-3:
            return True
    return False


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(sorted(SKILLS)), st.tuples(ellipses, ellipses, ellipses), scenes)
def test_every_path_comes_down_straight_and_ends_lifted(
    action: str, areas: tuple[Ellipse, ...], scene: Scene
) -> None:
    path = tool_path(action, areas[: SKILLS[action].arity], scene)
    above, down, *_, last, lifted = path.waypoints
    assert above.z > 0.02
    assert lifted.z > 0.02
    assert (above.x, above.y, above.yaw) == (down.x, down.y, down.yaw)
    assert (last.x, last.y) == (lifted.x, lifted.y)
    assert abs(down.x) < scene.surface.width / 2
    assert abs(down.y) < scene.surface.depth / 2
    assert all(w.z == 0 for w in path.waypoints[1:-1])


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(sorted(SKILLS)), st.tuples(ellipses, ellipses, ellipses), scenes)
def test_the_tool_is_perpendicular_to_the_motion_but_for_its_turns(
    action: str, areas: tuple[Ellipse, ...], scene: Scene
) -> None:
    stroke = contact(tool_path(action, areas[: SKILLS[action].arity], scene))
    for begin, end in pairwise(stroke):
        length = hypot(end.x - begin.x, end.y - begin.y)
        if length < 1e-6:
            continue
        if begin.yaw == end.yaw:
            heading = atan2(end.y - begin.y, end.x - begin.x)
            assert cos(heading - begin.yaw) == pytest.approx(1, abs=1e-6)
        else:
            assert length <= corners.TURN_STRETCH + 1e-9


@settings(max_examples=40, deadline=None)
@given(ellipses, ellipses)
def test_a_join_comes_down_behind_the_first_ellipse_and_passes_the_stated_points(
    one: Ellipse, other: Ellipse
) -> None:
    path = tool_path("join2", (one, other), SCENE)
    start = contact(path)[0]
    forward = np.array((cos(start.yaw), sin(start.yaw)))
    first = farthest(one, other)
    assert hypot(start.x - first[0], start.y - first[1]) == pytest.approx(corners.CLEARANCE, abs=1e-9)
    assert np.array((start.x, start.y)) @ forward < np.array(first) @ forward
    for point in nearest(one, other):
        assert passes(path, point)
    assert (contact(path)[-1].x, contact(path)[-1].y) == pytest.approx(nearest(one, other)[1], abs=1.1e-3)


def test_joining_three_goes_on_to_the_third_without_lifting() -> None:
    one, two, three = (Ellipse(c, (0.03, 0.02), 0.5) for c in ((-0.3, 0.0), (0.0, 0.1), (0.1, -0.2)))
    path = tool_path("join3", (one, two, three), SCENE)
    for point in (*nearest(one, two), *nearest(two, three)):
        assert passes(path, point)
    assert sum(w.z > 0 for w in path.waypoints) == 2


def test_a_sweep_goes_over_its_areas_and_into_the_container_without_lifting() -> None:
    areas = tuple(Ellipse((x, y), (0.02, 0.01), 0.3) for x, y in ((-0.3, 0.1), (-0.1, 0.05), (0.1, 0.1)))
    path = tool_path("sweep3", areas, SCENE)
    stroke = np.array([(w.x, w.y) for w in contact(path)])
    assert [w.z > 0 for w in path.waypoints] == [True, *(False,) * len(stroke), True]
    assert stroke[0][0] < -0.32, "it comes down behind the first"
    for area in areas:
        assert distance_to(stroke, area.centre) < 0.01
    assert stroke[-1][0] > 0.45, "it ends past the edge"


def distance_to(corners: np.ndarray, point: tuple[float, float]) -> float:
    """Metres from a point to a way."""
    fine = np.concatenate([np.linspace(a, b, 200) for a, b in pairwise(corners)])
    return float(np.linalg.norm(fine - point, axis=1).min())


def test_scattered_dirt_is_grouped_from_the_end_of_its_longer_axis_to_its_middle() -> None:
    path = tool_path("groupScattered", (Ellipse((-0.1, 0.05), (0.12, 0.05), 0.0),), SCENE)
    start, end = contact(path)
    assert (start.x, start.y) == pytest.approx((-0.22 - corners.CLEARANCE, 0.05), abs=1e-9)
    assert (end.x, end.y) == pytest.approx((-0.1, 0.05))


@settings(max_examples=120, deadline=None)
@given(st.sampled_from(CLEANING), st.tuples(ellipses, ellipses, ellipses), scenes)
def test_a_push_to_the_container_keeps_the_rag_within_the_mouth(
    action: str, areas: tuple[Ellipse, ...], scene: Scene
) -> None:
    out = np.array(EDGES[scene.container.edge])
    along = np.abs(out[::-1])
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    edge = float(np.abs(out) @ half)
    *_, before, end = contact(tool_path(action, areas[: SKILLS[action].arity], scene))
    begin, finish = np.array((before.x, before.y)), np.array((end.x, end.y))
    ends = np.array((-sin(end.yaw), cos(end.yaw))) * scene.rag.width / 2
    assert min((finish + ends) @ out, (finish - ends) @ out) > edge, "the whole rag is past the edge"
    for corner in (ends, -ends):
        # Where this end of the rag crosses the edge.
        share = (edge - (begin + corner) @ out) / ((finish - begin) @ out)
        place = (begin + corner + share * (finish - begin)) @ along
        assert abs(place - scene.container.offset) <= scene.container.width / 2 + 1e-3


@settings(max_examples=40, deadline=None)
@given(ellipses, scenes)
def test_a_push_to_the_container_starts_behind_the_dirt(area: Ellipse, scene: Scene) -> None:
    start = contact(tool_path("moveToContainerFast", (area,), scene))[0]
    forward = np.array((cos(start.yaw), sin(start.yaw)))
    offset = np.array((start.x, start.y)) - np.array(area.centre)
    behind = -((boundary(area) - area.centre) @ forward).min() + corners.CLEARANCE
    assert 0 < -offset @ forward <= behind + 1e-4
    if max(abs(start.x) - scene.surface.width / 2, abs(start.y) - scene.surface.depth / 2) < -0.006:
        assert -offset @ forward == pytest.approx(behind, abs=1e-3)
        assert forward[::-1] * (1, -1) @ offset == pytest.approx(0, abs=1e-6), "over its middle"


def test_dirt_beside_the_mouth_is_taken_round_a_corner_in_front_of_it() -> None:
    """At the nearest place of the mouth, |y| <= 0.16, that has room for the rag, which is 12 cm wide."""
    path = tool_path("moveToContainerStraight", (Ellipse((0.42, 0.3), (0.02, 0.02), 0.0),), SCENE)
    end = contact(path)[-1]
    assert end.yaw == pytest.approx(0)
    assert (end.x, end.y) == pytest.approx((0.45 + actions.OVERSHOOT, 0.1))


def test_fast_and_straight_differ_in_speed_and_interpolation_alone() -> None:
    area = (Ellipse((-0.2, 0.1), (0.04, 0.02), 0.3),)
    fast, straight = (
        tool_path(action, area, SCENE) for action in ("moveToContainerFast", "moveToContainerStraight")
    )
    assert fast.interpolation is Interpolation.JOINT
    assert straight.interpolation is Interpolation.STRAIGHT
    assert [replace(w, speed=0) for w in fast.waypoints] == [replace(w, speed=0) for w in straight.waypoints]
    assert max(w.speed for w in contact(fast)) == 0.20
    assert max(w.speed for w in contact(straight)) == 0.12


def test_picking_up_takes_two_arms() -> None:
    assert not can_execute("pickUp", 1, ARMS["wam"])
    assert can_execute("pickUp", 1, ARMS["reem"])
    for number in (2, 3):
        assert can_execute(f"pickUp{number}", number, ARMS["reem"])
        assert not can_execute(f"pickUp{number}", number, ARMS["wam"])
        assert not can_execute(f"pickUp{number}", 1, ARMS["reem"])
    assert not can_execute("join2", 3, ARMS["gantry"])
    assert can_execute("join2", 2, ARMS["gantry"])
    with pytest.raises(NoSkill, match="pickUp/1"):
        tool_path("pickUp", (Ellipse((0, 0), (0.1, 0.1), 0),), SCENE)


@given(ellipses, scenes)
def test_a_sweep_of_one_area_is_a_fast_push_in_straight_lines(area: Ellipse, setting: Scene) -> None:
    """docs/world.md; so that it does not bow on an arm."""
    push, sweep = (tool_path(name, (area,), setting) for name in ("moveToContainerFast", "sweep1"))
    assert sweep.waypoints == push.waypoints
    assert (push.interpolation, sweep.interpolation) == (Interpolation.JOINT, Interpolation.STRAIGHT)
