"""The compiled process against compiler/semantics.py, which says the same slowly."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.lowering.state_tables import lower_process
from cleancli.compiler.semantics import (
    covering_rule,
    exact_value,
    reward,
    standing,
    successors,
)
from cleancli.compiler.task import GroundState, NoDurationError, Task, by_time, holds, lasting
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.planning.evaluation.belief_value import plan_value
from cleancli.planning.kernels import transitions
from cleancli.planning.refusal import planning_refused
from support import reference_prada, small_tasks

SEEDS = range(12)


def some_states(task: Task, seed: int, number: int) -> list[GroundState]:
    rng = np.random.default_rng([seed, 7])
    return [tuple(int(rng.integers(len(v.values))) for v in task.variables) for _ in range(number)]


def array(assignment: GroundState) -> np.ndarray:
    return np.array(assignment, dtype=np.int32)


@pytest.mark.parametrize("seed", SEEDS)
def test_conditions_rules_and_rewards_are_those_of_the_task(seed: int) -> None:
    task = replace(small_tasks.weighted_task(seed), goal=(((0, frozenset({0})), (1, frozenset({1}))),))
    process = lower_process(task)
    conditions = [*(r.condition for r in task.rules), *(r.condition for r in task.rewards), *task.goal]
    for assignment in some_states(task, seed, 30):
        state = array(assignment)
        assert [transitions.holds(process, state, c) for c in range(len(conditions))] == [
            holds(condition, assignment) for condition in conditions
        ]
        for action in range(len(task.actions)):
            found = transitions.covering(process, state, action)
            assert (task.rules[found] if found >= 0 else None) == covering_rule(task, assignment, action)
        assert transitions.rewarded(process, state)[1] == pytest.approx(standing(task, assignment))


@pytest.mark.parametrize("seed", SEEDS)
def test_drawn_steps_have_declared_frequencies_and_rewards(seed: int) -> None:
    task = small_tasks.weighted_task(seed)
    process, draws = lower_process(task), 4000
    assignment = some_states(task, seed, 1)[0]
    for action in range(len(task.actions)):
        expected = {after: p for p, after in successors(task, assignment, action)}
        seen: Counter[GroundState] = Counter()
        for k in range(draws):
            state = array(assignment)
            paid, rise, _ = transitions.step(process, state, action, (k + 0.5) / draws)
            after = tuple(state.tolist())
            seen[after] += 1
            total = paid + rise + standing(task, assignment)
            assert total == pytest.approx(reward(task, assignment, action, after))
        assert {after: n / draws for after, n in seen.items()} == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_sequence_is_worth_what_its_exact_value_says(seed: int) -> None:
    task = small_tasks.weighted_task(seed)
    task = small_tasks.timed(task) if seed % 2 else task
    rng = np.random.default_rng(seed)
    actions = rng.integers(len(task.actions), size=4)
    idle = np.concatenate([[0.0], np.cumsum(task.discount ** np.arange(task.horizon))])
    process, samples = lower_process(task), 20_000
    mean, square = transitions.sequence_value(
        process, array(task.initial), actions.astype(np.int32), idle, samples, np.uint64(seed)
    )
    error = np.sqrt(max(square - mean**2, 1e-12) / samples)
    assert abs(mean - exact_value(task, actions.tolist())) < stats.norm.isf(1e-5) * error


def test_time_discounts_by_duration() -> None:
    task = small_tasks.timed(small_tasks.weighted_task(1))
    assert task.discounts == pytest.approx([0.9 ** ((i + 1) / 3.5) for i in range(6)])
    for actions in ([0], [5], [5, 0, 3, 3]):
        value, factor, distribution = 0.0, 1.0, {task.initial: 1.0}
        seconds = 0.0
        for action in actions:
            seconds += task.actions[action].duration or 0.0
            after: dict[GroundState, float] = {}
            paid = 0.0
            for state, mass in distribution.items():
                for p, s in successors(task, state, action):
                    after[s] = after.get(s, 0.0) + mass * p
                    paid += mass * p * reward(task, state, action, s)
            factor = 0.9 ** (seconds / 3.5)
            value += factor / 0.9 * paid
            distribution = after
        rest = sum(mass * standing(task, s) for s, mass in distribution.items())
        value += factor * rest * sum(0.9**k for k in range(task.horizon - len(actions)))
        assert exact_value(task, actions) == pytest.approx(value)
        assert plan_value(task, actions) == pytest.approx(reference_prada.value(task, actions), abs=1e-9)


def test_equal_durations_discount_as_steps_do() -> None:
    task = small_tasks.weighted_task(3)
    equal = replace(task, actions=tuple(replace(a, duration=4.0) for a in task.actions), step=4.0, untimed=())
    assert by_time(equal).discounts == pytest.approx(task.discounts)


def test_time_needs_durations() -> None:
    nothing = replace(small_tasks.random_task(0), untimed=(), actions=(), rules=(), discounts=(), step=None)
    assert by_time(nothing) == nothing, "a domain without actions has nothing to discount"
    with pytest.raises(NoDurationError, match="act0"):
        by_time(small_tasks.random_task(0))


def test_each_action_that_is_said_to_lack_a_duration_is_a_mistake_where_it_is_declared() -> None:
    text = "domain d { types { area } actions { rub(?a - area) wipe(?a - area) dry(?a - area) } }"
    sources = [Source("d.nid", text)] * 2
    with pytest.raises(Refused) as refused, planning_refused(sources):
        raise NoDurationError(["wipe"])
    (mistake,) = refused.value.diagnostics
    assert (mistake.code, mistake.span) == ("E902", Span("d.nid", text.index("wipe"), text.index("wipe") + 4))


def test_an_action_lasts_as_long_as_it_does_on_its_objects() -> None:
    """docs/planning.md, "By time": a step is the mean over actions on objects."""
    task = small_tasks.timed(small_tasks.random_task(3))
    first, *others = task.actions
    known = lasting(task, {first.key: 100.0})
    seconds = [100.0, *(action.duration or 0.0 for action in others)]
    assert [action.duration for action in known.actions] == seconds
    step = sum(seconds) / len(seconds)
    discounts = [task.discount ** (each / step) for each in seconds]
    assert by_time(known).discounts == pytest.approx(discounts)
    assert lasting(task, {}) == task, "where nothing is known, the domain says all"
    untimed = small_tasks.random_task(3)
    with pytest.raises(NoDurationError):
        by_time(lasting(untimed, {untimed.actions[0].key: 2.0}))
    everything = lasting(untimed, {action.key: 2.0 for action in untimed.actions})
    assert by_time(everything).discounts == (task.discount,) * len(task.actions)
