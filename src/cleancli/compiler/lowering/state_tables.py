"""Lowering for exact states: a task becomes the arrays with which its process is sampled and enumerated.

Guaranteed by `ground`: everything is sorted, at most one rule of an action covers a state, and the
probabilities of its outcomes sum to 1. Lists of lists are stored as ragged.py says. The meaning is that of
transition.py.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Ints, Longs
from cleancli.compiler.collector import paused_collector
from cleancli.compiler.lowering.rule_columns import RuleColumns, Touched, rule_columns
from cleancli.compiler.ragged import floats, ragged, spans, starts
from cleancli.compiler.semantics import payment
from cleancli.compiler.task import GroundCondition, GroundRule, StateVariable, Task, advances, asked


class Process(NamedTuple):
    """Arrays of a task with V variables, S slots, A actions, R rules, O outcomes, and C conditions that the
    reward or the goal asks.

    A state is (V,) value indices. Conditions 0..R-1 are the rules', then those that are asked. A literal is a
    variable and a row of `allowed`, which says for each of its values whether it fits."""

    sizes: Ints  # (V,) values of each variable
    slot_start: Ints  # (V + 1,) slots of each variable, one a value
    rule_start: Ints  # (A + 1,) rules of each action; rules are sorted by action
    rule_useful: Bools  # (R,) whether an outcome of the rule changes something, or waiting is a choice
    rule_pays: Bools  # (R,) whether an outcome of the rule costs or earns something
    literal_start: Ints  # (R + C + 1,) literals of each condition
    literal_variable: Ints  # (n,)
    literal_row: Ints  # (n,) where the literal's row starts in `allowed`
    allowed: Bools  # (m,)
    literal_slot_start: Ints  # (n + 1,) slots of the values that fit each literal
    literal_slot: Ints  # (k,)
    outcome_start: Ints  # (R + 1,) outcomes of each rule, with probability 0 too, in the domain's order
    probability: Floats  # (O,)
    outcome_cost: Floats  # (O,) what the reward of a step loses by it, beside what its action costs
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
    columns, wanted = rule_columns(task.rules), asked(task)
    literals = _Literals(columns, [each.condition for each in wanted], task.variables)
    touched_reward_start, touched_reward = Touched(columns, task).asking(wanted)
    return Process(
        sizes=_ints([len(variable.values) for variable in task.variables]),
        slot_start=literals.slot_start,
        rule_start=_ints(np.searchsorted(columns.action, np.arange(len(task.actions) + 1))),
        rule_useful=columns.changes | task.waiting,
        rule_pays=np.array([rule.pays for rule in task.rules], dtype=np.bool_),
        literal_start=literals.start,
        literal_variable=literals.variable,
        literal_row=literals.row,
        allowed=literals.allowed,
        literal_slot_start=literals.of_slot_start,
        literal_slot=literals.of_slot,
        outcome_start=starts(rule.outcomes for rule in task.rules),
        probability=columns.probability,
        outcome_cost=columns.outcome_cost,
        cumulated=_cumulated(task.rules),
        effect_start=_ints(np.searchsorted(columns.effect_outcome, np.arange(len(columns.probability) + 1))),
        effect_variable=_ints(columns.effect_variable),
        effect_value=_ints(columns.effect_value),
        touched_reward_start=_ints(touched_reward_start),
        touched_reward=_ints(touched_reward),
        cost=floats(action.cost for action in task.actions),
        payment=floats(payment(task, action) for action in range(len(task.actions))),
        discount=floats(task.discounts),
        decrease=floats(each.decrease for each in wanted),
        state=floats(each.state for each in wanted),
        advance=floats(advances(task)),
        goal=np.array([each.condition in task.goal for each in asked(task)], dtype=np.bool_),
        constant=floats([task.constant_reward]),
        waiting=np.array([task.waiting]),
    )


def _ints(values: Longs | Sequence[int]) -> Ints:
    return np.asarray(values, dtype=np.int32)


class _Literals:
    """The literals of rules and then of what is asked, as `Process` has them."""

    def __init__(
        self, columns: RuleColumns, wanted: Sequence[GroundCondition], variables: Sequence[StateVariable]
    ) -> None:
        more = [literal for condition in wanted for literal in condition]
        literals = [*columns.literals, *more]
        which = np.concatenate([columns.literal, len(columns.literals) + np.arange(len(more))])
        lengths = np.bincount(columns.literal_rule, minlength=len(columns.action))
        self.start = _ints(np.cumsum([0, *lengths, *map(len, wanted)]))
        rows = list(dict.fromkeys(literals))  # of `allowed`
        sizes = [len(variables[v].values) for v, _ in rows]
        row_start = dict(zip(rows, starts(map(range, sizes)).tolist(), strict=False))
        fits = [
            value in allowed for (_, allowed), size in zip(rows, sizes, strict=True) for value in range(size)
        ]
        self.allowed: Bools = np.array(fits, dtype=np.bool_)
        self.variable = _ints([variable for variable, _ in literals])[which]
        self.row = _ints([row_start[literal] for literal in literals])[which]
        self.slot_start = starts(variable.values for variable in variables)
        first, slots = ragged(
            [[self.slot_start[v] + value for value in sorted(allowed)] for v, allowed in literals]
        )
        count = np.diff(first)[which]
        self.of_slot_start = _ints(np.cumsum([0, *count]))
        self.of_slot = slots[spans(first[which], count)[1]]


def _cumulated(rules: Sequence[GroundRule]) -> Floats:
    """The probabilities of each rule's outcomes added up, exactly and then as numbers; most rules share
    theirs."""
    known: dict[tuple[int, ...], list[float]] = {}
    found: list[float] = []
    for rule in rules:
        name = tuple([id(outcome.probability) for outcome in rule.outcomes])
        if name not in known:
            sums = itertools.accumulate(outcome.probability for outcome in rule.outcomes)
            known[name] = [float(each) for each in sums]
        found += known[name]
    return np.array(found, dtype=np.float64)
