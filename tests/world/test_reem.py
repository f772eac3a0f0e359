"""Two arms: picking up takes lentils from the table into the dustpan and from there into the container."""

from __future__ import annotations

from contextlib import closing
from itertools import product

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path, tool_paths
from cleancli.motion.arm import forward
from cleancli.motion.clearance import hull_ends
from cleancli.motion.path import Interpolation, ToolPath, Unreachable, Waypoint
from cleancli.motion.pick_up import PAN_LENGTH
from cleancli.scene.model import Group, Scene
from cleancli.world.constants import PARTICLES
from cleancli.world.robot import Status, finish
from cleancli.world.robots.arm_drive import TOOL
from cleancli.world.robots.constants import PAN_GAP, PAN_HELD
from cleancli.world.robots.dustpan import plate, walls, within
from cleancli.world.robots.reem import Reem
from cleancli.world.table import PybulletTable
from support.tables import in_two_processes, scene

AREA = Ellipse((-0.02, 0.03), (0.03, 0.03), 0.0)
SIGNS = tuple(product((-1, 1), repeat=3))
LINK, DISTANCE = 3, 8  # of a contact, as the engine tells it
LOW_RAG = 3  # a seed whose first stroke comes down low, so that no lentil slips under the rag


def desk() -> Scene:
    return scene(Group(12, AREA.centre, 0.025), edge="south", robot="reem", size=(0.50, 0.40))


@pytest.mark.parametrize("edge", ["north", "east", "south", "west"])
def test_the_dustpan_waits_on_the_left_and_the_rag_comes_from_the_right(edge: str) -> None:
    path = tool_path("pickUp", (Ellipse((0, 0), (0.05, 0.05), 0),), scene(edge=edge, robot="reem"))
    left = {"south": (-1, 0), "north": (1, 0), "east": (0, -1), "west": (0, 1)}[edge]
    assert path.dustpan is not None
    first, lip = path.waypoints[1], path.waypoints[2]
    np.testing.assert_allclose((first.x, first.y), -0.07 * np.array(left), atol=1e-6)
    np.testing.assert_allclose((lip.x, lip.y), 0.06 * np.array(left), atol=1e-6)
    place = path.dustpan.place
    np.testing.assert_allclose((place.x, place.y), (0.06 + PAN_LENGTH) * np.array(left), atol=1e-6)
    assert path.waypoints[0].z > 0
    assert path.waypoints[-1].z > 0


def test_picking_up_takes_most_lentils_over_the_dustpan_into_the_container() -> None:
    setting = desk()
    most = 0
    with closing(PybulletTable(setting, LOW_RAG)) as table:
        table.start(tool_path("pickUp", (AREA,), setting))
        assert table.failure == ""
        while (status := table.poll()) is Status.RUNNING:
            if round(table.clock * 60) % 20 == 0:
                truth = table.truth()
                most = max(most, truth.in_dustpan)
                assert truth.on_table + truth.in_container + truth.in_dustpan + truth.on_floor == 12
                assert (truth.positions[:, 2] < 0.3).all()
        assert status is Status.DONE
        truth = table.truth()
    assert most >= 10
    assert truth.in_container == most, "what is on the dustpan's slope does not creep off when the rag leaves"
    assert truth.in_dustpan == 0


def test_where_the_dustpan_cannot_wait_on_the_left_it_waits_elsewhere() -> None:
    """An area of which the lip on the left would be out of the right arm's reach."""
    setting, area = desk(), Ellipse((-0.05, 0.045), (0.03, 0.025), 0.0)
    with closing(PybulletTable(setting, 1)) as table:
        first, *others = tool_paths("pickUp", (area,), setting)
        assert not table.can_follow(first)
        path = next(path for path in others if table.can_follow(path))
        table.start(path)
        assert table.failure == ""
        assert table.clock == 0.0, "asking moves nothing"


def test_two_groups_are_picked_up_in_one_go() -> None:
    places = ((0.13, 0.02), (-0.02, -0.04))
    groups = tuple(Group(8, place, 0.02) for place in places)
    setting = scene(*groups, edge="south", robot="reem", size=(0.50, 0.40))
    areas = tuple(Ellipse(place, (0.025, 0.025), 0.0) for place in places)
    with closing(PybulletTable(setting, LOW_RAG)) as table:
        table.start(tool_path("pickUp2", areas, setting))
        assert table.failure == ""
        _keep_apart(table)
        assert finish(table) is Status.DONE
        truth = table.truth()
    assert truth.in_container >= 15, "of 16"
    assert truth.on_floor == 0


