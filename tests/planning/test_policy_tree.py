"""Search in policies (planning/kernels/policy_tree.py, tree_search.py, base_policies.py): against Bellman's
equation and plain runs over compiler/semantics.py, and what the planners that use it promise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.semantics import (
    covering_rule,
    exact_value,
    payment,
    reward,
    standing,
    successors,
)
from cleancli.compiler.task import GroundState, Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.kernels import base_policies, state_graph, tree_search
from cleancli.planning.plan import Options, TooManyStatesError
from cleancli.planning.planners import exact
from cleancli.planning.registry import PLANNERS
from support import from_text, small_tasks
from support.optimal import earliness, optimum
from support.planned import planned

KINDS = {"tail": base_policies.TAIL, "list": base_policies.LIST, "retried": base_policies.RETRIED}


def drawn_task(seed: int) -> Task:
    """Tasks of all kinds: waiting that pays, costs, discounts by steps, by time or not at all."""
    make = (small_tasks.weighted_task, small_tasks.random_task, small_tasks.costly_task)[seed % 3]
    task = replace(make(seed), horizon=4)
    if seed % 4 == 1:
        return small_tasks.timed(task)
    return replace(task, discount=1.0, discounts=(1.0,) * 6) if seed % 4 == 2 else task


def drawn_sequence(task: Task, seed: int, length: int = 4) -> tuple[int, ...]:
    return tuple(np.random.default_rng([seed, 7]).integers(len(task.actions), size=length).tolist())


def tree(task: Task, sequence: Sequence[int] = (), **manner: Any) -> tree_search.Search:
    manner = {"runs": 2, "exploration": 0.3, "seed": 1} | manner
    return tree_search.Search(prepare(task), sequence, **manner)


def is_choice(task: Task, state: GroundState, action: int) -> bool:
    """Whether a rule covers the state and may change it, or waiting is a choice."""
    if covering_rule(task, state, action) is None:
        return False
    return task.waiting or any(after != state for _, after in successors(task, state, action))


def expected(task: Task, kind: str, sequence: Sequence[int]) -> float:
    """What docs/planners.md says of a base policy, exactly."""
    if kind == "tail":
        return exact_value(task, sequence)

    @cache
    def value(state: GroundState, left: int, place: int) -> float:
        fitting = [i for i in range(place, len(sequence)) if is_choice(task, state, sequence[i])]
        if left == 0 or not fitting:
            return standing(task, state) * sum(task.discount**k for k in range(left))
        action, total = sequence[fitting[0]], 0.0
        rule = covering_rule(task, state, action)
        assert rule is not None
        for outcome in rule.outcomes:
            after = tuple((dict(enumerate(state)) | dict(outcome.effects)).values())
            paid = payment(task, action) * reward(task, state, action, after)
            on = fitting[0] + bool(outcome.effects) if kind == "retried" else 0
            later = value(after, left - 1, on)
            total += float(outcome.probability) * (paid + task.discounts[action] * later)
        return total

    return value(task.initial, task.horizon, 0)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("kind", KINDS)
def test_base_policies_are_worth_what_plain_recursion_says(seed: int, kind: str) -> None:
    task = drawn_task(seed)
    sequence = drawn_sequence(task, seed)
    means = [
        tree_search.base_mean(prepare(task), sequence, KINDS[kind], 2000, batch)[0] for batch in range(10)
    ]
    error = np.std(means, ddof=1) / np.sqrt(len(means)) + 1e-12
    assert abs(np.mean(means) - expected(task, kind, sequence)) < stats.t.isf(1e-6, 9) * error


@pytest.mark.parametrize("seed", range(4))
def test_the_tails_earliness_is_the_sequences(seed: int) -> None:
    task = drawn_task(seed)
    sequence = drawn_sequence(task, seed)
    found = tree_search.base_mean(prepare(task), sequence, base_policies.TAIL, 20_000, 1)[1]
    assert found == pytest.approx(earliness(task, sequence), abs=0.3)


@pytest.mark.parametrize("seed", range(12))
def test_without_a_sequence_a_new_node_is_worth_the_best_of_stopping_and_one_step(seed: int) -> None:
    task = drawn_task(seed)
    covered = [a for a in range(len(task.actions)) if covering_rule(task, task.initial, a)]
    assert tree(task).value == pytest.approx(
        max(exact_value(task, s) for s in [(), *((a,) for a in covered)])
    )


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("guided", [False, True])
def test_a_tree_that_is_searched_to_its_end_is_worth_the_optimum(seed: int, guided: bool) -> None:
    task = drawn_task(seed)
    found = tree(task, drawn_sequence(task, seed) if guided else ())
    found.run(100_000)
    value, early, action = optimum(task)(task.initial, task.horizon)
    assert found.solved
    assert found.played < 100_000
    assert found.mean(1, 0) == pytest.approx((value, early), abs=1e-8)
    assert found.course().actions[:1] == (() if action is None else (action,))


@pytest.mark.parametrize("seed", range(6))
def test_each_descent_leaves_bellmans_equation_behind(seed: int) -> None:
    """By a slow reference: of each choice on the descent's way, from the values that its successors then
    have."""
    task = drawn_task(seed)
    search = tree(task, drawn_sequence(task, seed))
    for _ in range(40):
        before = search.played
        search.run(1)
        if search.played == before:
            break
        passed = search.last_descent()
        assert passed
        for state, at, action in passed:
            left, worth = task.horizon - at, 0.0
            for chance, after in successors(task, state, action):
                paid = payment(task, action) * reward(task, state, action, after)
                later = search.node(after, at + 1)
                assert later is not None
                worth += chance * (paid + task.discounts[action] * later.value)
            node = search.node(state, at)
            assert node is not None
            assert node.worth[action] == pytest.approx(worth)
            stopping = standing(task, state) * sum(task.discount**k for k in range(left))
            assert node.value == pytest.approx(max(stopping, *node.worth.values()))


@pytest.mark.parametrize("seed", range(6))
def test_the_policys_value_is_that_of_what_it_does(seed: int) -> None:
    """Over fresh runs, of a tree that is far from done; where nothing was tried, a base policy goes on."""
    task = replace(drawn_task(seed), horizon=6)
    search = tree(task, drawn_sequence(task, seed))
    search.run(10)
    means = [search.mean(2000, batch)[0] for batch in range(10)]
    error = np.std(means, ddof=1) / np.sqrt(len(means)) + 1e-9
    best = optimum(task)(task.initial, task.horizon)[0]
    assert np.mean(means) < best + stats.t.isf(1e-6, 9) * error
    search.run(3000)
    assert search.mean(4000, 3)[0] > np.mean(means) - 5 * error


def test_same_seed_same_plan_whatever_the_number_of_threads() -> None:
    task = replace(small_tasks.weighted_task(3), horizon=8)
    plans = [
        planned("prada+", task, samples=2000, seed=5, solve=0, threads=threads) for threads in (1, 2, 3, 2)
    ]
    assert len({(plan.actions, plan.value, plan.samples) for plan in plans}) == 1


@pytest.mark.parametrize("seed", range(6))
def test_a_policy_is_worth_no_less_than_the_sequence(seed: int) -> None:
    task = replace(drawn_task(seed), horizon=6)
    policy = planned("prada+", task, samples=1000, seed=seed, solve=0)
    sequence = planned("prada+", task, samples=1000, seed=seed, solve=0, runs=0)
    spread = sum(abs(r.decrease) + abs(r.state) for r in task.rewards) + sum(a.cost for a in task.actions)
    assert policy.value >= sequence.value - 0.05 * float(spread)
    best = optimum(task)(task.initial, task.horizon)[0]
    assert policy.value <= best + 0.05 * float(spread)


def closed_loop(name: str, task: Task, **options: Any) -> float:
    """What planning anew in each state is worth, with a step less each time."""
    known, prepared = {a: i for i, a in enumerate(task.actions)}, prepare(task)
    planner = PLANNERS[name].having(**{k: options.pop(k) for k in ("solve", "runs") if k in options})
    asked = Options(**options)

    @cache
    def value(state: GroundState, left: int) -> float:
        plan = planner(prepared.at(state, left), asked)
        if not plan.actions:
            return standing(task, state) * sum(task.discount**k for k in range(left))
        action = known[plan.actions[0]]
        return sum(
            chance
            * (
                payment(task, action) * reward(task, state, action, after)
                + task.discounts[action] * value(after, left - 1)
            )
            for chance, after in successors(task, state, action)
        )

    return value(task.initial, task.horizon)


@pytest.mark.parametrize("seed", [0, 2, 3, 4])
def test_in_closed_loop_a_search_comes_near_the_optimum(seed: int) -> None:
    task = replace(drawn_task(seed), horizon=5)
    best, nothing = optimum(task)(task.initial, 5)[0], exact_value(task, ())
    found = closed_loop("prada+", task, solve=0, samples=400, seed=seed)
    assert found >= best - 0.03 * (best - nothing) - 1e-9


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The horizons for which something is solved while the test runs."""
    times, solve = list[int](), exact.solved

    def counted(*given: Any) -> exact.Solution:
        found = solve(*given)
        times.append(found.steps)
        return found

    monkeypatch.setattr(exact, "solved", counted)
    return times


