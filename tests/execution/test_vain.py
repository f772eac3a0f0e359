"""A move that was in vain is of no use as long as none of its objects has changed, whichever it is."""

from __future__ import annotations

from dataclasses import replace

import pytest
from numpy import pi

from cleancli.execution.episode_state import (
    PATIENCE,
    EpisodeState,
    FailedAttempt,
    Move,
    Situation,
    about,
    unchanged,
)
from cleancli.execution.loop import clean
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, Job
from cleancli.execution.table_cell import TableCell
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.model import Fact, Object
from cleancli.motion.actions import tool_path, tool_paths
from cleancli.motion.path import ToolPath, pressed
from cleancli.perception.area import Area
from support.scripted_robot import Scripted
from support.shipped import shipped_domain, shipped_scene


def area(
    name: str, x: float, y: float, long: float = 0.03, covered: float = 1e-3, short: float = 0.02
) -> Area:
    return Area(Ellipse((x, y), (long, short), 0.2), covered * pi, name)


AREAS = (area("a1", 0.0, 0.0), area("a2", 0.2, 0.1), area("a3", -0.2, 0.1))
STATE = frozenset({Fact("dirt", ("a1",)), Fact("dirt", ("a2",)), Fact("near", ("a1", "a2"))})
BEFORE = Situation(AREAS, tuple(Object(each.name, "area") for each in AREAS), STATE)
JOINED = FailedAttempt(("join2", ("a1", "a2")), *about(("a1", "a2"), BEFORE), times=PATIENCE)
CHANGES = {
    "moved": (0.211, 0.1),
    "moved aside": (0.2, 0.089),
    "longer": (0.2, 0.1, 0.0405),
    "shorter": (0.2, 0.1, 0.0195),
    "dirtier": (0.2, 0.1, 0.03, 1.3e-3),
    "cleaner": (0.2, 0.1, 0.03, 0.75e-3),
}
ALIKE = {
    "the same": (0.2, 0.1),
    "nearly there": (0.209, 0.1),
    "nearly as long": (0.2, 0.1, 0.039),
    "nearly as dirty": (0.2, 0.1, 0.03, 1.2e-3),
}


def with_second(*values: float) -> Situation:
    return replace(BEFORE, areas=(AREAS[0], area("a2", *values), AREAS[2]))


@pytest.mark.parametrize("values", CHANGES.values(), ids=CHANGES)
def test_a_change_of_the_second_of_two_counts(values: tuple[float, ...]) -> None:
    assert not unchanged(JOINED, with_second(*values))
    assert not EpisodeState(with_second(*values), vain=(JOINED,)).excluded


@pytest.mark.parametrize("values", ALIKE.values(), ids=ALIKE)
def test_what_perception_may_err_by_is_no_change(values: tuple[float, ...]) -> None:
    assert unchanged(JOINED, with_second(*values))
    assert EpisodeState(with_second(*values), vain=(JOINED,)).excluded == {JOINED.key}


def test_what_happens_to_others_does_not_count_and_facts_do() -> None:
    moved = replace(BEFORE, areas=(*AREAS[:2], area("a3", 0.3, 0.3)))
    assert unchanged(JOINED, replace(moved, state=STATE | {Fact("dirt", ("a3",))}))
    assert not unchanged(JOINED, replace(BEFORE, state=STATE - {Fact("near", ("a1", "a2"))}))
    assert not unchanged(JOINED, replace(BEFORE, state=STATE | {Fact("scattered", ("a2",))}))
    assert not unchanged(JOINED, replace(BEFORE, areas=AREAS[:1]))


def test_patience_ends_at_its_number() -> None:
    assert not EpisodeState(BEFORE, vain=(replace(JOINED, times=PATIENCE - 1),)).excluded
    assert EpisodeState(BEFORE, vain=(replace(JOINED, times=PATIENCE + 1),)).excluded
    assert not EpisodeState(None, vain=(JOINED,)).excluded