def _keep_apart(table: PybulletTable) -> None:
    """Raise AssertionError where hulls of both arms come nearer than a centimetre, measured at many points of
    each, all along the motion that is under way."""
    drive, way = table._drive, table._ahead[::25]
    assert isinstance(drive, Reem)
    shares = np.linspace(0, 1, 15)[:, None]
    right, left = (
        [
            (hull.radius, ends[:, k, None, 0] + shares * (ends[:, k, None, 1] - ends[:, k, None, 0]))
            for k, hull in enumerate(arm.hulls)
        ]
        for arm, part in zip(drive._arms, np.hsplit(way, 2), strict=True)
        for ends in [hull_ends(arm, part)]
    )
    for (one, points), (other, others) in product(right, left):
        gaps = np.linalg.norm(points[:, :, None] - others[:, None], axis=-1)
        assert gaps.min() > one + other + 0.01 - 1e-4


def test_where_the_arms_would_touch_on_a_stroke_over_two_areas_nothing_moves() -> None:
    areas = tuple(Ellipse(place, (0.026, 0.026), 0.0) for place in ((0.09, 0.12), (0.07, -0.10)))
    with closing(PybulletTable(desk(), 1)) as table:
        table.start(tool_path("pickUp2", areas, desk()))
        assert table.poll() is Status.FAILED
        assert "the arms would touch each other" in table.failure
        assert table.clock == 0.0


def test_where_two_areas_cannot_be_swept_to_the_left_the_dustpan_waits_elsewhere() -> None:
    setting = desk()
    areas = tuple(Ellipse(place, (0.025, 0.025), 0.0) for place in ((0.05, 0.12), (-0.11, -0.08)))
    with closing(PybulletTable(setting, 1)) as table:
        first, *others = tool_paths("pickUp2", areas, setting)
        assert not table.can_follow(first, 0.0)
        assert any(table.can_follow(path) for path in others)


def test_the_lip_is_raised_while_the_rag_leaves() -> None:
    setting = desk()
    with closing(PybulletTable(setting, LOW_RAG)) as table:
        table.start(tool_path("pickUp", (AREA,), setting))
        drive, way = table._drive, table._ahead
        assert isinstance(drive, Reem)
        rag, pan = (forward(arm, part) for arm, part in zip(drive._arms, np.hsplit(way, 2), strict=True))
    moves = np.diff(way, axis=0)
    (both,) = np.nonzero(moves[:, :7].any(axis=1) & moves[:, 7:].any(axis=1))
    begin, end = both[0], both[-1] + 1
    assert rag[begin, 2, 3] < 0.015, "the rag still stands on the dustpan"
    assert rag[end, 2, 3] > rag[begin, 2, 3] + 0.02
    np.testing.assert_allclose(pan[end, :3, 3], pan[begin, :3, 3], atol=1e-6)
    np.testing.assert_allclose(np.arcsin(-pan[[begin, end], 2, 0]), (0, PAN_HELD), atol=2e-3)


def test_no_corner_of_the_dustpan_goes_below_the_surface() -> None:
    ends = [np.array(place) + half * np.array(sign) for half, place in walls() for sign in SIGNS]
    corners = np.concatenate((plate(), ends))
    setting = desk()
    half = np.array((setting.surface.width, setting.surface.depth)) / 2
    gaps: dict[str, list[float]] = {"standing": [], "lip raised": []}
    with closing(PybulletTable(setting, LOW_RAG)) as table:
        table.start(tool_path("pickUp", (AREA,), setting))
        drive = table._drive
        assert isinstance(drive, Reem)
        frames = forward(drive._arms[1], table._ahead[:, 7:])
        led = np.einsum("nij,kj->nki", frames[:, :3, :3], corners) + frames[:, None, :3, 3]
        assert led[(np.abs(led[..., :2]) < half).all(axis=2), 2].min() > PAN_GAP / 2
        engine, pan = table._engine, drive._left._body
        while table.poll() is Status.RUNNING:
            frame = forward(drive._arms[1], drive._left.joints()[None])[0]
            if frame[2, 3] < 2 * PAN_GAP:
                points = engine.getClosestPoints(pan, table._top, 0.01)
                pose = "standing" if -frame[2, 0] < 1e-3 else "lip raised"
                gaps[pose].append(min(point[DISTANCE] for point in points if point[LINK] > TOOL))
    for pose in gaps:
        assert len(gaps[pose]) > 60, pose
        assert min(gaps[pose]) > PAN_GAP / 2, f"so the engine finds it: {pose}"


