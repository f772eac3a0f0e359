"""benchmarks/regret.py scores policies rightly: against plain recursion over compiler/semantics.py."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import payment, reward, standing, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.plan import Options, Plan
from cleancli.planning.registry import PLANNERS
from support import small_tasks
from support.optimal import optimum

STEPS = 3
SEEDS = range(6)
"""One of each family."""


@pytest.fixture
def regret(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks"))
    yield importlib.import_module("regret")
    for name in ("regret", "instances", "large_instances", "planning"):
        sys.modules.pop(name, None)


def odd(prepared: Prepared, options: Options) -> Plan:
    """Says something or other that depends on the state and the horizon, and sometimes nothing."""
    task = prepared.task
    number = (sum((3 * i + 1) * v for i, v in enumerate(task.initial)) + 5 * task.horizon) % 11
    said = () if number == 7 else (task.actions[number % len(task.actions)],)
    return Plan("odd", said, 0.0, "exact", 0, task.horizon, None, {})


def game_of(regret: ModuleType, seed: int) -> Any:
    found = regret.instance(seed)
    return regret.game_of(prepare(ground(found.domain, found.problem)), STEPS)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_policys_return_is_what_recursion_says(regret: ModuleType, seed: int) -> None:
    game = game_of(regret, seed)
    task: Task = game.prepared.task

    def step(state: GroundState, action: int, left: int, then: Callable[[GroundState, int], float]) -> float:
        return sum(
            p
            * (
                payment(task, action) * reward(task, state, action, s)
                + task.discounts[action] * then(s, left - 1)
            )
            for p, s in successors(task, state, action)
        )

    @cache
    def returned(state: GroundState, left: int) -> float:
        said = odd(game.prepared.at(state, left), Options()).actions
        if left == 0 or not said:
            return standing(task, state) * sum(task.discount**k for k in range(left))
        return step(state, task.actions.index(said[0]), left, returned)

    best = optimum(task)(task.initial, STEPS)[0]
    assert game.values[0, 0] == pytest.approx(best)
    policy = regret.Policy(game, odd, Options())
    loss = regret.exact_loss(game, policy, 10_000)
    assert best - loss == pytest.approx(returned(task.initial, STEPS))
    drawn, error = regret.mean_of(regret.drawn_loss(game, policy, 2000, seed))
    assert abs(drawn - loss) <= stats.norm.isf(1e-5) * error + 1e-9
    assert regret.exact_loss(game, regret.Policy(game, odd, Options()), 0) is None


@pytest.mark.parametrize("seed", SEEDS)
def test_the_best_policy_loses_nothing(regret: ModuleType, seed: int) -> None:
    game = game_of(regret, seed)
    _, best = regret.backward(game.graph, game.prepared.process, game.prepared.task.discount, STEPS)
    rows = {tuple(state): number for number, state in enumerate(game.graph.states.tolist())}

    def optimal(prepared: Prepared, options: Options) -> Plan:
        task = prepared.task
        action = best[STEPS - task.horizon, rows[task.initial]]
        return Plan("best", (task.actions[action],) if action >= 0 else (), 0.0, "policy", 0, 0, None, {})

    policy = regret.Policy(game, optimal, Options())
    assert regret.exact_loss(game, policy, 10_000) == pytest.approx(0, abs=1e-8)
    drawn, error = regret.mean_of(regret.drawn_loss(game, policy, 5, seed))
    assert (drawn, error) == pytest.approx((0, 0), abs=1e-8)


@pytest.mark.parametrize("seed", range(8))
def test_the_loop_earns_the_value_that_is_printed(regret: ModuleType, seed: int) -> None:
    """Of planners that know the best policy, where states pay, waiting is a choice, and much is worth the
    same."""
    task = small_tasks.weighted_task(seed) if seed % 2 else small_tasks.random_task(seed)
    if seed % 4 < 2:
        task = replace(task, discount=1.0, discounts=(1.0,) * 6)
    game = regret.game_of(prepare(replace(task, horizon=STEPS)), STEPS)
    for name in ("exact", "prada+"):
        policy = regret.Policy(game, PLANNERS[name], Options())
        assert regret.exact_loss(game, policy, 10_000) == pytest.approx(0, abs=1e-6)
        plan = PLANNERS[name](game.prepared, Options())
        assert plan.value == pytest.approx(game.values[0, 0])
        assert plan.value == pytest.approx(optimum(task)(task.initial, STEPS)[0])


def test_planners_may_have_options(regret: ModuleType) -> None:
    asked = regret.Asked((), 1, 2, 0.5, 300)
    planner, options = regret.player_of("prada:rule_threshold=0.1,samples=20", asked, 3)
    assert (planner, options.samples, options.rule_threshold, options.seed) == (
        regret.PLANNERS["prada"].having(margin=0.0),
        20,
        0.1,
        3,
    )
    assert regret.player_of("prada", asked, 3)[1].samples == 300
    for wrong in ("prado", "prada:sample=3"):
        with pytest.raises((KeyError, TypeError)):
            regret.player_of(wrong, asked, 3)


def test_instances_are_of_all_families_and_vary(regret: ModuleType) -> None:
    found = [regret.instance(seed) for seed in range(12)]
    assert {each.family for each in found} == set(importlib.import_module("instances").FAMILIES)
    assert found[0] == regret.instance(0)
    assert all(one.problem != other.problem for one, other in zip(found[:6], found[6:], strict=True))
    for each in found:
        assert all(sum(o.probability for o in rule.outcomes) == 1 for rule in each.domain.rules)
        assert all(o.probability >= 0 for rule in each.domain.rules for o in rule.outcomes)
    assert np.mean([each.steps for each in found]) > 4


def test_large_instances_are_of_six_families_and_vary(regret: ModuleType) -> None:
    found = [regret.large_instance(seed) for seed in range(12)]
    assert len({each.family for each in found}) == 6
    assert all(one.problem != other.problem for one, other in zip(found[:6], found[6:], strict=True))
    assert found[3] == regret.large_instance(3)
