"""Acting, stopping and waiting (docs/planning.md, "Acting and stopping"): what each planner makes of them."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from cleancli.compiler.lowering.state_tables import lower_process
from cleancli.compiler.semantics import covering_rule, exact_value, standing, successors
from cleancli.compiler.task import Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.evaluation.belief_value import plan_value
from cleancli.planning.evaluation.value import earliness
from cleancli.planning.kernels import annealing
from cleancli.planning.plan import Plan
from cleancli.planning.planners.beam import best_sequence
from cleancli.planning.reductions.determinization import all_outcomes
from support import from_text, optimal, small_tasks
from support.planned import planned

DOORS = """
domain doors {
  types { door }
  predicates { open(?d - door) dirt(?d - door) lamp() }
  derived { opened := count ?d - door: open(?d)  left := count ?d - door: dirt(?d) }
  actions { start(?d - door) wipe(?d - door) flick() wait() }
  rule s: start(?d) { when not open(?d) then 1: open(?d) }
  rule w: wipe(?d) { when dirt(?d) then 1: not dirt(?d) }
  rule on: flick() { when not lamp() then 1: lamp() }
  rule off: flick() { when lamp() then 1: not lamp() }
  %s
  reward { %s }
}
"""
WAIT = "rule wait: wait() { then 0.5: nothing 0.5: noise }"
PLANS: dict[str, tuple[str, dict[str, Any]]] = {
    "exact": ("exact", {}),
    "exact, fractions": ("exact", {"arithmetic": "rational"}),
    "prada+": ("prada+", {}),
    "prada+, not solved": ("prada+", {"solve": 0}),
    "prada+, sequences": ("prada+", {"solve": 0, "runs": 0}),
    "prada": ("prada", {"margin": 0.0}),
    "aprada": ("aprada", {"margin": 0.0}),
    "sst": ("sst", {"depth": 9, "branching": 1}),
    "likeliest": ("likeliest", {}),
    "all-outcomes": ("all-outcomes", {}),
}
"""Every planner that compares whole plans; UCT's values are means of episodes, so that equals differ."""


def doors(reward: str, inside: str, rules: str = "") -> Task:
    return from_text.task(DOORS % (rules, reward), f"objects {{ a1 - door }} {inside}")


def chosen_by(name: str, task: Task) -> tuple[list[str], Plan]:
    planner, options = PLANS.get(name, (name, {}))
    plan = planned(planner, task, **{"samples": 4000, **options})
    return [str(action) for action in plan.actions], plan


# ---- stopping is final


@pytest.mark.parametrize("name", [*PLANS, "uct"])
def test_without_an_action_that_waits_nothing_waits(name: str) -> None:
    task = doors("5 * goal - opened", "goal { open(a1) } horizon = 4 discount = 1")
    actions, plan = chosen_by(name, task)
    assert [action for action in actions if action != "flick()"] == ["start(a1)"]
    if name not in ("prada", "uct"):  # whose lamp may be flicked in the meantime, for a value of up to 4
        assert plan.value == pytest.approx(exact_value(task, [task.actions.index(a) for a in plan.actions]))


@pytest.mark.parametrize("name", [*PLANS, "uct"])
@pytest.mark.parametrize("discount", ["1", "0.9"])
def test_an_action_that_waits_is_a_choice_like_others(name: str, discount: str) -> None:
    """What opens the door pays 5 and costs 1 in each step from then on, so it is best done last."""
    reward, inside = "5 * goal - opened", f"goal {{ open(a1) }} horizon = 4 discount = {discount}"
    task = without_lamp(doors(reward, inside, WAIT))
    actions, plan = chosen_by(name, task)
    assert actions == ["wait()", "wait()", "wait()", "start(a1)"]
    if name != "uct":
        assert plan.value == pytest.approx(4 * float(discount) ** 3)


def without_lamp(task: Task) -> Task:
    kept = [index for index, action in enumerate(task.actions) if action.name != "flick"]
    rules = [replace(rule, action=kept.index(rule.action)) for rule in task.rules if rule.action in kept]
    actions = tuple(task.actions[index] for index in kept)
    return replace(task, actions=actions, rules=tuple(rules), discounts=task.discounts[: len(kept)])


@pytest.mark.parametrize("name", [*PLANS, "uct"])
def test_where_stopping_is_best_the_plan_is_empty_and_worth_it(name: str) -> None:
    task = without_lamp(doors("goal - opened + 2 * left", "init { dirt(a1) } goal { open(a1) } horizon = 5"))
    actions, plan = chosen_by(name, task)
    assert actions == []
    assert plan.value == pytest.approx(2 * sum(0.95**k for k in range(5)))


# ---- of equals the sooner


@pytest.mark.parametrize("name", PLANS)
@pytest.mark.parametrize("discount", ["1", "0.9"])
def test_nothing_is_put_off_and_nothing_done_in_vain(name: str, discount: str) -> None:
    task = doors("decrease(left)", f"init {{ dirt(a1) }} horizon = 6 discount = {discount}")
    actions, plan = chosen_by(name, task)
    assert actions == ["wipe(a1)"]
    assert plan.value == pytest.approx(1)


