"""PRADA's belief update, slow and obvious: one line per formula of the authors' description (§4.1)."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

from cleancli.compiler.task import GroundCondition, GroundRule, Task

Belief = dict[tuple[int, int], float]
"""The probability of each (variable, value)."""

CUT = 0.03


def value(
    task: Task, actions: Sequence[int], *, independent_rules: bool = False, threshold: float = CUT
) -> float:
    """Discounted reward up to the horizon, where nothing is done after the actions; `independent_rules`
    updates as libPRADA does."""
    belief = initial(task)
    total, factor = 0.0, 1.0
    for step in range(task.horizon):
        reward, payment, discount = 0.0, 1.0, task.discount
        if step < len(actions):
            change = update_independent if independent_rules else update
            after = change(task, belief, actions[step], threshold)
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


def cut(probability: float, threshold: float) -> float:
    return probability if probability >= threshold else 0.0


def update(task: Task, belief: Belief, action: int, threshold: float) -> Belief:
    """Rules of an action exclude each other, and what they ask of a variable is known where they apply."""
    rules = [rule for rule in task.rules if rule.action == action]
    phi = [cut(probability(belief, rule.condition), threshold) for rule in rules]
    return {
        (v, x): p
        + sum(
            f * (impact(r, v, x) - sets(r, v) * given(belief, r, v, x))
            for f, r in zip(phi, rules, strict=True)
            if f > 0
        )
        for (v, x), p in belief.items()
    }


def given(belief: Belief, rule: GroundRule, variable: int, value: int) -> float:
    """P(variable = value | what the rule's condition asks of the variable)."""
    allowed = dict(rule.condition).get(variable)
    if allowed is None:
        return belief[variable, value]
    return belief[variable, value] / sum(belief[variable, x] for x in allowed) if value in allowed else 0.0


def update_independent(task: Task, belief: Belief, action: int, threshold: float) -> Belief:
    """libPRADA's: rules of an action, and variables, are independent."""
    rules = [rule for rule in task.rules if rule.action == action]
    phi = [cut(probability(belief, rule.condition), threshold) for rule in rules]
    covers = [
        cut(prod([p, *(1 - q for j, q in enumerate(phi) if j != i)]), threshold) for i, p in enumerate(phi)
    ]
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