def test_an_episode_is_solved_once(solved: list[int]) -> None:
    task = replace(small_tasks.weighted_task(2), horizon=5)
    prepared, best = prepare(task), optimum(task)
    state, left = task.initial, 5
    for name in ("prada+", "exact") * 2:
        plan = PLANNERS[name](prepared.at(state, left), Options())
        assert plan.value == pytest.approx(best(state, left)[0])
        action = task.actions.index(plan.actions[0])
        state, left = successors(task, state, action)[-1][1], left - 1
    assert solved == [5]
    PLANNERS["prada+"](prepared.at(state, 20), Options())  # more steps than were solved for
    assert solved == [5, 20]


@pytest.mark.parametrize("horizon", [2, 20])
def test_a_horizon_that_stays_is_solved_once_where_all_states_are_known(
    horizon: int, solved: list[int]
) -> None:
    task = replace(small_tasks.weighted_task(2), horizon=horizon)
    prepared, best = prepare(task), optimum(task)
    state = task.initial
    for _ in range(3):
        plan = PLANNERS["prada+"](prepared.at(state, horizon), Options())
        assert plan.value == pytest.approx(best(state, horizon)[0])
        state = next(s for a in range(6) for _, s in successors(task, state, a) if s != state)
    assert solved == ([20] if horizon == 20 else [2, 2, 2])


