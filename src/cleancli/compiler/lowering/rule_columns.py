"""A task's rules as columns: one array for each thing that is known of all their literals and effects.

Guaranteed by `ground`: rules share literals and outcomes that are the same, so these are looked at once.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from cleancli.array_types import Bools, Floats, Ints, Longs
from cleancli.compiler.ragged import distinct, floats, spans, starts
from cleancli.compiler.task import GroundLiteral, GroundRule, RewardCondition, Task

_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class RuleColumns:
    """R rules with n literals, o outcomes and m effects. All ascend by rule, and then literals by variable,
    outcomes as in the domain, and effects by outcome and variable."""

    action: Longs  # (R,)
    changes: Bools  # (R,) whether an outcome has an effect at all
    cost: Floats  # (R,) what the reward of a step loses on average by which outcome happens
    literal_rule: Longs  # (n,)
    literal: Longs  # (n,) which of `literals`
    literals: Sequence[GroundLiteral]
    probability: Floats  # (o,)
    outcome_cost: Floats  # (o,) what the reward of a step loses by it
    effect_outcome: Longs  # (m,)
    effect_rule: Longs  # (m,)
    effect_variable: Longs  # (m,)
    effect_value: Longs  # (m,)
    effect_probability: Floats  # (m,) that of its outcome; may be 0

    def possible(self) -> RuleColumns:
        """The same without effects that never happen."""
        kept = self.effect_probability != 0
        return replace(
            self,
            effect_outcome=self.effect_outcome[kept],
            effect_rule=self.effect_rule[kept],
            effect_variable=self.effect_variable[kept],
            effect_value=self.effect_value[kept],
            effect_probability=self.effect_probability[kept],
        )


def rule_columns(rules: Sequence[GroundRule]) -> RuleColumns:
    """The columns of rules."""
    everything = np.arange(len(rules))
    literals, literal = _distinct([literal for rule in rules for literal in rule.condition])
    outcomes, outcome = _distinct([outcome for rule in rules for outcome in rule.outcomes])
    outcome_rule = np.repeat(everything, [len(rule.outcomes) for rule in rules])
    effects = itertools.chain.from_iterable([outcome.effects for outcome in outcomes])
    numbers = np.fromiter(itertools.chain.from_iterable(effects), dtype=np.int64)
    variable, value = numbers.reshape(-1, 2).T
    first = starts(outcome.effects for outcome in outcomes)
    which, entry = spans(first[outcome], np.diff(first)[outcome])
    changes = np.zeros(len(rules), dtype=np.bool_)
    changes[outcome_rule[which]] = True
    probability = floats(outcome.probability for outcome in outcomes)[outcome]
    outcome_cost = floats(outcome.cost for outcome in outcomes)[outcome]
    return RuleColumns(
        action=np.array([rule.action for rule in rules], dtype=np.int64),
        changes=changes,
        cost=_summed(outcome_rule, probability * outcome_cost, len(rules)),
        literal_rule=np.repeat(everything, [len(rule.condition) for rule in rules]),
        literal=literal,
        literals=literals,
        probability=probability,
        outcome_cost=outcome_cost,
        effect_outcome=which,
        effect_rule=outcome_rule[which],
        effect_variable=variable[entry],
        effect_value=value[entry],
        effect_probability=probability[which],
    )


def _summed(rule: Longs, terms: Floats, rules: int) -> Floats:
    """The sum of each rule's terms."""
    return np.bincount(rule, terms, minlength=rules).astype(np.float64)


def _distinct(items: Sequence[_Item]) -> tuple[list[_Item], Longs]:
    """The items without those that are there already, and where each went. Told apart by identity, which is
    quick; equal ones may come several times. They stay in the order in which they come first."""
    identities = np.fromiter(map(id, items), dtype=np.int64, count=len(items))
    _, first, place = np.unique(identities, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return [items[index] for index in first[order]], rank[place]


class Touched:
    """The variables that an action can set."""

    def __init__(self, columns: RuleColumns, task: Task) -> None:
        self._actions, variables = np.arange(len(task.actions) + 1), max(len(task.variables), 1)
        keys = distinct(columns.action[columns.effect_rule] * variables + columns.effect_variable)
        self._action, self._variable = keys // variables, keys % variables

    def ranges(self, first: Longs | Ints) -> tuple[Longs, Longs]:
        """For each action what belongs to its variables, as ragged.py says, where what belongs to each
        variable stands together, from its `first` on."""
        which, entry = spans(first[self._variable], np.diff(first)[self._variable])
        return np.searchsorted(self._action[which], self._actions), entry

    def asking(self, wanted: Sequence[RewardCondition]) -> tuple[Longs, Longs]:
        """For each action which of the conditions ask for one of its variables."""
        pairs = [(v, index) for index, each in enumerate(wanted) for v, _ in each.condition]
        variable, index = np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2).T
        first = np.searchsorted(variable, self._variable)
        which, entry = spans(first, np.searchsorted(variable, self._variable, side="right") - first)
        found = distinct(self._action[which] * max(len(wanted), 1) + index[entry])
        return np.searchsorted(found // max(len(wanted), 1), self._actions), found % max(len(wanted), 1)
