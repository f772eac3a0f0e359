"""A task means what its rules mean: ground and lifted semantics agree in all states that are reached."""

from __future__ import annotations

import itertools
from collections import deque
from fractions import Fraction

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.fluents import Fluent
from cleancli.compiler.ground import ground
from cleancli.compiler.lifted_state import StateView
from cleancli.compiler.semantics import covering_rule, reaches_goal, reward, sample, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Fact, Problem, RewardKind, State, Value
from support.exported_ppddl import cost
from support.handmade import JOIN_DRAGS, drags_problem
from support.random_domains import NAMES, Generator

STATES = 40
"""Visited per domain."""


def state_of(task: Task, problem: Problem, assignment: GroundState) -> State:
    """The initial facts, with the variables' present values."""
    values: dict[Fluent, Value] = {(fact.symbol, fact.objects): fact.value for fact in problem.state}
    for variable, value in zip(task.variables, assignment, strict=True):
        values[variable.symbol, variable.objects] = variable.values[value]
    return frozenset(Fact(*key, value) for key, value in values.items() if value is not False)


def lifted_successors(
    domain: Domain, problem: Problem, state: State, action: str, arguments: tuple[str, ...]
) -> tuple[int | None, dict[State, Fraction]]:
    """The covering rule and the states after it, straight from the rules."""
    view = StateView(domain, problem.objects, state)
    found = view.covering(action, arguments)
    if found is None:
        return None, {state: Fraction(1)}
    after: dict[State, Fraction] = {}
    for outcome, changes in zip(domain.rules[found[0]].outcomes, view.rules[found[0]].changes, strict=True):
        if outcome.probability:
            values = {(fact.symbol, fact.objects): fact.value for fact in state}
            values |= changes(view.state, tuple(found[1].values()))
            next_state = frozenset(Fact(*key, value) for key, value in values.items() if value is not False)
            after[next_state] = after.get(next_state, Fraction(0)) + outcome.probability
    return found[0], after


def reached(task: Task) -> list[GroundState]:
    seen, queue = {task.initial}, deque([task.initial])
    while queue and len(seen) < STATES:
        state = queue.popleft()
        for action in range(len(task.actions)):
            for _, after in successors(task, state, action):
                if after not in seen and len(seen) < STATES:
                    seen.add(after)
                    queue.append(after)
    return sorted(seen)


def compiled(seed: int) -> tuple[Domain, Problem, Task] | None:
    generator = Generator(seed)
    domain, problem = generator.domain(), generator.problem()
    try:
        return domain, problem, ground(domain, problem)
    except Refused as refused:
        if {d.code for d in refused.diagnostics} != {"E605"}:
            raise
        return None


@pytest.mark.parametrize("seed", range(60))
def test_ground_and_lifted_semantics_agree(seed: int) -> None:
    found = compiled(seed)
    if found is None:
        pytest.skip("too many cases")
    domain, problem, task = found
    index = {(action.name, action.objects): i for i, action in enumerate(task.actions)}
    for assignment, (action, arity) in itertools.product(reached(task), [("one", 1), ("two", 2)]):
        state = state_of(task, problem, assignment)
        for arguments in itertools.product(NAMES, repeat=arity):
            rule, lifted = lifted_successors(domain, problem, state, action, arguments)
            if (action, arguments) not in index:
                assert lifted == {state: 1}, "an action that can change something was left out"
                continue
            number = index[action, arguments]
            covering = covering_rule(task, assignment, number)
            assert (None if covering is None else covering.rule) == rule
            ground_after = {
                state_of(task, problem, after): p for p, after in successors(task, assignment, number)
            }
            assert ground_after == pytest.approx({s: float(p) for s, p in lifted.items()})


@pytest.mark.parametrize("seed", range(60))
def test_at_most_one_ground_rule_of_an_action_covers_a_state(seed: int) -> None:
    found = compiled(seed)
    if found is None:
        pytest.skip("too many cases")
    task = found[2]
    for action in range(len(task.actions)):
        rules = [rule for rule in task.rules if rule.action == action]
        for one, two in itertools.combinations(rules, 2):
            other = dict(two.condition)
            assert any(not values & other.get(variable, values) for variable, values in one.condition)


@pytest.mark.parametrize("seed", range(30))
def test_rewards_are_what_the_domain_says(seed: int) -> None:
    found = compiled(seed)
    if found is None:
        pytest.skip("too many cases")
    domain, problem, task = found

    def measure(assignment: GroundState) -> dict[str, int]:
        view = StateView(domain, problem.objects, state_of(task, problem, assignment))
        counts = {c.name: len(list(view.extensions(c.variables, c.condition, {}))) for c in domain.counts}
        return {**counts, "goal": int(view.holds(problem.goal, {}))}

    values = {(fact.symbol, fact.objects): fact.value for fact in problem.state}
    costs = [float(cost(domain, values, each.name, each.objects)) for each in task.actions]
    states = reached(task)[:12]
    for before, after in itertools.product(states, repeat=2):
        was, now = measure(before), measure(after)
        kinds = [term.kind for term in domain.reward]
        assert kinds == [RewardKind.DECREASE, RewardKind.COUNT, RewardKind.GOAL, RewardKind.COST]
        expected = 2 * (was["reds"] - now["reds"]) - 0.5 * now["odd"] + 5 * (now["goal"] - was["goal"])
        assert reward(task, before, None, after) == pytest.approx(expected)
        assert reaches_goal(task, after) == bool(now["goal"])
        for action, taken in enumerate(costs):
            assert reward(task, before, action, after) == pytest.approx(expected - taken)


def test_few_random_domains_are_refused() -> None:
    assert sum(compiled(seed) is None for seed in range(60)) < 12


def test_outcomes_of_a_deictic_rule_are_drawn_as_often_as_declared() -> None:
    problem = drags_problem("a", "b", "m")
    task = ground(JOIN_DRAGS, problem)
    join = [str(action) for action in task.actions].index("join2(a, b)")
    rng = np.random.default_rng(2)
    drawn = [sample(task, task.initial, join, rng)[0] for _ in range(5000)]
    assert stats.chisquare(np.bincount(np.array(drawn), minlength=4), [2750, 1250, 500, 500]).pvalue > 0.01


def test_a_deictic_reference_becomes_a_rule_for_each_thing_it_may_mean() -> None:
    task = ground(JOIN_DRAGS, drags_problem("a", "b", "m", "n"))
    join = [str(action) for action in task.actions].index("join2(a, b)")
    names = {index: variable.objects[0] for index, variable in enumerate(task.variables)}
    conditions = [
        {names[v]: values == {1} for v, values in rule.condition}
        for rule in task.rules
        if rule.action == join
    ]
    assert conditions == [
        {"a": True, "b": True, "m": True, "n": False},
        {"a": True, "b": True, "m": False, "n": True},
    ]
    assert covering_rule(task, task.initial, join) is None
    picked = (*task.initial[:3], 0, *task.initial[4:])
    assert [v.objects for v in task.variables[:4]] == [("a",), ("b",), ("m",), ("n",)]
    rule = covering_rule(task, picked, join)
    assert rule is not None
    assert [task.variables[v].objects for v, _ in rule.outcomes[0].effects] == [("a",), ("m",), ("b",)]
