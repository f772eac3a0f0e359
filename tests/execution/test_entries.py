"""The journal's lines of an episode: what they add up to, and what they expect."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from cleancli.compiler.fluents import Fluent, Values, values_of
from cleancli.execution.episode_state import Move, Situation
from cleancli.execution.events import Acted
from cleancli.execution.loop import clean
from cleancli.execution.session import Session, symbolic_session
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, Job
from cleancli.execution.table_cell import TableCell
from cleancli.language.model import Fact, Value
from cleancli.learning.experience import Transition
from cleancli.recording import journal
from cleancli.recording.journal_writer import Entries, course_of, expected
from cleancli.world.robot import Status
from support.scripted_robot import Scripted
from support.shipped import shipped_domain, shipped_problem, shipped_scene

DOMAIN = shipped_domain("cleaning")
PROBLEM = shipped_problem("three_areas", DOMAIN)
SCENE = shipped_scene("two_groups")


def lines(session: Session) -> list[journal.Record]:
    entries = Entries(DOMAIN, lambda: session.cell.clock)
    return [record for event in clean(session.setup, session.cell) for record in entries.of(event)]


@pytest.fixture(scope="module")
def symbolic() -> list[journal.Record]:
    return lines(symbolic_session(DOMAIN, PROBLEM, EpisodeOptions(samples=200, seed=2)))


def test_what_was_spent_adds_up_to_what_the_end_tells(symbolic: list[journal.Record]) -> None:
    ended = symbolic[-1]
    assert isinstance(ended, journal.Ended)
    sums = dict.fromkeys(ended.seconds, 0.0)
    for record in symbolic:
        for kind, seconds in record.seconds.items() if isinstance(record, journal.Spent) else ():
            sums[kind] += seconds
    assert sums == pytest.approx(dict(ended.seconds))
    assert ended.seconds["actions"] > 0


def test_every_action_is_begun_with_what_is_expected_and_then_over(symbolic: list[journal.Record]) -> None:
    begun = [record for record in symbolic if isinstance(record, journal.Started)]
    acted = [record for record in symbolic if isinstance(record, journal.Acted)]
    assert [r.number for r in begun] == [r.number for r in acted] == list(range(1, len(begun) + 1))
    for start, end in zip(begun, acted, strict=True):
        assert start.expected.rule == end.rule is not None
        assert sum(chance.probability for chance in start.expected.outcomes) == pytest.approx(1)
        assert end.outcome is not None, "in the symbolic world an outcome of the rule has happened"
        happened = start.expected.outcomes[end.outcome]
        if happened.kind == "change":
            assert set(end.changed) <= set(happened.effects)


STATES = some.dictionaries(
    some.sampled_from([("dirt", ("a1",)), ("dirt", ("a2",)), ("scattered", ("a1",)), ("size", ("a2",))]),
    some.booleans() | some.sampled_from(["small", "big"]),
).map(
    lambda values: {
        key: value if key[0] == "size" else True
        for key, value in values.items()
        if isinstance(value, bool) is (key[0] != "size")
    }
)


@settings(max_examples=60, deadline=None)
@given(STATES, STATES)
def test_what_changed_makes_the_state_after_of_the_one_before(
    before: dict[Fluent, Value], after: dict[Fluent, Value]
) -> None:
    """And nothing is told that was so before (docs/runs.md: the facts whose value differs)."""
    states = (frozenset(Fact(*key, value) for key, value in state.items()) for state in (before, after))
    old, new = map(values_of, states)
    transition = Transition("moveToContainerFast", ("a1",), PROBLEM.objects, old, new)
    told = Acted(
        1, Move("moveToContainerFast", ("a1",)), transition, True, 0.0, 1.0, Situation((), (), frozenset())
    )
    (entry,) = [e for e in Entries(DOMAIN, lambda: 0.0).of(told) if isinstance(e, journal.Acted)]
    changes = {(e.symbol, e.objects): e.value for e in entry.changed}
    nothing: tuple[object, ...] = (None, False)
    assert {key: v for key, v in {**before, **changes}.items() if v not in nothing} == after
    assert all(before.get(key) != value and (value or key in before) for key, value in changes.items())


def test_a_plan_expects_of_each_step_what_the_likeliest_ones_before_leave() -> None:
    calls = (("moveToContainerFast", ("a1",)), ("moveToContainerFast", ("a3",)))
    first, second = course_of(DOMAIN, PROBLEM.objects, PROBLEM.state, calls)
    assert first.expected.rule == "fast_small"
    gone = {entry.objects for entry in first.expected.outcomes[0].effects if entry.value is False}
    assert gone == {("a1",), ("a3",)}, "a3 lies on the way of a1"
    assert second.expected.rule is None, "so there is nothing left for the second step"
    alone = expected(DOMAIN, PROBLEM.objects, PROBLEM.state, *calls[1])
    assert alone.rule == "fast_small"


def test_a_policys_plan_goes_on_from_the_results_that_its_course_follows() -> None:
    """docs/runs.md: `follows`. The next step expects that the one before has come to what the plan says."""
    calls = (("groupScattered", ("a2",)), ("moveToContainerFast", ("a2",)))
    results: list[Values] = [{("scattered", ("a2",)): False}, {("dirt", ("a2",)): False}]
    first, second = course_of(DOMAIN, PROBLEM.objects, PROBLEM.state, calls, results)
    assert first.follows == 0
    assert second.expected.rule == "fast_medium"
    assert second.follows == 0
    odd = course_of(DOMAIN, PROBLEM.objects, PROBLEM.state, calls, [{("dirt", ("a3",)): False}, results[1]])
    assert odd[0].follows is None, "no outcome does that"


def test_a_failure_is_told_with_its_reason_and_rivals_expect_nothing() -> None:
    robot = Scripted(SCENE, lambda strokes: [(0.0, 0.1)], lambda strokes: Status.FAILED)
    setup = EpisodeSetup(
        DOMAIN, DOMAIN, SCENE, Job.CONTAINER, EpisodeOptions(strategy="reactive", max_actions=2)
    )
    cell = TableCell(DOMAIN, SCENE, robot, 1)
    records = lines(Session(setup, cell, None, dict, dict, robot.stop, lambda: None))
    failed = [record for record in records if isinstance(record, journal.Failed)]
    assert failed
    assert failed[0].reason == "something holds the tool back"
    planned = [record for record in records if isinstance(record, journal.Planned)]
    assert planned[0].planner == ""
    looked = records[0]
    assert isinstance(looked, journal.Looked)
    assert looked.purpose == "first"
    assert [area.name for area in looked.areas] == ["a1"]
    assert looked.areas[0].centre == pytest.approx((0.0, 0.1), abs=0.005)


def test_a_move_that_is_no_action_changes_nothing_by_the_rules() -> None:
    robot = Scripted(SCENE, lambda strokes: [(0.0, 0.1)], lambda strokes: Status.DONE)
    setup = EpisodeSetup(DOMAIN, DOMAIN, SCENE, Job.CONTAINER, EpisodeOptions(strategy="wipe", max_actions=1))
    cell = TableCell(DOMAIN, SCENE, robot, 1)
    records = lines(Session(setup, cell, None, dict, dict, robot.stop, lambda: None))
    (acted,) = (record for record in records if isinstance(record, journal.Acted))
    assert (acted.action, acted.rule, acted.outcome, acted.changed) == ("wipe", None, None, ())
    (started,) = (record for record in records if isinstance(record, journal.Started))
    assert (started.expected.rule, started.expected.outcomes) == (None, ())