def test_times_in_vain_count_as_long_as_nothing_has_changed() -> None:
    tried = EpisodeState(BEFORE, vain=(replace(JOINED, times=2),))
    assert tried.times_in_vain(JOINED.key) == 2
    assert tried.times_in_vain(("join2", ("a2", "a1"))) == 0
    assert replace(tried, situation=with_second(0.3, 0.1)).times_in_vain(JOINED.key) == 0
    assert replace(tried, situation=None).times_in_vain(JOINED.key) == 0


@pytest.mark.parametrize(
    ("strategy", "heights_of"), [("reactive", [0.0, -1e-3, -2e-3, -3e-3]), ("tsp", [0.0, 0.0, -1e-3, -1e-3])]
)
def test_what_was_in_vain_is_pressed_further(strategy: str, heights_of: list[float]) -> None:
    """docs/execution.md: by 1 mm each time, but where a dustpan takes part. Tours of tsp, which makes their
    paths itself, and its pushes take turns."""
    scene = shipped_scene("two_groups")
    places = [(0.0, 0.1)] if strategy == "reactive" else [(0.0, 0.1), (-0.2, 0.0)]
    robot, heights = Scripted(scene, lambda strokes: places), []
    start = robot.start

    def noted(path: ToolPath) -> None:
        heights.append(min(waypoint.z for waypoint in path.waypoints))
        start(path)

    robot.start = noted  # type: ignore[method-assign]
    domain = shipped_domain("cleaning")
    options = EpisodeOptions(strategy=strategy, max_actions=PATIENCE)
    setup = EpisodeSetup(domain, domain, scene, Job.CONTAINER, options)
    list(clean(setup, TableCell(domain, scene, robot, 1)))
    assert heights == pytest.approx(heights_of)
    reem = shipped_scene("reem_pick_up")
    picking = tool_path("pickUp", (AREAS[0].ellipse,), reem)
    assert pressed(picking, 0.002) == picking
    path = tool_path("moveToContainerFast", (AREAS[0].ellipse,), scene)
    lower = pressed(path, 0.002)
    above = [(a.z, b.z) for a, b in zip(path.waypoints, lower.waypoints, strict=True) if a.z > 0]
    assert above == [(z, z) for z, _ in above], "only the stroke"


def test_picking_up_takes_the_first_way_that_the_robot_can_follow_and_another_after_it_was_in_vain() -> None:
    """docs/execution.md; the best way where it can follow none, so that its failure is told."""
    scene, domain = shipped_scene("reem_pick_up"), shipped_domain("cleaning")
    ways = list(tool_paths("pickUp", (AREAS[0].ellipse,), scene))
    robot = Scripted(scene, lambda strokes: [])
    cell = TableCell(domain, scene, robot, 1)
    move = Move("pickUp", ("a1",))
    assert cell.path(move, BEFORE) == ways[0]
    assert cell.path(move, BEFORE, vain=1) == ways[1]
    robot.can_follow = lambda path, errors=0.0: path in ways[2:4]  # type: ignore[method-assign]
    assert cell.path(move, BEFORE) == ways[2]
    assert cell.path(move, BEFORE, vain=1) == ways[3]
    robot.can_follow = lambda path, errors=0.0: path in ways[2:4][: 1 + (errors < 2)]  # type: ignore[method-assign]
    assert cell.path(move, BEFORE) == ways[2], "the surest first"
    robot.can_follow = lambda path, errors=0.0: False  # type: ignore[method-assign]
    assert cell.path(move, BEFORE) == ways[0]


@pytest.mark.parametrize("seen", range(4))
def test_nothing_is_shown_where_all_that_is_believed_to_be_there_is_out_of_sight(seen: int) -> None:
    """A look without the arm is due then, and neither where something is seen nor where nothing is."""
    out_of_sight = frozenset(each.name for each in AREAS[seen:])
    assert replace(BEFORE, unseen=out_of_sight).shows_nothing == (seen == 0)
    assert not replace(BEFORE, areas=(), unseen=frozenset()).shows_nothing
