"""Episodes: what is drawn, paid and shown to planners, and why they end."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.ground import ground
from cleancli.compiler.lifted_state import StateView
from cleancli.compiler.semantics import exact_value, standing
from cleancli.compiler.task import NoDurationError, Task, by_time
from cleancli.language.model import Domain, Fact, Problem
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planner import Planner
from cleancli.simulation import agent as agents
from cleancli.simulation import batch
from cleancli.simulation import episode as episodes
from cleancli.simulation.agent import Agent
from cleancli.simulation.episode import Episode, EpisodeLimits, Reason, episode, replayed
from cleancli.simulation.symbolic_world import World, assignment_of, do, succeeded, world_of
from support import doors, from_text

DOORS, JAMMING, PAID = (from_text.domain(text) for text in (doors.DOORS, doors.JAMMING, doors.PAID))
PROBLEM = doors.problem(DOORS)
STEPS = "horizon = 5"
COUNTED = Options().counted
UNLUCKY = 1
"""A seed whose first episode opens no door by the first action, while others do."""


def run(text: str, *said: str, inside: str = doors.TWO_DOORS, number: int = 0, **limits: Any) -> Episode:
    """One episode of a planner that always says the same."""
    known = from_text.domain(text)
    given = doors.problem(known, inside)
    who = Agent(doors.saying(*said), known, given)
    return episode(world_of(known, given), who, number, Options(), EpisodeLimits(**limits))


# ---- what is paid


@pytest.mark.parametrize("timed", [False, True])
@pytest.mark.parametrize(
    ("text", "said"),
    [
        (doors.DOORS, ("push(a)", "oil(b)", "push(a)", "push(b)")),
        (doors.PAID, ("push(a)", "push(a)", "oil(b)")),
        (doors.JAMMING, ("push(a)", "push(a)", "oil(a)")),
        (doors.STORMY, ("storm()", "push(a)", "storm()")),
    ],
)
def test_the_mean_return_is_the_exact_value(text: str, said: tuple[str, ...], timed: bool) -> None:
    known = from_text.domain(text)
    given = doors.problem(known, f"{doors.TWO_DOORS} {STEPS}")
    task = ground(known, given)
    numbers = [[str(a) for a in task.actions].index(name) for name in said]
    expected = exact_value(by_time(task) if timed else task, numbers)
    world, who = (
        world_of(known, given, timed),
        Agent(doors.saying(*said), known, given, "time" if timed else None),
    )
    limits = EpisodeLimits(max_actions=len(said), commit=len(said))
    found = [episode(world, who, n, Options(), limits) for n in range(3000)]
    # What is paid for the state after the limit of actions is left out, so the horizon is that limit.
    expected = exact_value(replace(by_time(task) if timed else task, horizon=len(said)), numbers)
    returns = [each.discounted for each in found]
    assert abs(np.mean(returns) - expected) < stats.norm.isf(1e-5) * stats.sem(returns)
    assert np.std(returns) > 0.05


def test_after_an_early_end_standing_still_is_paid() -> None:
    idle = run(
        doors.PAID,
        inside=f"{{init}} {STEPS}".format(init="init { open(a), force(a) = 1, force(b) = 1 }"),
        max_actions=4,
    )
    assert idle.reason is Reason.IDLE
    assert idle.plain == pytest.approx(4 * 0.5)
    assert idle.discounted == pytest.approx(0.5 * sum(0.95**k for k in range(4)))


def test_actions_that_can_change_nothing_cost_and_last() -> None:
    """The planner thinks that oil helps; in the world it does nothing, so the task has no such action."""
    text = doors.DOORS.replace("reward { decrease(shut) }", "reward { decrease(shut) - cost }")
    known = from_text.domain(text)
    without = text.replace("then 0.5: open(?d)\n         rest: noise", "then 1: noise").replace(
        "oil(?d - door) [duration = 10 s]", "oil(?d - door) [duration = 8 s, cost = 0.25]"
    )
    actual = from_text.domain(without)
    given = doors.problem(known)
    who = Agent(doors.saying("oil(a)"), known, given)
    found = episode(world_of(actual, given), who, 0, Options(), EpisodeLimits(max_actions=3))
    assert (found.reason, found.success) == (Reason.LIMIT, False)
    assert found.plain == pytest.approx(-0.75)
    assert found.seconds == pytest.approx(24)
    timed = world_of(actual, given, timed=True)
    first = do(timed, timed.task.initial, found.actions[0], np.random.default_rng(0))[0]
    assert first.discount == pytest.approx(
        0.95 ** (8 / 4)
    )  # here nothing comes of oil, so pushing is the pace


def test_the_pace_is_that_of_what_has_an_effect_somewhere() -> None:
    """Not of what happens to occur: here no door can be pushed, and knocking does nothing anywhere."""
    text = doors.DOORS.replace("actions    {", "actions    { knock() [duration = 99 s] ").replace(
        "  reward", "  rule k: knock() { then 1: nothing }\n  reward"
    )
    known = from_text.domain(text)
    given = doors.problem(known, "init { jammed(a), jammed(b), force(a) = 1, force(b) = 1 }")
    world = world_of(known, given, timed=True)
    rng = np.random.default_rng(0)
    expected = {"push(a)": 4.0, "oil(a)": 10.0, "knock()": 99.0}
    for said, seconds in expected.items():
        (action,) = doors.saying(said)(
            Agent(doors.saying(), known, given).prepared(given.state, 30), Options()
        ).actions
        assert do(world, world.task.initial, action, rng)[0].discount == pytest.approx(0.95 ** (seconds / 7))


def test_robot_time_needs_every_duration() -> None:
    text = doors.DOORS.replace("[duration = 4 s, cost = 1]", "[cost = 1]")
    assert run(text, "oil(a)", max_actions=2).seconds is not None
    assert run(text, "push(a)", max_actions=2).seconds is None
    with pytest.raises(NoDurationError, match="push"):
        world_of(from_text.domain(text), PROBLEM, timed=True)


# ---- what thinking costs


def thinking(
    text: str, actions: int, monkeypatch: pytest.MonkeyPatch, *, timed: bool, **limits: Any
) -> tuple[World, Episode]:
    """An episode in which a planner thinks for 3 s for each of so many plans, and 7 s for the last one, which
    is to do nothing."""
    known, clock = from_text.domain(text), itertools.count()
    given = doors.problem(known, f"{doors.TWO_DOORS} horizon = 9 goal {{ jammed(a) }}")
    now = [0.0]

    def planner(prepared: Prepared, options: Options) -> Plan:
        if next(clock) == actions:
            now[0] += 7.0
            return doors.plan(prepared, ())
        now[0] += 3.0
        return doors.saying("push(a)", "oil(b)")(prepared, options)

    monkeypatch.setattr("cleancli.simulation.agent.time.perf_counter", lambda: now[0])
    world = world_of(known, given, timed)
    who = Agent(planner, known, given, "time" if timed else None)
    return world, episode(world, who, 1, Options(), EpisodeLimits(**limits))


@pytest.mark.parametrize("commit", [1, 2])
@pytest.mark.parametrize("think", [False, True])
@pytest.mark.parametrize("text", [doors.DOORS, doors.PAID])
def test_what_is_paid_after_thinking_is_worth_less_by_its_time(
    text: str, think: bool, commit: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    world, found = thinking(text, 2, monkeypatch, timed=True, commit=commit, max_actions=9, think=think)
    assert found.reason is Reason.IDLE
    assert len(found.actions) == 2 * commit
    time, expected = 0.0, 0.0
    for number, (_, step, _) in enumerate(replayed(world, found, 0)):
        time += 3.0 * (think and number % commit == 0) + (step.seconds or 0.0)
        expected += 0.95 ** (time / 7 - 1) * step.reward  # a step is 7 s: pushing 4, oiling 10
    time += 7.0 * think
    *_, (_, _, last) = replayed(world, found, 0)
    rest = range(9 - len(found.actions))
    expected += standing(world.task, last) * sum(0.95 ** (time / 7 + k) for k in rest)
    assert found.discounted == pytest.approx(expected)
    assert found.seconds == pytest.approx(time)
    assert found.planning == pytest.approx((3.0, 3.0, 7.0))


def test_where_steps_discount_thinking_takes_robot_time_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    ended = [
        thinking(doors.PAID, 3, monkeypatch, timed=False, max_actions=9, think=think)[1]
        for think in (False, True)
    ]
    assert ended[0].discounted == ended[1].discounted
    assert [each.seconds for each in ended] == pytest.approx([12.0, 12.0 + 3 * 3.0 + 7.0])


def test_thinking_needs_robot_time() -> None:
    known = from_text.domain(doors.DOORS.replace("[duration = 4 s, cost = 1]", "[cost = 1]"))
    quiet = Planner("quiet", lambda prepared, *_: doors.plan(prepared, ()), None)
    setup = batch.Batch(known, known, PROBLEM, (quiet,), Options(), EpisodeLimits(think=True))
    with pytest.raises(NoDurationError, match="push"):
        next(batch.rounds(setup, [0]))


# ---- why episodes end


def test_reasons() -> None:
    goal = f"{doors.TWO_DOORS} goal {{ open(a) }}"
    assert run(doors.DOORS, "oil(a)", inside=goal).reason is Reason.GOAL
    assert run(doors.DOORS, "oil(b)", inside=goal, max_actions=9).reason is Reason.LIMIT
    assert run(doors.DOORS, "oil(a)", "oil(b)", commit=2).reason is Reason.CLEARED
    assert run(doors.DOORS).reason is Reason.IDLE
    assert run(doors.DOORS, "oil(a)", max_actions=0).reason is Reason.LIMIT
    open_already = "init { open(a), open(b), force(a) = 1, force(b) = 1 }"
    assert run(doors.DOORS, "oil(a)", inside=open_already, max_actions=0).reason is Reason.CLEARED
    endless = run(doors.PAID, "push(a)", inside=f"{doors.TWO_DOORS} {STEPS}", max_actions=7)
    assert (endless.reason, endless.success, len(endless.actions)) == (Reason.LIMIT, None, 7)


def test_a_goal_that_can_never_hold_is_no_success() -> None:
    found = run(doors.DOORS, "oil(b)", inside=f"{doors.TWO_DOORS} goal {{ jammed(a) }}", max_actions=3)
    assert (found.reason, found.success) == (Reason.LIMIT, False)


def test_an_episode_ends_amid_a_plan() -> None:
    found = run(doors.DOORS, *["oil(a)"] * 9, commit=9, inside=f"{doors.TWO_DOORS} goal {{ open(a) }}")
    assert found.reason is Reason.GOAL
    assert len(found.actions) < 9
    assert len(found.planning) == 1


# ---- what is drawn


def test_an_episode_depends_on_seed_and_number_alone() -> None:
    goal = f"{doors.TWO_DOORS} goal {{ open(a) }}"
    alone = [run(doors.DOORS, "push(a)", number=n, inside=goal).actions for n in (3, 5)]
    given = doors.problem(DOORS, goal)
    world, who = world_of(DOORS, given), Agent(doors.saying("push(a)"), DOORS, given)
    together = [episode(world, who, n, Options(), EpisodeLimits()).actions for n in range(6)]
    assert [together[3], together[5]] == alone
    assert len({len(actions) for actions in together}) > 1


def test_the_nth_action_meets_the_same_luck_whatever_came_before() -> None:
    """Pushing an open door draws nothing, and yet uses up its number."""
    world = world_of(DOORS, PROBLEM)
    push = doors.saying("push(a)", "push(b)")
    a, b = push(Agent(push, DOORS, PROBLEM).prepared(PROBLEM.state, COUNTED), Options()).actions
    opened = assignment_of(world.task, PROBLEM.state | {Fact("open", ("a",))})
    assert opened is not None
    for seed in range(20):
        first, second = np.random.default_rng(seed), np.random.default_rng(seed)
        do(world, opened, a, first)
        do(world, world.task.initial, a, second)
        luck = [do(world, world.task.initial, b, rng)[0].reward for rng in (first, second)]
        assert luck[0] == luck[1]


# ---- what planners are shown


def test_horizons_and_rests_of_plans() -> None:
    asked: list[tuple[int, int, tuple[str, ...]]] = []

    def planner(prepared: Prepared, options: Options) -> Plan:
        asked.append((prepared.task.horizon, options.seed, tuple(map(str, options.previous))))
        return doors.plan(prepared, prepared.task.actions[:2])

    known = from_text.domain(doors.PAID)
    given = doors.problem(known, f"{doors.TWO_DOORS} {STEPS}")
    who = Agent(planner, known, given)
    episode(world_of(known, given), who, 0, Options(), EpisodeLimits(max_actions=3, horizon=3))
    assert [horizon for horizon, _, _ in asked] == [3, 2, 1]
    assert [rest for _, _, rest in asked] == [(), ("oil(b)",), ("oil(b)",)]
    assert len({seed for _, seed, _ in asked}) == 3
    asked.clear()
    episode(world_of(known, given), who, 0, Options(), EpisodeLimits(max_actions=3, commit=2))
    assert [horizon for horizon, _, _ in asked] == [5, 5]


def test_the_horizon_is_that_of_the_present_state() -> None:
    who = Agent(doors.saying(), DOORS, PROBLEM)
    assert who.prepared(PROBLEM.state, COUNTED).task.horizon == 3
    assert who.prepared(PROBLEM.state | {Fact("open", ("b",))}, COUNTED).task.horizon == 2


def test_rules_are_grounded_again_only_for_what_they_cannot_change(monkeypatch: pytest.MonkeyPatch) -> None:
    grounded: list[Domain] = []

    def counted(domain: Domain, problem: Problem) -> Task:
        grounded.append(domain)
        return ground(domain, problem)

    monkeypatch.setattr(agents, "ground", counted)
    who = Agent(doors.saying(), DOORS, PROBLEM)
    jammed = PROBLEM.state | {Fact("jammed", ("a",))}
    stronger = frozenset(fact for fact in jammed if fact.objects != ("a",)) | {
        Fact("jammed", ("a",)),
        Fact("force", ("a",), 2),
    }
    for facts, times in [
        (PROBLEM.state, 1),
        (PROBLEM.state | {Fact("open", ("a",))}, 1),
        (jammed, 2),
        (stronger, 3),
        (jammed | {Fact("open", ("b",))}, 3),
        (PROBLEM.state, 3),
    ]:
        task = who.prepared(facts, COUNTED).task
        assert len(grounded) == times
        view = StateView(DOORS, PROBLEM.objects, facts)
        assert all(
            view.value((v.symbol, v.objects)) == v.values[i]
            for v, i in zip(task.variables, task.initial, strict=True)
        )
    assert [str(a) for a in who.prepared(jammed, COUNTED).task.actions] == ["oil(a)", "oil(b)", "push(b)"]


def test_a_world_may_do_what_the_planner_does_not_expect() -> None:
    """A planner that always pushes the first door that it can push: with its own rules it opens all; where
    doors jam it stops when both do."""

    def pushing(prepared: Prepared, options: Options) -> Plan:
        task = prepared.task
        shut = {v.objects for v, i in zip(task.variables, task.initial, strict=True) if not v.values[i]}
        return doors.plan(prepared, [a for a in task.actions if a.name == "push" and a.objects in shut][:1])

    given = doors.problem(DOORS)
    own = [
        episode(world_of(DOORS, given), Agent(pushing, DOORS, given), n, Options(), EpisodeLimits())
        for n in range(40)
    ]
    assert all(each.success for each in own)
    who = Agent(pushing, DOORS, given)
    jam = [episode(world_of(JAMMING, given), who, n, Options(), EpisodeLimits()) for n in range(200)]
    assert {each.reason for each in jam} == {Reason.CLEARED, Reason.IDLE}
    assert sum(bool(each.success) for each in jam) == pytest.approx(200 * 0.36, abs=30)


def test_success_without_goal_is_an_empty_count() -> None:
    world = world_of(DOORS, PROBLEM)
    assert succeeded(world, world.task.initial) is False
    assert succeeded(world_of(PAID, PROBLEM), ()) is None


def test_what_a_process_refuses_is_refused_here_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads in place of processes, which would not know this planner; the first episode is run before."""

    def late(prepared: Prepared, options: Options, own: None) -> Plan:
        if prepared.task.horizon < 3:
            raise NoDurationError(["push"])
        return doors.plan(prepared, prepared.task.actions[:1])

    monkeypatch.setattr(batch, "ProcessPoolExecutor", lambda jobs, context: ThreadPoolExecutor(jobs))
    setup = batch.Batch(
        DOORS, DOORS, PROBLEM, (Planner("late", late, None),), Options(), EpisodeLimits(max_actions=1)
    )
    assert len(list(batch.spread(setup, 9, 2))) == 9
    found = batch.spread(
        replace(setup, limits=EpisodeLimits(max_actions=2), options=Options(seed=UNLUCKY)), 9, 2
    )
    assert next(found)[0].number == 0
    with pytest.raises(NoDurationError) as error:
        list(found)
    assert error.value.actions == ("push",)


def test_streams_of_an_episode_keep_their_numbers_for_ever() -> None:
    """They are part of what a seed means: with others the same seed would be another episode."""
    assert {stream.name: stream.value for stream in episodes._Stream} == {"WORLD": 0, "PLANNING": 1}
