"""Lowering for exact states: a task becomes the arrays with which its process is sampled and enumerated.

Guaranteed by `ground`: everything is sorted, at most one rule of an action covers a state, and the
probabilities of its outcomes sum to 1. Lists of lists are stored as ragged.py says. The meaning is that of
transition.py.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from cleancli.compiler.ragged import Bools, Floats, Ints, floats, inverse, ragged, union
from cleancli.compiler.semantics import payment
from cleancli.compiler.task import Task, advances, asked


class Process(NamedTuple):
    """Arrays of a task with V variables, S slots, A actions, R rules, O outcomes, and C conditions that the
    reward or the goal asks.

    A state is (V,) value indices. Conditions 0..R-1 are the rules', then those that are asked. A literal is a
    variable and a row of `allowed`, which says for each of its values whether it fits."""

    sizes: Ints  # (V,) values of each variable
    slot_start: Ints  # (V + 1,) slots of each variable, one a value
    rule_start: Ints  # (A + 1,) rules of each action; rules are sorted by action
    rule_useful: Bools  # (R,) whether an outcome of the rule changes something, or waiting is a choice
    literal_start: Ints  # (R + C + 1,) literals of each condition
    literal_variable: Ints  # (n,)
    literal_row: Ints  # (n,) where the literal's row starts in `allowed`
    allowed: Bools  # (m,)
    literal_slot_start: Ints  # (n + 1,) slots of the values that fit each literal
    literal_slot: Ints  # (k,)
    outcome_start: Ints  # (R + 1,) outcomes of each rule, with probability 0 too, in the domain's order
    probability: Floats  # (O,)
    cumulated: Floats  # (O,) within each rule; exactly 1 at its last outcome
    effect_start: Ints  # (O + 1,)
    effect_variable: Ints  # (n,)
    effect_value: Ints  # (n,)
    touched_reward_start: Ints  # (A + 1,) reward conditions (from 0) that each action can change
    touched_reward: Ints  # (n,)
    cost: Floats  # (A,) as in Tables
    payment: Floats  # (A,)
    discount: Floats  # (A,)
    decrease: Floats  # (C,)
    state: Floats  # (C,)
    advance: Floats  # (C,) how much of a step's progress the end of each is
    constant: Floats  # (1,)
    waiting: Bools  # (1,) as in Task


def lower_process(task: Task) -> Process:
    """The arrays of a task, the same for each initial state; equal tasks give equal arrays."""
    wanted = asked(task)
    conditions = [*(rule.condition for rule in task.rules), *(each.condition for each in wanted)]
    sizes = [len(variable.values) for variable in task.variables]
    first = [0, *itertools.accumulate(sizes)]
    rows: dict[tuple[int, frozenset[int]], int] = {}
    allowed: list[bool] = []
    for literal in itertools.chain.from_iterable(conditions):
        if literal not in rows:
            rows[literal] = len(allowed)
            allowed += [value in literal[1] for value in range(len(task.variables[literal[0]].values))]
    outcomes = [outcome for rule in task.rules for outcome in rule.outcomes]
    cumulated = [list(itertools.accumulate(o.probability for o in rule.outcomes)) for rule in task.rules]
    rule_start = np.searchsorted([rule.action for rule in task.rules], np.arange(len(task.actions) + 1))
    literal_start, literal_variable = ragged([[variable for variable, _ in c] for c in conditions])
    effect_start, effect_variable = ragged([[variable for variable, _ in o.effects] for o in outcomes])
    return Process(
        np.array(sizes, dtype=np.int32),
        np.cumsum([0, *sizes]).astype(np.int32),
        rule_start.astype(np.int32),
        np.array(
            [task.waiting or any(o.effects for o in rule.outcomes) for rule in task.rules], dtype=np.bool_
        ),
        literal_start,
        literal_variable,
        ragged([[rows[literal] for literal in c] for c in conditions])[1],
        np.array(allowed, dtype=np.bool_),
        *ragged([[first[v] + value for value in sorted(values)] for c in conditions for v, values in c]),
        np.cumsum([0, *(len(rule.outcomes) for rule in task.rules)]).astype(np.int32),
        floats(outcome.probability for outcome in outcomes),
        floats(itertools.chain.from_iterable(cumulated)),
        effect_start,
        effect_variable,
        ragged([[value for _, value in o.effects] for o in outcomes])[1],
        *ragged(_touched_rewards(task)),
        floats(action.cost for action in task.actions),
        floats(payment(task, action) for action in range(len(task.actions))),
        floats(task.discounts),
        floats(each.decrease for each in wanted),
        floats(each.state for each in wanted),
        floats(advances(task)),
        floats([task.constant_reward]),
        np.array([task.waiting]),
    )


def _touched_rewards(task: Task) -> list[list[int]]:
    """Per action the conditions that are asked with a variable that one of its outcomes sets."""
    variables: list[set[int]] = [set() for _ in task.actions]
    for rule in task.rules:
        variables[rule.action].update(v for outcome in rule.outcomes for v, _ in outcome.effects)
    holders = inverse(len(task.variables), [[v for v, _ in each.condition] for each in asked(task)])
    return [union(holders, touched) for touched in variables]