@pytest.mark.parametrize("name", PLANS)
def test_a_goal_that_pays_nothing_is_reached_where_that_costs_nothing(name: str) -> None:
    task = doors("decrease(left)", "goal { open(a1) } horizon = 3")
    assert chosen_by(name, task)[0] == ["start(a1)"]
    dear = replace(task, actions=tuple(replace(a, cost=Fraction(1, 100)) for a in task.actions))
    assert chosen_by(name, dear)[0] == []


def odd(seed: int) -> Task:
    """A random task with a goal and with an action that changes nothing; rewards of one half or of any
    weight, discounted by steps, by time or not at all."""
    task = small_tasks.weighted_task(seed) if seed % 2 else small_tasks.random_task(seed)
    rules = tuple(
        replace(rule, outcomes=tuple(replace(o, effects=()) for o in rule.outcomes))
        if rule.action == 5
        else rule
        for rule in task.rules
    )
    goal = (((0, frozenset({1})), (1, frozenset({0}))), ((0, frozenset({0})), (2, frozenset({1}))))
    task = replace(task, rules=rules, goal=goal, horizon=3)
    if seed % 3 == 0:
        return small_tasks.timed(task)
    return replace(task, discount=1.0, discounts=(1.0,) * 6) if seed % 3 == 1 else task


@pytest.mark.parametrize("name", ["exact", "exact, fractions", "prada+"])
@pytest.mark.parametrize("seed", range(12))
def test_policies_are_the_best(name: str, seed: int) -> None:
    task = odd(seed)
    best = optimal.optimum(task)
    value, _, first = best(task.initial, 3)
    actions, plan = chosen_by(name, task)
    assert plan.value == pytest.approx(value, abs=1e-8)
    assert actions[:1] == ([] if first is None else [str(task.actions[first])])


def every(task: Task) -> list[Sequence[int]]:
    lengths = range(task.horizon + 1)
    return [s for n in lengths for s in itertools.product(range(len(task.actions)), repeat=n)]


def all_covered(task: Task, actions: Sequence[int]) -> bool:
    """Whether a rule covers each action when it is its turn, results being certain."""
    state = task.initial
    for action in actions:
        if covering_rule(task, state, action) is None:
            return False
        ((_, state),) = successors(task, state, action)
    return True


@pytest.mark.parametrize("seed", range(6))
def test_sequences_are_the_best_and_soonest(seed: int) -> None:
    """Among all of a task whose results are certain, of which many are worth the same."""
    task = odd(seed)
    task = distinct(all_outcomes(replace(task, horizon=2))[0])
    allowed = [sequence for sequence in every(task) if all_covered(task, sequence)]
    worth = {s: (exact_value(task, s), optimal.earliness(task, s)) for s in allowed}
    most = max(value for value, _ in worth.values())
    soonest = max(early for value, early in worth.values() if value >= most - 1e-9)
    beam = best_sequence(lower_process(task), task.initial, task.discount, steps=2, width=999)
    assert worth[beam] == pytest.approx((most, soonest), abs=1e-8)
    for name in ("prada+, sequences", "prada"):
        chosen = tuple(task.actions.index(a) for a in chosen_by(name, task)[1].actions)
        assert worth[chosen] == pytest.approx((most, soonest), abs=1e-8)


def distinct(task: Task) -> Task:
    """With a name for each action, so that it can be told from others with the same origin."""
    return replace(task, actions=tuple(replace(a, name=f"do{i}") for i, a in enumerate(task.actions)))


@pytest.mark.parametrize("seed", range(6))
def test_earliness_is_what_it_says(seed: int) -> None:
    task, rng = odd(seed), np.random.default_rng(seed)
    for length in (0, 1, 3, 5):
        actions = rng.integers(6, size=length).tolist()
        expected = optimal.earliness(task, actions)
        assert earliness(prepare(task), actions, 0) == pytest.approx(expected)
        drawn = [annealing.worth(prepare(task), actions[:3], 20, s)[1] for s in range(6)]
        assert np.mean(drawn) == pytest.approx(optimal.earliness(task, actions[:3]), abs=0.3)


def test_actions_beyond_the_horizon_do_not_count() -> None:
    task = odd(2)
    for first in range(6):
        longer = [first, 1, 2, 3, 4]
        for value in (exact_value, plan_value):
            assert value(task, longer) == pytest.approx(value(task, longer[:3]))
    assert exact_value(replace(task, horizon=0), [1, 2]) == 0.0


# ---- what grounding keeps


@pytest.mark.parametrize(
    ("reward", "kept"),
    [
        ("decrease(left)", False),
        ("decrease(left) - cost", False),
        ("2 * goal + decrease(left)", False),
        ("left", True),
        ("decrease(left) - opened", True),
        ("goal - decrease(left)", True),
        ("decrease(left) + cost", True),
    ],
)
def test_what_changes_nothing_is_kept_where_waiting_can_pay(reward: str, kept: bool) -> None:
    text = (DOORS % (WAIT, reward)).replace("wait() }", "wait() [cost = 1] }", 1)
    task = from_text.task(text, "objects { a1 - door } goal { open(a1) } horizon = 2")
    assert task.waiting is kept
    assert ("wait()" in [str(action) for action in task.actions]) is kept


def test_standing_still_is_paid_after_the_end_alone() -> None:
    """An empty plan and one that ends early are worth what their last state pays for all that is left."""
    for seed in range(4):
        task = odd(seed)
        assert exact_value(task, ()) == pytest.approx(
            standing(task, task.initial) * sum(task.discount**k for k in range(3))
        )
