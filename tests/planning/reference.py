"""PRADA's belief update, slow and obvious: one line per formula of the authors' description (§4.1)."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

from cleancli.compiler.task import GroundCondition, GroundRule, Task

Belief = dict[tuple[int, int], float]
"""The probability of each (variable, value)."""

CUT = 0.03


def value(task: Task, actions: Sequence[int], *, independent_rules: bool = False) -> float:
    """Discounted reward, where nothing is done after the actions; `independent_rules` multiplies by 1 - φ of
    the other rules, as libPRADA does."""
    belief = initial(task)
    total, factor = 0.0, 1.0
    for step in range(max(len(actions), task.horizon)):
        reward, payment, discount = 0.0, 1.0, task.discount
        if step < len(actions):
            after = update(task, belief, actions[step], independent_rules=independent_rules)
            reward = (
                decreasing(task, belief) - decreasing(task, after) - float(task.actions[actions[step]].cost)
            )
            belief = after
            discount = task.discounts[actions[step]]
            payment = discount / task.discount
        total += factor * payment * (reward + standing(task, belief))
        factor *= discount
    return total


def initial(task: Task) -> Belief:
    return {
        (variable, value): float(value == task.initial[variable])
        for variable, v in enumerate(task.variables)
        for value in range(len(v.values))
    }


def probability(belief: Belief, condition: GroundCondition) -> float:
    return prod(sum(belief[variable, value] for value in values) for variable, values in condition)


def cut(probability: float) -> float:
    return probability if probability >= CUT else 0.0


def update(task: Task, belief: Belief, action: int, *, independent_rules: bool) -> Belief:
    rules = [rule for rule in task.rules if rule.action == action]
    phi = [cut(probability(belief, rule.condition)) for rule in rules]
    covers = phi
    if independent_rules:
        covers = [cut(prod([p, *(1 - q for j, q in enumerate(phi) if j != i)])) for i, p in enumerate(phi)]
    w = sum(covers)
    return {
        (v, x): (1 - w) * p
        + sum(c * (impact(r, v, x) + (1 - sets(r, v)) * p) for c, r in zip(covers, rules, strict=True))
        for (v, x), p in belief.items()
    }


def impact(rule: GroundRule, variable: int, value: int) -> float:
    return sum(
        float(outcome.probability) for outcome in rule.outcomes if (variable, value) in outcome.effects
    )


def sets(rule: GroundRule, variable: int) -> float:
    return sum(float(outcome.probability) for outcome in rule.outcomes if variable in dict(outcome.effects))


def decreasing(task: Task, belief: Belief) -> float:
    return sum(float(r.decrease) * probability(belief, r.condition) for r in task.rewards)


def standing(task: Task, belief: Belief) -> float:
    return float(task.constant_reward) + sum(
        float(r.state) * probability(belief, r.condition) for r in task.rewards
    )