def test_a_solution_is_of_no_more_states_than_are_allowed() -> None:
    prepared = prepare(replace(small_tasks.weighted_task(2), horizon=5))
    PLANNERS["prada+"](prepared, Options())
    with pytest.raises(TooManyStatesError):
        PLANNERS["exact"].having(states=2)(prepared, Options())


def test_as_many_transitions_are_found_as_are_allowed() -> None:
    prepared = prepare(small_tasks.weighted_task(2))
    whole = state_graph.Enumeration(prepared.process, prepared.task.initial, 1_000)
    assert whole.reach(3)
    same = state_graph.Enumeration(prepared.process, prepared.task.initial, 1_000, edges=whole.transitions)
    assert same.reach(3)
    fewer = state_graph.Enumeration(
        prepared.process, prepared.task.initial, 1_000, edges=whole.transitions - 1
    )
    assert not fewer.reach(3)


# ---- branches


COURSES: dict[str, tuple[str, dict[str, Any]]] = {
    "exact": ("exact", {}),
    "exact, fractions": ("exact", {"arithmetic": "rational"}),
    "prada+": ("prada+", {}),
    "prada+, not solved": ("prada+", {"solve": 0}),
    "uct": ("uct", {}),
}
"""Planners whose plan is the likeliest course of a policy."""


@pytest.mark.parametrize("name", ["exact", "prada+", "prada+, not solved", "uct"])
def test_branches_are_the_likeliest_of_the_other_results(name: str) -> None:
    """By walking along the plan; what is done there is what is best there."""
    task = replace(small_tasks.weighted_task(2), horizon=4)
    planner, own = name.partition(",")[0], {"solve": 0} if "not" in name else {}
    plan = planned(planner, task, branches=3, samples=50_000, **own)
    states, likelihood, others = [task.initial], 1.0, list[float]()
    for action in plan.actions:
        results = successors(task, states[-1], task.actions.index(action))
        chance, likely = max(results, key=lambda pair: pair[0])
        again = optimum(task)(likely, task.horizon - len(states))[2]
        if likely == states[-1] and again == task.actions.index(action):
            chance, likely = max((r for r in results if r[1] != likely), key=lambda pair: pair[0])
        others += [likelihood * p for p, state in results if state != likely]
        states.append(likely)
        likelihood *= chance
    told = sorted((branch.probability for branch in plan.branches), reverse=True)
    assert told == pytest.approx(sorted(others, reverse=True)[:3])
    for branch in plan.branches:
        state = tuple((dict(enumerate(states[branch.step - 1])) | dict(branch.effects)).values())
        assert state != states[branch.step]
        first = optimum(task)(state, task.horizon - branch.step)[2]
        assert branch.actions[:1] == (() if first is None else (task.actions[first],))
    assert planned(planner, task, **own).branches == ()


FERRY = """
domain ferry {
  predicates { across() aboard() delivered() }
  actions { load() cross() unload() }
  rule load: load() { when not aboard(), not delivered() then 1: aboard() }
  rule cross: cross() { when aboard(), not across() then 0.4965: across() 0.5035: nothing }
  rule unload: unload() { when across(), aboard() then 1: not aboard(), delivered() }
  reward { 1 * goal }
}
"""
"""Its crossing fails more often than not."""


@pytest.mark.parametrize("name", COURSES)
def test_what_fails_and_is_tried_again_stands_in_a_plan_once(name: str) -> None:
    task = from_text.task(FERRY, "goal { delivered() } horizon = 10")
    planner, own = COURSES[name]
    plan = planned(planner, task, branches=5, **own)
    assert list(map(str, plan.actions)) == ["load()", "cross()", "unload()"]
    assert plan.value == pytest.approx(optimum(task)(task.initial, 10)[0], abs=0.01)
    if "fractions" not in name:
        (branch,) = plan.branches
        assert (branch.step, branch.effects) == (2, ())
        assert branch.probability == pytest.approx(0.5035)
        assert branch.actions == plan.actions[1:]


def test_a_sequence_has_no_branches() -> None:
    task = replace(small_tasks.weighted_task(2), horizon=4)
    assert planned("prada+", task, branches=3, solve=0, runs=0).branches == ()
    assert planned("prada", task, branches=3).branches == ()
