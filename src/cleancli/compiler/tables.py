"""Lowering: a task becomes flat numpy arrays, with the inverse indices that a belief update needs.

Guaranteed by `ground`: everything is sorted, and the rules of one action stand together and exclude each
other. A variable owns one slot per value; a belief is a probability per slot. Ragged lists are stored as two
arrays: the entries of item i of `x` are `x[x_start[i] : x_start[i + 1]]`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cleancli.compiler.task import GroundRule, Task
from cleancli.compiler.transition import standing

Ints = NDArray[np.int32]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class Tables(NamedTuple):
    """Arrays of a task with V variables, S slots, A actions, R rules, C reward conditions and F factors.

    A factor is the probability that a variable has one of some values: a sum of slots, shared by all
    conditions that ask for it. A condition is a product of factors; conditions 0..R-1 are the rules', the
    other C those of the reward. (A named tuple and no dataclass, because compiled code takes it as it is.)
    """

    slot_start: Ints  # (V + 1,) slots of each variable
    initial: Floats  # (S,) 1 at the initial values, else 0
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
    decrease: Floats  # (C,) what each reward condition pays when it ends
    state: Floats  # (C,) what each reward condition pays after a step in which it holds
    standing: Floats  # (1,) what doing nothing in the initial state is paid


def lower(task: Task) -> Tables:
    """The arrays of a task; equal tasks give equal arrays."""
    slot_start = np.cumsum([0, *(len(variable.values) for variable in task.variables)]).astype(np.int32)
    initial = np.zeros(int(slot_start[-1]))
    initial[slot_start[:-1] + np.asarray(task.initial, dtype=np.int32)] = 1.0
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
        initial,
        *_ragged([[int(slot_start[v]) + value for value in values] for v, values in factors]),
        *_ragged(touched.condition_factors),
        rule_start.astype(np.int32),
        changes,
        *_ragged([list(s) for s in sets]),
        _floats(p for s in sets for p in s.values()),
        *_ragged([list(i) for i in impacts]),
        _floats(p for i in impacts for p in i.values()),
        *_ragged(touched.variables),
        *_ragged(touched.factors),
        *_ragged(touched.conditions),
        *_ragged(touched.actions),
        _floats(action.cost for action in task.actions),
        _floats(reward.decrease for reward in task.rewards),
        _floats(reward.state for reward in task.rewards),
        np.array([standing(task, task.initial)]),
    )


def _factor(pair: tuple[int, frozenset[int]]) -> tuple[int, tuple[int, ...]]:
    return pair[0], tuple(sorted(pair[1]))


def _impact(rule: GroundRule, slot_start: Ints) -> dict[int, float]:
    """Per slot the total probability of the outcomes that set it."""
    impact: dict[int, float] = {}
    for outcome in rule.outcomes:
        for variable, value in outcome.effects:
            slot = int(slot_start[variable]) + value
            impact[slot] = impact.get(slot, 0.0) + outcome.probability
    return dict(sorted(impact.items()))


def _set(rule: GroundRule) -> dict[int, float]:
    """Per variable the total probability of the outcomes that set it."""
    probability: dict[int, float] = {}
    for outcome in rule.outcomes:
        for variable, _ in outcome.effects:
            probability[variable] = probability.get(variable, 0.0) + outcome.probability
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
        factors_of = _inverse(len(task.variables), [[variable] for variable, _ in factors])
        conditions_of = _inverse(len(factors), condition_factors)
        self.variables = [sorted(touched) for touched in variables]
        self.factors = [_union(factors_of, touched) for touched in self.variables]
        self.conditions = [_union(conditions_of, touched) for touched in self.factors]
        self.actions = [
            sorted({task.rules[c].action for c in touched if c < len(task.rules)})
            for touched in self.conditions
        ]


def _inverse(size: int, lists: Sequence[Sequence[int]]) -> list[list[int]]:
    """For each member below `size`, which of the lists have it."""
    holders: list[list[int]] = [[] for _ in range(size)]
    for index, members in enumerate(lists):
        for member in members:
            holders[member].append(index)
    return holders


def _union(lists: Sequence[Sequence[int]], chosen: Iterable[int]) -> list[int]:
    return sorted({member for index in chosen for member in lists[index]})


def _ragged(lists: Sequence[Sequence[int]]) -> tuple[Ints, Ints]:
    """Starts and entries of a list of lists."""
    start = np.cumsum([0, *map(len, lists)]).astype(np.int32)
    return start, np.array([entry for entries in lists for entry in entries], dtype=np.int32)


def _floats(values: Iterable[float]) -> Floats:
    return np.fromiter(values, dtype=np.float64)
