"""What strategies choose, those without rules above all, and that their paths go where they should."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise, permutations
from math import dist

import numpy as np
import pytest

from cleancli.compiler.task import GroundAction
from cleancli.execution.baselines import gather_all, nearest_first, wipe_all
from cleancli.execution.episode_state import ActionKey, Move, Situation
from cleancli.execution.setup import DecisionContext, EpisodeOptions, Job, discounts_time, within_reach
from cleancli.execution.strategies import STRATEGIES
from cleancli.execution.tsp import shortest_path
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Fact, Object, Problem
from cleancli.perception.area import Area
from cleancli.scene.model import Scene
from cleancli.scene.robots import ARMS
from support.shipped import shipped_domain, shipped_scene

OPTIONS = EpisodeOptions()


@pytest.fixture(scope="module")
def scene() -> Scene:
    return shipped_scene("two_groups")


def now(
    scene: Scene, *places: tuple[float, float], number: int = 0, job: Job = Job.CONTAINER
) -> DecisionContext:
    """Small areas a1, a2, ... at these places; the tool is above the container."""
    areas = tuple(
        Area(Ellipse(place, (0.02, 0.01), 0.0), 1e-4, f"a{index}") for index, place in enumerate(places, 1)
    )
    situation = Situation(areas, (), frozenset())
    domain = shipped_domain("cleaning")
    problem = Problem("here", "cleaning", (), frozenset())
    tool = (0.45, 0.0)
    return DecisionContext(
        domain, problem, scene, job, situation, tool, frozenset(), (), number, 1, lambda actions: {}
    )


def test_reactive_begins_farthest_from_the_goal_and_goes_on_nearest_to_the_arm(scene: Scene) -> None:
    places = (0.3, 0.0), (-0.35, 0.1), (0.1, 0.2)
    (first,) = nearest_first(now(scene, *places), OPTIONS).moves
    (then,) = nearest_first(now(scene, *places, number=1), OPTIONS).moves
    assert (first.key, then.key) == (("moveToContainerFast", ("a2",)), ("moveToContainerFast", ("a1",)))


def test_reactive_tries_otherwise_what_was_in_vain(scene: Scene) -> None:
    here = now(scene, (0.3, 0.0), (-0.3, 0.0), number=1)
    tried = frozenset({("moveToContainerFast", ("a1",))})
    (other,) = nearest_first(replace(here, excluded=tried), OPTIONS).moves
    assert other.key == ("moveToContainerFast", ("a2",))
    tried |= {("moveToContainerFast", ("a2",))}
    (slower,) = nearest_first(replace(here, excluded=tried), OPTIONS).moves
    assert slower.key == ("moveToContainerStraight", ("a1",))
    tried |= {("moveToContainerStraight", (name,)) for name in ("a1", "a2")}
    assert not nearest_first(replace(here, excluded=tried), OPTIONS).moves


def test_with_a_dustpan_they_pick_up(scene: Scene) -> None:
    here = now(replace(scene, robot="reem"), (0.1, 0.0), (-0.1, 0.1), job=Job.DUSTPAN)
    (move,) = nearest_first(here, OPTIONS).moves
    assert move.key == ("pickUp", ("a2",))
    assert gather_all(here, OPTIONS).moves[1].action == "pickUp"
    assert all(move.path is not None and move.path.dustpan for move in wipe_all(here, OPTIONS).moves)


@pytest.mark.parametrize("edge", ["east", "north", "west", "south"])
def test_the_wipe_covers_the_bounding_box_from_right_to_left(scene: Scene, edge: str) -> None:
    scene = replace(scene, container=replace(scene.container, edge=edge))
    rng = np.random.default_rng(1)
    places = [(float(x), float(y)) for x, y in rng.uniform(-0.25, 0.25, (12, 2))]
    moves = wipe_all(now(scene, *places), OPTIONS).moves
    out = np.array(scene.outwards())
    left = np.array((out[1], -out[0]))
    ends = [np.array([(w.x, w.y) for w in move.path.waypoints if w.z <= 0]) for move in moves if move.path]
    rows = [float(end[0] @ left) for end in ends]
    assert rows == sorted(rows), "the first line is the one on the right"
    assert max(after - before for before, after in pairwise(rows)) < scene.rag.width
    for place in places:
        assert min(abs(np.array(place) @ left - row) for row in rows) <= scene.rag.width / 2
    for end in ends:
        assert end[0] @ out <= min(np.array(place) @ out for place in places) - 0.01
        assert end[-1] @ out > abs(np.array(scene.mouth()[0]) @ out), "each line ends over the container"


def test_a_single_spot_takes_a_single_line(scene: Scene) -> None:
    assert len(wipe_all(now(scene, (0.0, 0.0)), OPTIONS).moves) == 1
    assert not wipe_all(now(scene), OPTIONS).moves


def test_gathering_goes_through_all_areas_and_cleans_once(scene: Scene) -> None:
    places = (-0.3, 0.2), (0.3, 0.05), (-0.1, -0.2), (0.1, 0.15)
    gather, push = gather_all(now(scene, *places), OPTIONS).moves
    assert sorted(gather.objects) == ["a1", "a2", "a3", "a4"]
    assert push.key == ("moveToContainerFast", gather.objects[-1:]) == ("moveToContainerFast", ("a2",))
    assert gather.path is not None
    way = [(w.x, w.y) for w in gather.path.waypoints]
    for place in places[:1] + places[2:]:
        assert min(dist(place, point) for point in way) < 0.04
    (alone,) = gather_all(now(scene, (0.1, 0.1)), OPTIONS).moves
    assert alone.action == "moveToContainerFast"


@pytest.mark.parametrize("number", [1, 2, 3, 5, 7])
def test_paths_are_hardly_longer_than_the_shortest(number: int) -> None:
    for seed in range(5):
        places = np.random.default_rng(seed).uniform(-0.4, 0.4, (number, 2))
        found = shortest_path(places, number // 2, seed)
        assert sorted(found) == list(range(number))
        assert found[-1] == number // 2
        others = [index for index in range(number) if index != number // 2]
        shortest = min(_length(places, (*order, number // 2)) for order in permutations(others))
        assert _length(places, found) <= 1.02 * shortest


def _length(places: np.ndarray, order: tuple[int, ...]) -> float:
    return sum(float(np.linalg.norm(places[one] - places[other])) for one, other in pairwise(order))


def test_a_plan_by_time_begins_with_what_takes_least(scene: Scene) -> None:
    """Two areas that rules tell nothing apart of; one takes longer here."""
    names = ("a1", "a2")
    facts = {
        Fact(symbol, (name,), value)
        for name in names
        for symbol, value in (("dirt", True), ("size", "small"))
    }
    domain = within_reach(shipped_domain("cleaning"), ARMS["gantry"], Job.CONTAINER)
    problem = Problem("here", "cleaning", tuple(Object(n, "area") for n in names), frozenset(facts))

    def begins(slow: str) -> str:
        def seconds(actions: Iterable[GroundAction]) -> dict[ActionKey, float]:
            return {action.key: 20.0 if slow in action.objects else 5.0 for action in actions}

        here = replace(now(scene), domain=domain, problem=problem, seconds=seconds)
        moves = STRATEGIES["plan-2"].decide(here, replace(OPTIONS, by_time=True)).moves
        return moves[0].objects[0]

    assert (begins("a1"), begins("a2")) == ("a2", "a1")


PRICED = """
domain priced {
  types      { area }
  predicates { dirt(?a - area) }
  derived    { left := count ?a - area: dirt(?a) }
  actions    { push(?a - area) [duration = 9 s]  wipe(?a - area) [duration = 9 s] }
  rule pushed: push(?a) { when dirt(?a) then 1: not dirt(?a) }
  rule wiped: wipe(?a)  { when dirt(?a) then 1: not dirt(?a) }
  reward { decrease(left) - 0.05 * duration }
}
"""


def test_a_reward_that_counts_durations_counts_what_actions_take_here(scene: Scene) -> None:
    """docs/planning.md, "Rewards": nothing is done where it takes longer than it is worth (20 s)."""
    domain = load_domain(Source("priced.nid", PRICED))
    problem = Problem("here", "priced", (Object("a1", "area"),), frozenset({Fact("dirt", ("a1",), True)}))

    def does(**takes: float) -> tuple[Move, ...]:
        def seconds(actions: Iterable[GroundAction]) -> dict[ActionKey, float]:
            return {action.key: takes[action.name] for action in actions}

        here = replace(now(scene), domain=domain, problem=problem, seconds=seconds)
        return STRATEGIES["plan-2"].decide(here, replace(OPTIONS, by_time=discounts_time(domain))).moves

    assert does(push=12.0, wipe=6.0) == (Move("wipe", ("a1",)),)
    assert does(push=6.0, wipe=12.0) == (Move("push", ("a1",)),)
    assert does(push=21.0, wipe=22.0) == ()
