"""Search in policies (planning/kernels/policy_tree.py, tree_search.py, base_policies.py): against Bellman's
equation and plain runs over compiler/semantics.py, and what the planners that use it promise."""

from __future__ import annotations

from collections import Counter, defaultdict
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
from cleancli.compiler.task import GroundAction, GroundState, Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.kernels import base_policies, state_graph, tree_search
from cleancli.planning.plan import Branch, Options, Plan, TooManyStatesError
from cleancli.planning.planners import exact
from cleancli.planning.registry import PLANNERS
from cleancli.planning.trajectory import branches
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


def course_states(task: Task, plan: Plan) -> list[GroundState]:
    """The states of a plan's course: each action has its likeliest result, or, where that changes nothing and
    the best is to do it again, the likeliest that changes something."""
    states = [task.initial]
    for action in plan.actions:
        results = successors(task, states[-1], task.actions.index(action))
        likely = max(results, key=lambda pair: pair[0])[1]
        if likely == states[-1] and best(task, likely, len(states)) == action:
            likely = max((r for r in results if r[1] != likely), key=lambda pair: pair[0])[1]
        states.append(likely)
    return states


def best(task: Task, state: GroundState, step: int) -> GroundAction | None:
    """What is best after so many actions."""
    action = optimum(task)(state, task.horizon - step)[2]
    return None if action is None else task.actions[action]


def leaving(task: Task, plan: Plan) -> dict[tuple[int, GroundState, bool], Counter[int]]:
    """How likely a run of the best policy leaves the course: after which step, in which state, and whether
    only by being late there; each by how many actions were done."""
    states, actions, found = course_states(task, plan), (*plan.actions, None), defaultdict[Any, Any](Counter)

    def run(step: int, done: int, chance: float) -> None:
        action = actions[step]
        for p, after in successors(task, states[step], task.actions.index(action)) if action else ():
            then = best(task, after, done + 1)
            if after == states[step + 1] and then == actions[step + 1]:
                run(step + 1, done + 1, chance * p)
            elif after == states[step] and then == action:
                run(step, done + 1, chance * p)
            else:
                found[step + 1, after, after == states[step + 1]][done + 1] += chance * p

    run(0, 0, 1.0)
    return found


@pytest.mark.parametrize("name", ["exact", "prada+", "prada+, not solved", "uct"])
def test_branches_are_the_likeliest_ways_to_leave_the_course(name: str) -> None:
    """By following all runs; what is done there is what is best there."""
    task = replace(small_tasks.weighted_task(2), horizon=4)
    planner, own = name.partition(",")[0], {"solve": 0} if "not" in name else {}
    plan = planned(planner, task, samples=50_000, **own)
    told, states, ways = told_branches(task, plan, 3), course_states(task, plan), leaving(task, plan)
    assert sorted((branch.probability for branch in told), reverse=True) == pytest.approx(
        sorted((way.total() for way in ways.values()), reverse=True)[:3]
    )
    for branch in told:
        state = tuple((dict(enumerate(states[branch.step - 1])) | dict(branch.effects)).values())
        way = ways[branch.step, state, branch.late]
        assert branch.probability == pytest.approx(way.total())
        first = best(task, state, way.most_common(1)[0][0])
        assert branch.actions[:1] == (() if first is None else (first,))
    assert [branch.step for branch in told] == sorted(branch.step for branch in told)
    assert told_branches(task, plan, 0) == ()


def told_branches(task: Task, plan: Plan, most: int) -> tuple[Branch, ...]:
    assert plan.policy is not None
    return branches(task, plan.policy, most)


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
    """The boat is loaded, and there are nine actions for crossing and unloading. After eight crossings that
    failed there is no time to unload, and nothing to gain."""
    task = from_text.task(FERRY, "goal { delivered() } horizon = 10")
    planner, own = COURSES[name]
    plan = planned(planner, task, **own)
    assert list(map(str, plan.actions)) == ["load()", "cross()", "unload()"]
    assert plan.value == pytest.approx(optimum(task)(task.initial, 10)[0], abs=0.01)
    (branch,) = told_branches(task, plan, 5)
    assert (branch.step, branch.effects, branch.actions) == (2, (), ())
    assert branch.probability == pytest.approx(0.5035**8)


def test_a_branch_is_told_where_success_comes_late() -> None:
    """Of two actions one is left once the red lamp was not lit at once: it is tried again, and then there is
    none for the green lamp, which most likely stays dark."""
    text = """
    domain lamps {
      types { lamp }
      constants { red green - lamp }
      predicates { lit(?l - lamp) }
      derived { dark := count ?l - lamp: not lit(?l) }
      actions { light(?l - lamp) }
      rule light_red: light(?l) { when not lit(?l), ?l = red then 0.5: lit(?l) rest: nothing }
      rule light_green: light(?l) { when not lit(?l), ?l = green then 0.4: lit(?l) rest: nothing }
      reward { decrease(dark) }
    }
    """
    task = from_text.task(text, "init { } horizon = 2")
    plan = planned("exact", task)
    assert [str(action) for action in plan.actions] == ["light(red)", "light(green)"]
    found = told_branches(task, plan, 5)
    assert [branch.actions for branch in found] == [(), (), ()]
    assert {(b.step, b.late, bool(b.effects)): b.probability for b in found} == pytest.approx(
        {(1, True, True): 0.5 * 0.5, (1, False, False): 0.5 * 0.5, (2, False, True): 0.5 * 0.4}
    )


@pytest.mark.parametrize("planner", ["exact", "prada+"])
def test_without_a_horizon_tries_have_no_end_and_branches_are_told_too(planner: str) -> None:
    """docs/planning.md: a lock that opens (0.3), or jams (0.1), or stays as it is; the other way is locked
    by a bolt that always opens, and takes longer."""
    text = """
    domain door {
      predicates { open() jammed() bolted() }
      actions { unlock() unbolt() climb() }
      rule unlock: unlock() { when not open(), not jammed() then 0.3: open() 0.1: jammed() rest: nothing }
      rule unbolt: unbolt() { when jammed(), bolted() then 1: not bolted() }
      rule climb: climb() { when jammed(), not bolted(), not open() then 0.5: open() rest: nothing }
      reward { 1 * goal }
    }
    """
    for init, ahead, reached in (("", ["climb()"], 1.0), ("bolted()", ["unbolt()", "climb()"], 1.0)):
        task = from_text.task(text, f"init {{ {init} }} goal {{ open() }} horizon = unlimited")
        plan = planned(planner, task)
        assert [str(action) for action in plan.actions] == ["unlock()"]
        assert plan.value == pytest.approx(reached)
        (branch,) = told_branches(task, plan, 5)
        assert branch.step == 1
        assert branch.probability == pytest.approx(0.1 / 0.4)
        assert [str(action) for action in branch.actions] == ahead
        assert [task.variables[v].symbol for v, _ in branch.effects] == ["jammed"]


def test_a_sequence_has_no_policy() -> None:
    task = replace(small_tasks.weighted_task(2), horizon=4)
    assert planned("prada+", task, solve=0, runs=0).policy is None
    assert planned("prada", task).policy is None
