"""Small tasks in plain Python: to the last bit what compiled code finds, and only where they are small."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from cleancli.compiler.semantics import successors
from cleancli.compiler.task import Task
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.kernels import backward_induction, state_graph
from cleancli.planning.plan import Options, Plan, TooManyStatesError
from cleancli.planning.planners import exact, plain_graph
from cleancli.planning.registry import PLANNERS
from support import small_tasks

KINDS = (small_tasks.random_task, small_tasks.weighted_task, small_tasks.costly_task)


def timed(seed: int) -> Task:
    return small_tasks.timed(small_tasks.weighted_task(seed))


@pytest.mark.parametrize("horizon", [0, 1, 2, 5, 9])
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", [*KINDS, timed])
def test_numbers_are_those_of_compiled_code_to_the_last_bit(
    kind: Callable[[int], Task], seed: int, horizon: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plain_graph, "WORK", 10**9)
    monkeypatch.setattr(kernels, "are_loaded", lambda: False)
    prepared = prepare(replace(kind(seed), horizon=horizon))
    task, process = prepared.forgetful.task, prepared.forgetful.process
    compiled = state_graph.reachable(process, task.initial, 10_000, horizon)
    found = exact.at_hand(prepared, 10_000)
    assert found is not None
    assert compiled is not None
    assert [list(state) for state in found.enumeration.numbers] == compiled.states.tolist()
    assert found.within.tolist() == compiled.within.tolist()
    assert found.enumeration.transitions == len(compiled.edge_successor)
    values, best = backward_induction.backward(compiled, process, task.discount, horizon)
    assert (found.values.shape, found.best.shape) == (values.shape, best.shape)
    assert found.values.tolist() == values.tolist()
    assert found.best.tolist() == best.tolist()


@pytest.mark.parametrize("horizon", [1, 3, 6])
def test_what_is_more_work_than_a_small_task_may_be_is_left_to_compiled_code(
    horizon: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = replace(small_tasks.weighted_task(1), horizon=horizon)
    monkeypatch.setattr(plain_graph, "WORK", 10**9)
    found = plain_graph.small_graph(task)
    assert found is not None
    work = len(found.choices) * len(task.rules) + horizon * found.transitions
    monkeypatch.setattr(plain_graph, "WORK", work)
    assert plain_graph.small_graph(task) is not None
    monkeypatch.setattr(plain_graph, "WORK", work - 1)
    assert plain_graph.small_graph(task) is None


def test_of_a_task_with_many_rules_no_state_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    task = small_tasks.weighted_task(1)
    monkeypatch.setattr(plain_graph, "WORK", len(task.rules) * task.horizon * plain_graph.FEW_STATES)
    assert plain_graph.may_be_small(task)
    assert not plain_graph.may_be_small(replace(task, horizon=task.horizon + 1))


def test_a_state_that_was_not_reached_has_no_number() -> None:
    task = small_tasks.weighted_task(0)
    found = plain_graph.small_graph(replace(task, horizon=0))
    assert found is not None
    assert found.index(task.initial) == 0
    assert found.index((*task.initial[:-1], 7)) == -1


def episode(planner: str, prepared: Prepared) -> list[Plan]:
    """The plans from the initial state, and from those that an action may lead to, but for their seconds."""
    task, plan = prepared.task, PLANNERS[planner]
    first = plan(prepared, Options())
    after = [plan(prepared.at(s, task.horizon - 1), Options()) for _, s in successors(task, task.initial, 2)]
    return [replace(each, seconds={}) for each in (first, *after)]


@pytest.mark.parametrize("planner", ["exact", "prada+"])
@pytest.mark.parametrize("seed", range(3))
def test_no_plan_depends_on_what_has_been_loaded(
    planner: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither the first one of an episode nor those that follow, for which nothing is worked out again."""
    task = small_tasks.weighted_task(seed)
    compiled = episode(planner, prepare(task))
    monkeypatch.setattr(kernels, "are_loaded", lambda: False)
    monkeypatch.setattr(plain_graph, "WORK", 10**9)
    looked_at: list[Task] = []

    def small_graph(task: Task) -> plain_graph.PlainGraph[float] | None:
        looked_at.append(task)
        return found(task)

    found = plain_graph.small_graph
    monkeypatch.setattr(plain_graph, "small_graph", small_graph)
    assert episode(planner, prepare(task)) == compiled
    assert len(looked_at) == 1


def test_limits_of_planners_hold_for_small_tasks_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "are_loaded", lambda: False)
    monkeypatch.setattr(plain_graph, "WORK", 10**9)
    prepared = prepare(small_tasks.weighted_task(0))
    with pytest.raises(TooManyStatesError, match="the limit is 3"):
        PLANNERS["exact"].having(states=3)(prepared, Options())
    assert exact.at_hand(prepared, 10_000, 5) is None
    assert exact.at_hand(prepared, 10_000, 10_000) is not None
