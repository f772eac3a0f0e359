"""Worlds that lie, robots that fail, arms that hide dirt: every episode ends, in time and with a reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import pytest

from cleancli.execution.episode_state import PATIENCE
from cleancli.execution.events import Acted, Decided, Ended, Event, Failed, Looked, Purpose, Started
from cleancli.execution.loop import clean
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, Job, within_reach
from cleancli.execution.strategies import STRATEGIES
from cleancli.execution.table_cell import TableCell
from cleancli.language.model import Domain, Rule
from cleancli.scene.model import Scene
from cleancli.world.robot import Status
from support.scripted_robot import STROKE, WITHDRAWAL, Points, Scripted
from support.shipped import shipped_domain, shipped_scene

SPOTS = ((-0.2, 0.1), (0.1, -0.15))


@pytest.fixture(scope="module")
def domain() -> Domain:
    return shipped_domain("cleaning")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return shipped_scene("two_groups")


@pytest.fixture
def run(domain: Domain, scene: Scene) -> Callable[..., list[Event]]:
    """All events of an episode of a scripted robot."""

    def events(robot: Scripted, rules: Domain = domain, **options: object) -> list[Event]:
        chosen = EpisodeOptions(samples=200, **options)  # type: ignore[arg-type]
        feasible = within_reach(rules, scene.arms, Job.CONTAINER)
        setup = EpisodeSetup(rules, feasible, scene, Job.CONTAINER, chosen)
        return list(clean(setup, TableCell(rules, scene, robot, chosen.seed)))

    return events


# What learns whole rules has none to begin with, and is tried in tests/execution/test_exploring.py.
ON_TABLES = [name for name, each in STRATEGIES.items() if not each.learns_rules]


def end_of(events: list[Event]) -> Ended:
    ended = events[-1]
    assert isinstance(ended, Ended)
    assert sum(isinstance(event, Ended) for event in events) == 1
    return ended


def until(strokes: int, dirt: Points = SPOTS) -> Callable[[int], Points]:
    """Dirt that is there until so many strokes were carried out."""
    return lambda done: dirt if done < strokes else ()


@pytest.mark.parametrize("strategy", ON_TABLES)
def test_a_table_without_dirt_is_clean(run: Callable[..., list[Event]], scene: Scene, strategy: str) -> None:
    ended = end_of(run(Scripted(scene, lambda done: ()), strategy=strategy))
    assert ended.clean
    assert ended.actions == 0


@pytest.mark.parametrize("strategy", ON_TABLES)
def test_actions_that_do_nothing_end(run: Callable[..., list[Event]], scene: Scene, strategy: str) -> None:
    robot = Scripted(scene, lambda done: SPOTS)
    events = run(robot, strategy=strategy, max_actions=70)
    ended = end_of(events)
    assert not ended.clean
    assert "limit of 70 actions" in ended.reason or "in vain" in ended.reason
    counts: dict[object, int] = {}
    for event in events:
        if isinstance(event, Acted) and event.move.objects:
            counts[event.move.key] = counts.get(event.move.key, 0) + 1
    assert all(count <= PATIENCE for count in counts.values()), "what is of no use was tried again"


def test_the_limit_of_actions_holds(run: Callable[..., list[Event]], scene: Scene) -> None:
    ended = end_of(run(Scripted(scene, lambda done: SPOTS), max_actions=5))
    assert (ended.actions, ended.reason) == (5, "the limit of 5 actions is reached")
    assert ended.spent.transits + ended.spent.actions == 5 * STROKE


def test_the_limit_of_seconds_holds(run: Callable[..., list[Event]], scene: Scene) -> None:
    ended = end_of(run(Scripted(scene, lambda done: SPOTS), max_seconds=12.0))
    assert ended.reason == "the limit of 12 seconds is reached"
    assert ended.spent.actions + ended.spent.transits <= 15 < 60 * STROKE
    assert ended.spent.total >= 12


def test_dirt_that_comes_back_ends_at_the_limit(run: Callable[..., list[Event]], scene: Scene) -> None:
    spots = [((x / 20, y / 20),) for x in range(-6, 7) for y in range(-4, 5)]
    robot = Scripted(scene, lambda done: spots[done * 7 % len(spots)] if done else SPOTS)
    ended = end_of(run(robot, max_actions=12))
    assert not ended.clean
    assert ended.actions == 12
    assert "limit of 12 actions" in ended.reason


def test_ghosts_that_only_the_withdrawn_arm_lets_see_end(
    run: Callable[..., list[Event]], scene: Scene
) -> None:
    robot = Scripted(scene, lambda done: () if robot.out else SPOTS)
    ended = end_of(run(robot, max_actions=9))
    assert not ended.clean
    assert ended.actions == 9


def test_what_fails_is_not_asked_for_again(run: Callable[..., list[Event]], scene: Scene) -> None:
    robot = Scripted(scene, lambda done: SPOTS, lambda done: Status.FAILED)
    events = run(robot)
    ended = end_of(events)
    assert not ended.clean
    assert "in vain" in ended.reason
    assert "something holds the tool back" in ended.reason
    failed = [event.move.key for event in events if isinstance(event, Failed)]
    assert len(failed) == len(set(failed)) == ended.actions == robot.stops > 3


def test_an_episode_outlives_a_failure(run: Callable[..., list[Event]], scene: Scene) -> None:
    ends = [Status.FAILED, Status.DONE, Status.DONE]
    events = run(Scripted(scene, until(2), lambda done: ends[done]))
    started = [event.move for event in events if isinstance(event, Started)]
    assert end_of(events).clean
    assert len(started) == 2
    assert started[0] != started[1]


def test_a_motion_without_an_end_fails(
    run: Callable[..., list[Event]], scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cleancli.world.robot.STILL", 0.05)
    ends = [Status.RUNNING, Status.DONE]
    events = run(Scripted(scene, until(2), lambda done: ends[done]))
    assert [event.reason for event in events if isinstance(event, Failed)] == ["the motion does not end"]
    assert end_of(events).clean


def test_an_arm_that_cannot_leave_ends_the_episode(
    run: Callable[..., list[Event]], scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = Scripted(scene, until(1))

    def withdraw() -> None:
        robot._status = Status.FAILED if robot.strokes else Status.DONE

    monkeypatch.setattr(robot, "withdraw", withdraw)
    ended = end_of(run(robot))
    assert not ended.clean
    assert ended.reason.startswith("the arm cannot leave the camera's view: something holds")


def test_no_table_is_a_reason(run: Callable[..., list[Event]], scene: Scene) -> None:
    bare = replace(scene, surface=replace(scene.surface, width=2.5, depth=2.5))
    robot = Scripted(bare, lambda done: ())
    frame = replace(robot.observe(), depth=robot.observe().depth * 0)
    robot.observe = lambda: frame  # type: ignore[method-assign]
    ended = end_of(run(robot))
    assert not ended.clean
    assert ended.reason


def test_rules_that_promise_nothing_end_the_episode(
    run: Callable[..., list[Event]], scene: Scene, domain: Domain
) -> None:
    hopeless = replace(domain, rules=tuple(rule for rule in domain.rules if rule.action == "pickUp"))
    events = run(Scripted(scene, lambda done: SPOTS), rules=hopeless)
    assert end_of(events).reason == "nothing seems worth doing"
    assert sum(isinstance(event, Decided) for event in events) == 1, "the first look was full"


# ---- What the arm hides


def hiding(scene: Scene, dirt: Callable[[int], Points]) -> Scripted:
    """A robot whose arm, once out, hides the western part."""
    return Scripted(scene, dirt, hides=(-0.3, -0.1))


def looked(events: list[Event], purpose: Purpose) -> float:
    """Seconds that looks for a purpose took."""
    return sum(e.seconds for e in events if isinstance(e, Looked) and e.purpose is purpose)


def test_what_the_arm_hides_is_believed_as_it_was(run: Callable[..., list[Event]], scene: Scene) -> None:
    robot = Scripted(scene, lambda done: SPOTS, hides=(0.0, 0.2))
    events = run(robot, strategy="reactive", max_actions=1)
    first, after = (event.situation for event in events if isinstance(event, Looked))
    assert {area.name for area in after.areas} == {area.name for area in first.areas}
    (unseen,) = after.unseen
    assert next(a for a in after.areas if a.name == unseen) in first.areas
    assert after.hidden > 0.05
    (acted,) = (event for event in events if isinstance(event, Acted))
    assert not acted.seen, "a learner must not count what was hidden"


def test_the_arm_moves_out_of_view_only_once_nothing_else_is_left(
    run: Callable[..., list[Event]], scene: Scene
) -> None:
    east, west = (SPOTS[1],), (SPOTS[0],)
    # Dirt is in the east; what came to lie in the west meanwhile is hidden until the arm is away.
    robot = hiding(scene, lambda done: east if done < 2 else west if done < 3 else ())
    events = run(robot, strategy="reactive")
    looks = [event.purpose for event in events if isinstance(event, Looked)]
    after, extra = Purpose.AFTER, Purpose.EXTRA
    assert looks == [Purpose.FIRST, after, after, extra, after, extra, extra]
    ended = end_of(events)
    assert ended.clean
    assert ended.spent.extra_perceptions == pytest.approx(2 * WITHDRAWAL + looked(events, Purpose.EXTRA))


def test_unknown_actions_are_looked_at_with_the_arm_away(
    run: Callable[..., list[Event]], scene: Scene
) -> None:
    events = run(hiding(scene, until(5)), strategy="reactive", known=2)
    acted = [event for event in events if isinstance(event, Acted)]
    looks = [event.purpose for event in events if isinstance(event, Looked)][1:6]
    assert looks == [Purpose.LEARNING] * 2 + [Purpose.AFTER] * 3
    assert [event.seen for event in acted] == [True, True, False, False, False]
    learning = end_of(events).spent.learning
    assert learning == pytest.approx(2 * WITHDRAWAL + looked(events, Purpose.LEARNING))


def test_what_the_file_counts_of_all_outcomes_makes_an_action_known(
    run: Callable[..., list[Event]], domain: Domain, scene: Scene
) -> None:
    """docs/execution.md: `--known` is compared with what all outcomes of a rule were seen, parts included."""
    counts = (Fraction(3, 5), Fraction(2, 5))

    def counted(rule: Rule) -> Rule:
        first, second, *others = rule.outcomes
        seen = [replace(o, seen=count) for o, count in zip((first, second), counts, strict=True)]
        return replace(rule, outcomes=(*seen, *others))

    rules = replace(domain, rules=tuple(map(counted, domain.rules)))
    events = run(hiding(scene, until(5)), rules, strategy="reactive", known=2)
    looks = [event.purpose for event in events if isinstance(event, Looked)][1:6]
    assert looks == [Purpose.LEARNING] + [Purpose.AFTER] * 4


def test_looks_between_two_moves_of_one_decision_cost_no_time(
    run: Callable[..., list[Event]], scene: Scene
) -> None:
    events = run(Scripted(scene, until(2)), strategy="plan-2", max_actions=1)
    waited = end_of(events).spent.perceiving
    first, _ = (event for event in events if isinstance(event, Looked))
    assert waited == pytest.approx(first.seconds)
