"""Enumerated states and the optimal policy against a plain recursion over compiler/semantics.py."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from cleancli.compiler.lowering.state_tables import lower_process
from cleancli.compiler.semantics import covering_rule, exact_value, progress, reward, successors
from cleancli.compiler.task import (
    GroundCondition,
    GroundOutcome,
    GroundRule,
    GroundState,
    StateVariable,
    Task,
)
from cleancli.language.model import OutcomeKind
from cleancli.planning.compiled_task import prepare
from cleancli.planning.kernels.backward_induction import backward
from cleancli.planning.kernels.state_graph import Graph, reachable
from cleancli.planning.plan import Plan, TooManyStatesError
from cleancli.planning.planners import exact as known_states
from cleancli.planning.planners import rational
from support import from_text, optimal, small_tasks
from support.planned import planned


def optimum(task: Task) -> Callable[[GroundState, int], float]:
    """The optimal value of a state with so many steps left, slowly."""
    best = optimal.optimum(task)
    return lambda state, left: best(state, left)[0]


def graph(task: Task, steps: int, limit: int = 10_000) -> Graph:
    found = reachable(lower_process(task), task.initial, limit, steps)
    assert found is not None
    return found


@pytest.mark.parametrize("seed", range(8))
def test_the_graph_is_the_process(seed: int) -> None:
    task = small_tasks.weighted_task(seed)
    found = graph(task, 3)
    states = [tuple(row) for row in found.states.tolist()]
    number = {state: index for index, state in enumerate(states)}
    assert len(number) == len(states) == found.within[-1]
    assert states[0] == task.initial
    near = {task.initial}
    for within in found.within:
        assert set(states[:within]) == near
        near |= {s for state in near for a in range(6) for _, s in successors(task, state, a)}
    for index in range(int(found.within[-2])):
        choices = range(*found.choice_start[index : index + 2])
        covered = [a for a in range(6) if covering_rule(task, states[index], a) is not None]
        assert found.choice_action[choices].tolist() == covered
        for choice, action in zip(choices, covered, strict=True):
            edges = slice(*found.edge_start[choice : choice + 2])
            after = {states[s]: p for p, s in _edges(found, edges)}
            expected = {s: p for p, s in successors(task, states[index], action)}
            assert after == pytest.approx(expected)
            paid = sum(p * reward(task, states[index], action, s) for s, p in expected.items())
            assert found.choice_reward[choice] == pytest.approx(paid)
            gained = sum(p * progress(task, states[index], s) for s, p in expected.items())
            assert found.choice_progress[choice] == pytest.approx(gained)


def _edges(found: Graph, edges: slice) -> list[tuple[float, int]]:
    return list(
        zip(found.edge_probability[edges].tolist(), found.edge_successor[edges].tolist(), strict=True)
    )


@pytest.mark.parametrize("seed", range(8))
def test_backward_induction_is_the_recursion(seed: int) -> None:
    task = small_tasks.weighted_task(seed)
    found, value = graph(task, 4), optimum(task)
    values, _ = backward(found, lower_process(task), task.discount, 4)
    for step, within in enumerate(found.within[:4].tolist()):
        expected = [value(tuple(row), 4 - step) for row in found.states[:within].tolist()]
        assert values[step, :within] == pytest.approx(expected, abs=1e-12)


def test_too_many_states_are_none_and_room_grows() -> None:
    task = small_tasks.random_task(3)
    number = len(graph(task, 5).states)
    assert len(graph(task, 5, number).states) == number
    assert reachable(lower_process(task), task.initial, number - 1, 5) is None
    assert np.array_equal(graph(task, 0).states, [task.initial])


@pytest.mark.parametrize("first", range(0, 600, 60))
def test_every_state_is_found_once_wherever_its_hash_leads(first: int) -> None:
    """Of 600 states, some have a place in the table that another one holds, be it the first one."""
    number = 600
    outcomes = tuple(
        GroundOutcome(Fraction(1, number), OutcomeKind.CHANGE, ((0, value),)) for value in range(number)
    )
    task = replace(
        small_tasks.random_task(0),
        variables=(StateVariable("v", ("0",), tuple(range(number))),),
        initial=(first,),
        rules=(GroundRule(0, 0, (), outcomes),),
        rewards=(),
        counted=None,
    )
    assert sorted(graph(task, 1).states[:, 0].tolist()) == list(range(number))


def exact(task: Task, **options: Any) -> Plan:
    return planned("exact", task, **options)


@pytest.mark.parametrize("seed", range(8))
def test_floats_fractions_and_the_recursion_agree(seed: int) -> None:
    task = replace(small_tasks.weighted_task(seed), horizon=3)
    if seed % 2:
        task = small_tasks.timed(task)
    plan = exact(task)
    assert plan.value == pytest.approx(optimum(task)(task.initial, 3), abs=1e-12)
    slow = exact(task, arithmetic="rational")
    assert slow.value == pytest.approx(plan.value, abs=1e-12)
    assert slow.actions == plan.actions


@pytest.mark.parametrize("seed", range(8))
def test_no_sequence_is_worth_more(seed: int) -> None:
    task = replace(small_tasks.weighted_task(seed), horizon=3)
    plan = exact(task)
    rng = np.random.default_rng(seed)
    sequences = [rng.integers(6, size=3).tolist() for _ in range(50)]
    sequences.append([task.actions.index(action) for action in plan.actions])
    assert plan.value >= max(exact_value(task, sequence) for sequence in sequences) - 1e-12


def test_fractions_have_no_rounding() -> None:
    task = replace(
        from_text.task(small_tasks.SECTION_4, small_tasks.TWO_SCATTERED), discount=0.1, discounts=(0.1,) * 4
    )
    value, _ = rational.optimum(replace(task, horizon=2), 100)
    clean = Fraction(1, 2) + Fraction(1, 10) * Fraction(1, 2)
    join = Fraction(1, 2) + Fraction(1, 10) * (
        Fraction(3, 10) * Fraction(1, 2)
        + Fraction(2, 10) * Fraction(8, 10)
        + Fraction(5, 10) * Fraction(1, 2)
    )
    assert value == max(clean, join)


@pytest.mark.parametrize("horizon", [1, 0, -1])
def test_the_optimum_counts_the_steps_that_are_left(horizon: int) -> None:
    """A horizon that counts areas may have come below nothing."""
    task = replace(small_tasks.weighted_task(2), horizon=horizon)
    prepared = prepare(task)
    value, _ = known_states.worth(prepared, known_states.optimum(prepared, 1000))
    assert value == pytest.approx(optimum(task)(task.initial, max(horizon, 0)))


def test_the_example_of_section_4_seen_through() -> None:
    task = from_text.task(small_tasks.SECTION_4, small_tasks.TWO_SCATTERED)
    plan = exact(task)
    assert plan.measure == "policy"
    assert [str(a) for a in plan.actions] == [
        "join(a, b)",
        "clean(b)",
    ]  # join is tried again where it changes nothing
    assert plan.value == pytest.approx(optimum(task)(task.initial, task.horizon))


@pytest.mark.parametrize("arithmetic", ["float", "rational"])
def test_too_many_states_are_refused(arithmetic: str) -> None:
    task = small_tasks.random_task(3)
    with pytest.raises(TooManyStatesError) as refused:
        exact(task, states=10, arithmetic=arithmetic)
    assert refused.value.limit == 10
    assert refused.value.reached > 10


def guarded(seed: int) -> Task:
    """A random task where nothing is asked or paid once variable 0 or 1 has taken its last value."""
    task = small_tasks.weighted_task(seed)
    before_last = {v: frozenset(range(len(task.variables[v].values) - 1)) for v in (0, 1)}

    def guard(condition: GroundCondition) -> GroundCondition:
        literals = dict(condition)
        literals |= {v: literals.get(v, values) & values for v, values in before_last.items()}
        return tuple(sorted(literals.items()))

    return replace(
        task,
        rules=tuple(replace(rule, condition=guard(rule.condition)) for rule in task.rules),
        rewards=tuple(replace(reward, condition=guard(reward.condition)) for reward in task.rewards),
    )


@pytest.mark.parametrize("seed", range(12))
def test_what_is_forgotten_changes_no_value(seed: int) -> None:
    task = replace(guarded(seed), horizon=3)
    for assignment in itertools.product(*(range(len(v.values)) for v in task.variables[:2])):
        moved = replace(task, initial=(*assignment, *task.initial[2:]))
        expected = optimum(moved)(moved.initial, 3)
        assert optimum(prepare(moved).forgetful.task)(
            prepare(moved).forgetful.task.initial, 3
        ) == pytest.approx(expected)
        assert exact(moved).value == pytest.approx(expected)


def test_a_clean_area_is_the_same_scattered_or_not() -> None:
    task = from_text.task(
        small_tasks.SECTION_4, "objects { a b c - area } init { dirt(a), dirt(b), scattered(c) }"
    )
    assert len(graph(task, 3).states) > len(graph(prepare(task).forgetful.task, 3).states) == 6
    assert exact(task).value == pytest.approx(optimum(task)(task.initial, task.horizon))
