"""Values and expectations of given sequences against compiler/semantics.py, which says the same slowly."""

from __future__ import annotations

import pickle
from collections import defaultdict
from collections.abc import Mapping

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.semantics import (
    SupportTooLargeError,
    covering_rule,
    decreasing,
    exact_value,
    forward,
    standing,
)
from cleancli.compiler.task import GroundState, Task, held
from cleancli.planning.compare import compared
from cleancli.planning.compiled_task import prepare
from cleancli.planning.evaluation.belief_value import plan_beliefs
from cleancli.planning.evaluation.forecast import Forecast, exact_course, forecast
from cleancli.planning.evaluation.value import evaluate, exact
from cleancli.planning.plan import Options, TooManyStatesError
from cleancli.planning.registry import PLANNERS
from support import reference_prada, small_tasks

SEEDS = range(6)


def case(seed: int) -> tuple[Task, list[int]]:
    task = small_tasks.weighted_task(seed)
    task = small_tasks.timed(task) if seed % 2 else task
    return task, np.random.default_rng(seed).integers(len(task.actions), size=4).tolist()


def course(task: Task, actions: list[int]) -> list[Mapping[GroundState, float]]:
    found: list[Mapping[GroundState, float]] = [{task.initial: 1.0}]
    for action in actions:
        found.append(forward(task, found[-1], action))
    return found


@pytest.mark.parametrize("seed", SEEDS)
def test_the_three_values_of_a_sequence(seed: int) -> None:
    task, actions = case(seed)
    for sequence in (actions, [], [*actions, *actions]):  # longer than the horizon, too
        found = evaluate(prepare(task), sequence, Options(seed=seed), runs=20_000)
        assert found.exact == pytest.approx(exact_value(task, sequence))
        assert found.factored == pytest.approx(reference_prada.value(task, sequence))
        assert found.sampled is not None
        assert abs(found.sampled.value - exact_value(task, sequence)) <= (
            stats.norm.isf(1e-5) * found.sampled.error + 1e-9
        )
        assert (found.sampled.error > 1e-6) == bool(sequence)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_distribution_is_the_exact_one(seed: int) -> None:
    task, actions = case(seed)
    found = exact_course(prepare(task), actions, 1000)
    for spread, expected in zip(found, course(task, actions), strict=True):
        states = [tuple(state) for state in spread.states.tolist()]
        assert len(set(states)) == len(states)
        assert dict(zip(states, spread.weights.tolist(), strict=True)) == pytest.approx(
            {state: mass for state, mass in expected.items() if mass > 0}
        )


def check_steps(task: Task, actions: list[int], found: Forecast, near: float) -> None:
    """Each number of a forecast against the distribution as a dictionary."""
    assert task.counted is not None
    before, *after = course(task, actions)
    for step, action, then in zip(found.steps, actions, after, strict=True):
        rules: dict[int, float] = defaultdict(float)
        outcomes: dict[tuple[tuple[int, int], ...], float] = defaultdict(float)
        for state, mass in before.items():
            rule = covering_rule(task, state, action)
            if rule is not None:
                rules[rule.rule] += mass
                for outcome in rule.outcomes:
                    outcomes[outcome.effects] += mass * float(outcome.probability)
        assert step.action == action
        assert step.covered == pytest.approx(sum(rules.values()), abs=near)
        assert dict(step.rules) == pytest.approx(dict(rules), abs=near)
        seen: dict[tuple[tuple[int, int], ...], float] = defaultdict(float)
        for result in step.results:
            seen[result.effects] += result.probability
        assert {e: seen[e] for e in outcomes} == pytest.approx(dict(outcomes), abs=near)
        chances = [result.probability for result in step.results]
        assert chances == sorted(chances, reverse=True)
        reward = (
            sum(mass * decreasing(task, state) for state, mass in before.items())
            + sum(mass * (standing(task, state) - decreasing(task, state)) for state, mass in then.items())
            - float(task.actions[action].cost)
        )
        assert step.reward == pytest.approx(reward, abs=10 * near)
        count = sum(mass * held(task.counted, state) for state, mass in then.items())
        assert step.remaining == pytest.approx(count, abs=10 * near)
        before = then


@pytest.mark.parametrize("seed", SEEDS)
def test_each_step_is_expected_to_do_what_the_distribution_says(seed: int) -> None:
    task, actions = case(seed)
    found = forecast(prepare(task), actions, seed)
    assert found.runs is None
    check_steps(task, actions, found, 1e-9)
    drawn = forecast(prepare(task), actions, seed, states=1, runs=20_000)
    assert drawn.runs == 20_000
    check_steps(task, actions, drawn, 0.02)
    assert drawn.marginals == pytest.approx(found.marginals, abs=0.02)
    assert drawn.steps == forecast(prepare(task), actions, seed, states=1, runs=20_000).steps


@pytest.mark.parametrize("seed", SEEDS)
def test_marginals_and_the_factored_belief_of_each_step(seed: int) -> None:
    task, actions = case(seed)
    marginals = forecast(prepare(task), actions, seed).marginals
    factored = plan_beliefs(prepare(task), actions, reference_prada.CUT)
    slots = [(v, x) for v, variable in enumerate(task.variables) for x in range(len(variable.values))]
    belief = reference_prada.initial(task)
    for row, distribution in enumerate(course(task, actions)):
        for slot, (v, x) in enumerate(slots):
            mass = sum(mass for state, mass in distribution.items() if state[v] == x)
            assert marginals[row, slot] == pytest.approx(mass, abs=1e-9)
            assert factored[row, slot] == pytest.approx(belief[v, x], abs=1e-9)
        if row < len(actions):
            belief = reference_prada.update(task, belief, actions[row], reference_prada.CUT)


def test_too_many_states_are_not_followed() -> None:
    task, actions = case(0)
    with pytest.raises(SupportTooLargeError):
        exact_course(prepare(task), actions, 1)
    assert exact(prepare(task), actions, 1) is None


def test_planners_side_by_side() -> None:
    task, _ = case(2)
    planners = PLANNERS["prada"], PLANNERS["exact"].having(states=3)
    rows = list(compared(planners, prepare(task), Options(samples=500)))
    assert [row.planner for row in rows] == ["prada", "exact"]
    assert rows[0].plan is not None
    assert rows[0].true == pytest.approx(
        exact_value(task, [task.actions.index(action) for action in rows[0].plan.actions])
    )
    assert rows[1].plan is None
    assert "the limit is 3" in rows[1].refusal


def test_a_refusal_comes_back_from_another_process() -> None:
    error = pickle.loads(pickle.dumps(TooManyStatesError(7, 5)))
    assert (error.reached, error.limit, error.help) == (7, 5, TooManyStatesError(7, 5).help)
