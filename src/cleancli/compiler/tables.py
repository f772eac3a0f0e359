"""Lowering: a task becomes flat numpy arrays, with the inverse indices that a belief update needs.

Guaranteed by `ground`: everything is sorted, and the rules of one action stand together and exclude each
other. A variable owns one slot per value; a belief is a probability per slot. Lists of lists are stored as
ragged.py says.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from cleancli.compiler.ragged import Bools, Floats, Ints, floats, inverse, ragged, union
from cleancli.compiler.task import GroundRule, Task
from cleancli.compiler.transition import payment


class Tables(NamedTuple):
    """Arrays of a task with V variables, S slots, A actions, R rules, C reward conditions and F factors.

    A factor is the probability that a variable has one of some values: a sum of slots, shared by all
    conditions that ask for it. A condition is a product of factors; conditions 0..R-1 are the rules', the
    other C those of the reward. (A named tuple and no dataclass, because compiled code takes it as it is.)
    """

    slot_start: Ints  # (V + 1,) slots of each variable
    factor_slot_start: Ints  # (F + 1,)
    factor_slot: Ints  # (n,) slots that each factor sums
    condition_factor_start: Ints  # (R + C + 1,)
    condition_factor: Ints  # (n,) factors that each condition multiplies
    rule_start: Ints  # (A + 1,) rules of each action; rules are sorted by action
    rule_changes: Bools  # (R,) whether an outcome of the rule changes something
    set_start: Ints  # (R + 1,)
    set_variable: Ints  # (n,) variables that outcomes of each rule set
    set_probability: Floats  # (n,) probability that the rule sets that variable at all
    impact_start: Ints  # (R + 1,)
    impact_slot: Ints  # (n,) slots that outcomes of each rule set
    impact_probability: Floats  # (n,) total probability of the outcomes that set that slot
    touched_variable_start: Ints  # (A + 1,)
    touched_variable: Ints  # (n,) variables that each action can set
    touched_factor_start: Ints  # (A + 1,)
    touched_factor: Ints  # (n,) factors over those variables
    touched_condition_start: Ints  # (A + 1,)
    touched_condition: Ints  # (n,) conditions with one of those factors, ascending, so rules come first
    touched_action_start: Ints  # (A + 1,)
    touched_action: Ints  # (n,) actions with one of those rules
    cost: Floats  # (A,) what the reward of a step loses by each action
    payment: Floats  # (A,) what the reward of a step by each action is multiplied by
    discount: Floats  # (A,) what all that comes after each action is multiplied by
    decrease: Floats  # (C,) what each reward condition pays when it ends
    state: Floats  # (C,) what each reward condition pays after a step in which it holds
    constant: Floats  # (1,) what each step pays in any state


def lower(task: Task) -> Tables:
    """The arrays of a task, the same for each initial state; equal tasks give equal arrays."""
    slot_start = np.cumsum([0, *(len(variable.values) for variable in task.variables)]).astype(np.int32)
    conditions = [*(rule.condition for rule in task.rules), *(reward.condition for reward in task.rewards)]
    factors = sorted({_factor(pair) for condition in conditions for pair in condition})
    number = {factor: index for index, factor in enumerate(factors)}
    changes = np.array([any(o.effects for o in rule.outcomes) for rule in task.rules], dtype=np.bool_)
    rule_start = np.searchsorted([rule.action for rule in task.rules], np.arange(len(task.actions) + 1))
    impacts = [_impact(rule, slot_start) for rule in task.rules]
    sets = [_set(rule) for rule in task.rules]
    touched = _Touched(task, factors, [[number[_factor(pair)] for pair in c] for c in conditions])
    return Tables(
        slot_start,
        *ragged([[int(slot_start[v]) + value for value in values] for v, values in factors]),
        *ragged(touched.condition_factors),
        rule_start.astype(np.int32),
        changes,
        *ragged([list(s) for s in sets]),
        floats(p for s in sets for p in s.values()),
        *ragged([list(i) for i in impacts]),
        floats(p for i in impacts for p in i.values()),
        *ragged(touched.variables),
        *ragged(touched.factors),
        *ragged(touched.conditions),
        *ragged(touched.actions),
        floats(action.cost for action in task.actions),
        floats(payment(task, action) for action in range(len(task.actions))),
        floats(task.discounts),
        floats(reward.decrease for reward in task.rewards),
        floats(reward.state for reward in task.rewards),
        floats([task.constant_reward]),
    )


def _factor(pair: tuple[int, frozenset[int]]) -> tuple[int, tuple[int, ...]]:
    return pair[0], tuple(sorted(pair[1]))


def _impact(rule: GroundRule, slot_start: Ints) -> dict[int, Fraction]:
    """Per slot the total probability of the outcomes that set it."""
    impact: dict[int, Fraction] = {}
    for outcome in rule.outcomes:
        for variable, value in outcome.effects:
            slot = int(slot_start[variable]) + value
            impact[slot] = impact.get(slot, Fraction(0)) + outcome.probability
    return dict(sorted(impact.items()))


def _set(rule: GroundRule) -> dict[int, Fraction]:
    """Per variable the total probability of the outcomes that set it."""
    probability: dict[int, Fraction] = {}
    for outcome in rule.outcomes:
        for variable, _ in outcome.effects:
            probability[variable] = probability.get(variable, Fraction(0)) + outcome.probability
    return dict(sorted(probability.items()))


class _Touched:
    """What each action makes stale: variables, factors over them, their conditions, weights of actions."""

    def __init__(
        self,
        task: Task,
        factors: Sequence[tuple[int, tuple[int, ...]]],
        condition_factors: Sequence[Sequence[int]],
    ) -> None:
        self.condition_factors = condition_factors
        variables: list[set[int]] = [set() for _ in task.actions]
        for rule in task.rules:
            variables[rule.action].update(v for outcome in rule.outcomes for v, _ in outcome.effects)
        factors_of = inverse(len(task.variables), [[variable] for variable, _ in factors])
        conditions_of = inverse(len(factors), condition_factors)
        self.variables = [sorted(touched) for touched in variables]
        self.factors = [union(factors_of, touched) for touched in self.variables]
        self.conditions = [union(conditions_of, touched) for touched in self.factors]
        self.actions = [
            sorted({task.rules[c].action for c in touched if c < len(task.rules)})
            for touched in self.conditions
        ]
