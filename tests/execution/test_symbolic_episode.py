"""The loop in the symbolic world, and that a checkpoint is all that it takes to go on."""

from __future__ import annotations

import copy
from dataclasses import replace

import pytest

from cleancli.execution.episode_state import EpisodeState
from cleancli.execution.events import Acted, Checkpoint, Decided, Ended, Event, Started
from cleancli.execution.loop import clean
from cleancli.execution.session import Session, symbolic_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.execution.symbolic_cell import SymbolicCell
from cleancli.language.model import Fact, Object, Problem
from support.shipped import shipped_domain, shipped_problem

DOMAIN = shipped_domain("cleaning")
PROBLEM = shipped_problem("three_areas", DOMAIN)


def session(seed: int = 1, problem: Problem = PROBLEM, **options: object) -> Session:
    chosen = EpisodeOptions(samples=200, seed=seed, by_time=True, **options)  # type: ignore[arg-type]
    return symbolic_session(DOMAIN, problem, chosen)


def moves(events: list[Event]) -> list[tuple[int, str]]:
    return [(event.number, str(event.move)) for event in events if isinstance(event, Started)]


def end_of(events: list[Event]) -> Ended:
    ended = events[-1]
    assert isinstance(ended, Ended)
    return ended


def test_the_symbolic_world_gets_clean() -> None:
    here = session()
    events = list(clean(here.setup, here.cell))
    ended = end_of(events)
    assert ended.clean
    acted = [event for event in events if isinstance(event, Acted)]
    assert len(acted) == ended.actions > 1
    assert all(event.seen and event.transition is not None for event in acted)
    assert ended.spent.actions == ended.clock == sum(event.seconds for event in acted) > 10


@pytest.mark.parametrize("strategy", ["plan-1", "plan-2", "plan-3", "plan-all", "determinized"])
def test_the_same_seed_does_the_same(strategy: str) -> None:
    def once(seed: int) -> list[tuple[int, str]]:
        here = session(seed, strategy=strategy)
        return moves(list(clean(here.setup, here.cell)))

    assert once(3) == once(3)
    assert len({tuple(once(seed)) for seed in range(6)}) > 1


@pytest.mark.parametrize(("strategy", "commit"), [("plan-1", 1), ("plan-2", 2), ("plan-3", 3)])
def test_so_many_actions_are_carried_out_before_planning_again(strategy: str, commit: int) -> None:
    names = [f"a{number}" for number in range(6)]
    small = {Fact("size", (name,), "small") for name in names} | {Fact("dirt", (name,)) for name in names}
    six = replace(PROBLEM, objects=tuple(Object(name, "area") for name in names), state=frozenset(small))
    here = session(3, six, strategy=strategy)
    events = list(clean(here.setup, here.cell))
    decided = [(event.moves, event.plan) for event in events if isinstance(event, Decided)]
    lengths = [(len(moves), len(plan.actions)) for moves, plan in decided if plan is not None]
    assert [carried_out for carried_out, _ in lengths] == [min(commit, planned) for _, planned in lengths]
    assert max(planned for _, planned in lengths) > commit


def test_a_run_goes_on_from_every_checkpoint_as_if_never_stopped() -> None:
    here = session(2)
    assert isinstance(here.cell, SymbolicCell)
    points: list[tuple[EpisodeState, object, float]] = []
    events: list[Event] = []
    for event in clean(here.setup, here.cell):
        events.append(event)
        if isinstance(event, Checkpoint):
            points.append((copy.deepcopy(event.state), here.cell.assignment, here.cell.clock))
    for state, assignment, clock in points:
        again = session(2)
        assert isinstance(again.cell, SymbolicCell)
        again.cell.assignment, again.cell.clock = assignment, clock  # type: ignore[assignment]
        rest = list(clean(again.setup, again.cell, state))
        assert moves(rest) == moves(events)[state.actions :]
        assert end_of(rest).clock == end_of(events).clock
        assert end_of(rest).reason == end_of(events).reason


def test_the_limit_of_actions_holds() -> None:
    here = session(1, max_actions=1)
    ended = end_of(list(clean(here.setup, here.cell)))
    assert (ended.clean, ended.actions) == (False, 1)
