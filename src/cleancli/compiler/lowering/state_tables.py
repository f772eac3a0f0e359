"""Lowering for exact states: a task becomes the arrays with which its process is sampled and enumerated.

Guaranteed by `ground`: everything is sorted, at most one rule of an action covers a state, and the
probabilities of its outcomes sum to 1. Lists of lists are stored as ragged.py says. The meaning is that of
transition.py.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Ints
from cleancli.compiler.collector import paused_collector
from cleancli.compiler.ragged import floats, grouped, overlapping, ragged, starts
from cleancli.compiler.semantics import payment
from cleancli.compiler.task import GroundLiteral, GroundRule, Task, advances, asked, variables_of


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
    goal: Bools  # (C,) of which one holds where the goal does, unless it always holds
    constant: Floats  # (1,)
    waiting: Bools  # (1,) as in Task


@paused_collector()
def lower_process(task: Task) -> Process:
    """The arrays of a task, the same for each initial state; equal tasks give equal arrays."""
    wanted = [each.condition for each in asked(task)]
    conditions = [*(rule.condition for rule in task.rules), *wanted]
    literals = [literal for condition in conditions for literal in condition]
    rows = list(dict.fromkeys(literals))  # of `allowed`
    row_start = dict(zip(rows, starts(task.variables[v].values for v, _ in rows), strict=False))
    slot_start = starts(variable.values for variable in task.variables)
    slots = [[slot_start[v] + value for value in sorted(allowed)] for v, allowed in literals]
    literal_slot_start, literal_slot = ragged(slots)
    rules_of = grouped(task.rules, [rule.action for rule in task.rules], len(task.actions))
    touched = overlapping(map(variables_of, wanted), map(_touched, rules_of))
    touched_reward_start, touched_reward = ragged(touched)
    outcomes = [outcome for rule in task.rules for outcome in rule.outcomes]
    effects = [effect for outcome in outcomes for effect in outcome.effects]
    return Process(
        sizes=np.array([len(variable.values) for variable in task.variables], dtype=np.int32),
        slot_start=slot_start,
        rule_start=starts(rules_of),
        rule_useful=np.array([task.waiting or rule.changes for rule in task.rules], dtype=np.bool_),
        literal_start=starts(conditions),
        literal_variable=np.array([variable for variable, _ in literals], dtype=np.int32),
        literal_row=np.array([row_start[literal] for literal in literals], dtype=np.int32),
        allowed=np.array(_fits(task, rows), dtype=np.bool_),
        literal_slot_start=literal_slot_start,
        literal_slot=literal_slot,
        outcome_start=starts(rule.outcomes for rule in task.rules),
        probability=floats(outcome.probability for outcome in outcomes),
        cumulated=floats(itertools.chain.from_iterable(map(_cumulated, task.rules))),
        effect_start=starts(outcome.effects for outcome in outcomes),
        effect_variable=np.array([variable for variable, _ in effects], dtype=np.int32),
        effect_value=np.array([value for _, value in effects], dtype=np.int32),
        touched_reward_start=touched_reward_start,
        touched_reward=touched_reward,
        cost=floats(action.cost for action in task.actions),
        payment=floats(payment(task, action) for action in range(len(task.actions))),
        discount=floats(task.discounts),
        decrease=floats(each.decrease for each in asked(task)),
        state=floats(each.state for each in asked(task)),
        advance=floats(advances(task)),
        goal=np.array([each.condition in task.goal for each in asked(task)], dtype=np.bool_),
        constant=floats([task.constant_reward]),
        waiting=np.array([task.waiting]),
    )


def _fits(task: Task, literals: Iterable[GroundLiteral]) -> list[bool]:
    """For each literal, and each value of its variable, whether the literal allows it."""
    return [value in allowed for v, allowed in literals for value in range(len(task.variables[v].values))]


def _cumulated(rule: GroundRule) -> Iterator[Fraction]:
    return itertools.accumulate(outcome.probability for outcome in rule.outcomes)


def _touched(rules: Iterable[GroundRule]) -> set[int]:
    """The variables that an outcome of the rules sets."""
    return {variable for rule in rules for outcome in rule.outcomes for variable, _ in outcome.effects}