def test_a_dustpan_put_down_on_particles_presses_none_far_into_the_table() -> None:
    below = tuple(Group(12, (-0.13, 0.03), 0.06, of) for of in ("lentils", "rice", "peas"))
    setting = scene(*below, edge="south", robot="reem", size=(0.50, 0.40))
    deepest = 0.0
    with closing(PybulletTable(setting, 1)) as table:
        table.start(tool_path("pickUp", (AREA,), setting))
        while table.poll() is Status.RUNNING:
            places = table.truth().positions
            inner = (np.abs(places[:, :2]) < (0.24, 0.19)).all(axis=1)
            deepest = min(deepest, float(places[inner, 2].min()))
    pea = PARTICLES["peas"].size[2]
    assert -pea / 2 < deepest < -pea / 4, "some were below its lip"


def test_the_right_arm_pushes_as_one_arm_does() -> None:
    setting = desk()
    with closing(PybulletTable(setting, LOW_RAG)) as table:
        table.start(tool_path("moveToContainerStraight", (AREA,), setting))
        assert finish(table) is Status.DONE
        assert table.truth().in_container >= 6
        table.withdraw()
        assert finish(table) is Status.DONE


def test_arms_that_would_touch_do_not_move() -> None:
    setting = desk()
    with closing(PybulletTable(setting, 1)) as table:
        drive = table._drive
        assert isinstance(drive, Reem)
        here = np.concatenate((drive._right.joints(), drive._left.joints()))
        drive._checked(here[None])
        crossed = np.concatenate((drive._right.joints(), drive._left.joints()))
        crossed[[0, 7]] = 1.2, -1.2
        with pytest.raises(Unreachable, match="the arms would touch each other"):
            drive._checked(crossed[None])


def test_a_hand_that_would_touch_the_dustpan_does_not_move() -> None:
    setting = desk()
    with closing(PybulletTable(setting, LOW_RAG)) as table:
        table.start(tool_path("pickUp", (AREA,), setting))
        drive, way = table._drive, table._ahead.copy()
        assert isinstance(drive, Reem)
        drive._checked(way)
        heights = forward(drive._arms[1], way[:, 7:])[:, 2, 3]
    times = np.arange(1, len(way))
    right, left = (np.diff(part, axis=0).any(axis=1) for part in np.hsplit(way, 2))
    down = times[right & (heights[1:] < 0.01)][0]
    leaving = times[left & (times > down)][0]  # the rag still stands on the dustpan
    lifted = times[(heights[1:] > 0.05) & (times > leaving)][0]
    with pytest.raises(Unreachable, match="the right arm would touch the dustpan"):
        drive._checked(np.concatenate((way[leaving, :7], way[lifted, 7:]))[None])


def test_what_the_rag_can_not_reach_fails_with_a_reason() -> None:
    corners = [(-0.6, 0.5, 0.05), (-0.6, 0.5, 0.0), (-0.5, 0.5, 0.0), (-0.5, 0.5, 0.05)]
    with closing(PybulletTable(desk(), 1)) as table:
        table.start(
            ToolPath(tuple(Waypoint(*corner, 0.0, 0.1) for corner in corners), Interpolation.STRAIGHT)
        )
        assert table.poll() is Status.FAILED
        assert "too far" in table.failure
        assert table.clock == 0


def test_a_dustpan_holds_what_is_between_its_walls() -> None:
    frame = np.eye(4)
    frame[:3, 3] = 0.1, 0.2, 0.3
    points = np.array([(-0.05, 0, 0.02), (0.05, 0, 0.02), (-0.05, 0.2, 0.02), (-0.05, 0, 0.2)]) + frame[:3, 3]
    assert within(frame, points).tolist() == [True, False, False, False]


_TWICE = """
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.motion.actions import tool_path, tool_paths
from cleancli.perception.area import Ellipse
from cleancli.scene.check import load_scene
from cleancli.world.robot import finish
from cleancli.world.table import PybulletTable
scene = load_scene(Source("s", "scene s { surface { width = 50 cm depth = 40 cm } container { edge = south }"
    " robot { drive = reem } camera { image = 64 x 48 focal = 52.5 }"
    " dirt { group { count = 8 at = (5 cm, 0 cm) radius = 2 cm } } }"))
table = PybulletTable(scene, 9)
table.start(tool_path("pickUp", (Ellipse((0.05, 0.0), (0.025, 0.02), 0.2),), scene))
finish(table)
print(table.truth().positions.tobytes().hex(), table.observe().depth.tobytes().hex(), table.clock)
"""


@pytest.mark.needs_pybullet
def test_the_same_seed_is_the_same_run_bit_for_bit_in_another_process() -> None:
    first, second = in_two_processes(_TWICE)
    assert float(first.split()[-1]) > 10, "it was carried out"
    assert first == second
