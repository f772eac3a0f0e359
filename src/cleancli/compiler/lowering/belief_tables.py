"""Lowering for beliefs: a task becomes the flat arrays with which a belief is updated and valued.

Guaranteed by `ground`: everything is sorted, and the rules of one action stand together and exclude each
other (unless the task was grounded as libPRADA does, which `Tables.independent` is for). Lists of lists are
stored as ragged.py says.
"""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np

from cleancli.array_types import Bools, Floats, Indices
from cleancli.compiler.collector import paused_collector
from cleancli.compiler.ragged import floats, grouped, overlapping, ragged, starts
from cleancli.compiler.semantics import payment
from cleancli.compiler.task import (
    GroundCondition,
    GroundLiteral,
    GroundRule,
    Task,
    advances,
    asked,
    variables_of,
)

Effects = dict[int, list[tuple[int, float]]]
"""For each variable that a rule may set, ascending, the values that its outcomes give it, and how likely."""

Losses = dict[int, tuple[int, float]]
"""Per slot that loses, the number of the literal that is given, and how much of P(slot | given) goes."""

_Entry = TypeVar("_Entry")


class Tables(NamedTuple):
    """Arrays of a task with V variables, A actions, R rules and C conditions that the reward or the goal
    asks.

    A belief is N numbers: S slots, one per value of each variable, then sums of slots, one per literal that
    allows several values, then the number 1. So a literal's probability is one of these numbers, and a
    condition's is the product of some. Slots and sums of one action or rule ascend. Rules that change nothing
    are left out, unless they are taken as independent or waiting is a choice. (A named tuple and no
    dataclass, because compiled code takes it as it is.)

    An update by a rule with probability p adds p · `shift` to slots, and takes p · `loss` · P(slot | given)
    from others.
    """

    slot_start: Indices  # (V + 1,) slots of each variable
    sum_start: Indices  # (N - S,)
    sum_slot: Indices  # (n,) slots that each sum adds
    guard_start: Indices  # (A + 1,)
    guard: Indices  # (n,) numbers that all conditions of each action's rules multiply
    condition_start: Indices  # (R + C + 1,)
    condition: Indices  # (n,) numbers that each condition multiplies (a rule's: beside the guard)
    rule_start: Indices  # (A + 1,) rules of each action; rules are sorted by action
    useful: Bools  # (R,) whether an outcome of the rule changes something, or waiting is a choice
    shift_start: Indices  # (R + 1,)
    shift_slot: Indices  # (n,)
    shift: Floats  # (n,)
    loss_start: Indices  # (R + 1,)
    loss_slot: Indices  # (n,)
    loss_given: Indices  # (n,) the number of the literal that the rule asks of the slot's variable
    loss: Floats  # (n,)
    touched_slot_start: Indices  # (A + 1,)
    touched_slot: Indices  # (n,) slots of variables that each action can set
    touched_sum_start: Indices  # (A + 1,)
    touched_sum: Indices  # (n,) sums (from 0) of those slots
    touched_reward_start: Indices  # (A + 1,)
    touched_reward: Indices  # (n,) reward conditions (from 0) that ask for those variables
    cost: Floats  # (A,) what the reward of a step loses by each action
    payment: Floats  # (A,) what the reward of a step by each action is multiplied by
    discount: Floats  # (A,) what all that comes after each action is multiplied by
    most: Floats  # (A,) what an action is paid at most for conditions that end, less its cost
    decrease: Floats  # (C,) what each reward condition pays when it ends
    state: Floats  # (C,) what each reward condition pays after a step in which it holds
    advance: Floats  # (C,) how much of a step's progress the end of each condition is
    constant: Floats  # (1,) what each step pays in any state
    independent: Bools  # (1,) whether the rules of an action are taken as independent, as libPRADA does


@paused_collector()
def lower(task: Task, *, independent: bool = False) -> Tables:
    """The arrays of a task, the same for each initial state; equal tasks give equal arrays.

    `independent`: for libPRADA's update, which takes whether rules of one action apply, and the values of
    variables, as independent of each other. Then rules may overlap.
    """
    rules = [_merged(rule, independent) for rule in task.rules if task.waiting or independent or rule.changes]
    rules_of = grouped(rules, [rule.action for rule in rules], len(task.actions))
    wanted = [each.condition for each in asked(task)]
    numbers = _Numbers(task, [*(rule.condition for rule in rules), *wanted])
    guards = list(map(numbers.guard, rules_of))
    beside = [numbers.beside(guards[rule.action], rule.condition) for rule in rules]
    shifts = list(map(numbers.shifts, rules))
    losses = list(map(numbers.losses, rules))
    touched = [sorted(set().union(*(rule.effects for rule in group))) for group in rules_of]

    sum_start, sum_slot = _indices(numbers.sums.values())
    guard_start, guard = _indices(guards)
    condition_start, condition = _indices([*beside, *map(numbers.of, wanted)])
    shift_start, shift_slot = _indices(shifts)
    loss_start, loss_slot = _indices(losses)
    touched_slot_start, touched_slot = _indices(map(numbers.slots, touched))
    touched_sum_start, touched_sum = _indices(overlapping([[v] for v, _ in numbers.sums], touched))
    touched_reward_start, touched_reward = _indices(overlapping(map(variables_of, wanted), touched))
    return Tables(
        slot_start=np.array(numbers.first, dtype=np.uint32),
        sum_start=sum_start,
        sum_slot=sum_slot,
        guard_start=guard_start,
        guard=guard,
        condition_start=condition_start,
        condition=condition,
        rule_start=starts(rules_of).astype(np.uint32),
        useful=np.array(
            [rule.changes or (task.waiting and not independent) for rule in rules], dtype=np.bool_
        ),
        shift_start=shift_start,
        shift_slot=shift_slot,
        shift=floats(_entries(shifts)),
        loss_start=loss_start,
        loss_slot=loss_slot,
        loss_given=np.array([given for given, _ in _entries(losses)], dtype=np.uint32),
        loss=floats(probability for _, probability in _entries(losses)),
        touched_slot_start=touched_slot_start,
        touched_slot=touched_slot,
        touched_sum_start=touched_sum_start,
        touched_sum=touched_sum,
        touched_reward_start=touched_reward_start,
        touched_reward=touched_reward,
        cost=floats(action.cost for action in task.actions),
        payment=floats(payment(task, action) for action in range(len(task.actions))),
        discount=floats(task.discounts),
        most=floats(_most(task, rules_of)),
        decrease=floats(each.decrease for each in asked(task)),
        state=floats(each.state for each in asked(task)),
        advance=floats(advances(task)),
        constant=floats([task.constant_reward]),
        independent=np.array([independent]),
    )


@dataclass(frozen=True, slots=True)
class _Rule:
    """A rule as a belief meets it: its outcomes are merged, variable by variable. `known` has what an update
    may take as known where the rule applies; `changes` tells whether an outcome has an effect at all."""

    action: int
    condition: GroundCondition
    known: dict[int, frozenset[int]]
    effects: Effects
    changes: bool


def _merged(rule: GroundRule, independent: bool) -> _Rule:
    effects: Effects = defaultdict(list)
    for outcome in rule.outcomes:
        probability = float(outcome.probability)
        for variable, value in outcome.effects if probability else ():
            effects[variable].append((value, probability))
    ordered = {variable: effects[variable] for variable in sorted(effects)}
    known = {} if independent else dict(rule.condition)
    return _Rule(rule.action, rule.condition, known, ordered, rule.changes)


def _indices(lists: Iterable[Collection[int]]) -> tuple[Indices, Indices]:
    start, entries = ragged(list(lists))
    return start.astype(np.uint32), entries.astype(np.uint32)


def _entries(mappings: Iterable[Mapping[int, _Entry]]) -> list[_Entry]:
    return [entry for mapping in mappings for entry in mapping.values()]


class _Numbers:
    """Which numbers of a belief literals, conditions and effects are about.

    `first` has each variable's first slot, and how many slots there are; `sums` the slots that are added for
    each literal that allows several values.
    """

    def __init__(self, task: Task, conditions: Iterable[GroundCondition]) -> None:
        self.first = [0, *itertools.accumulate(len(variable.values) for variable in task.variables)]
        literals = (literal for condition in conditions for literal in condition)
        several = sorted({(v, tuple(sorted(allowed))) for v, allowed in literals if len(allowed) > 1})
        self.sums = {(v, values): [self.first[v] + value for value in values] for v, values in several}
        self._sum = {literal: self.first[-1] + index for index, literal in enumerate(self.sums)}
        self._one = self.first[-1] + len(self.sums)

    def slots(self, variables: Iterable[int]) -> list[int]:
        """Those of all their values."""
        return [slot for v in variables for slot in range(self.first[v], self.first[v + 1])]

    def of(self, condition: Iterable[GroundLiteral]) -> list[int]:
        """The numbers that the condition's probability is the product of."""
        return [self._literal(variable, allowed) for variable, allowed in condition]

    def _literal(self, variable: int, allowed: frozenset[int]) -> int:
        if len(allowed) == 1:
            (value,) = allowed
            return self.first[variable] + value
        return self._sum[variable, tuple(sorted(allowed))]

    def guard(self, rules: Sequence[_Rule]) -> list[int]:
        """The numbers of the literals that are known wherever one of the rules applies. (Where rules are
        independent, the probability that one applies may be more than that of what all ask for.)"""
        if not rules:
            return []
        return sorted(set.intersection(*(set(self.of(rule.known.items())) for rule in rules)))

    def beside(self, guard: Iterable[int], condition: GroundCondition) -> list[int]:
        """The numbers of the condition that the guard of its action does not multiply."""
        return sorted({*self.of(condition)}.difference(guard))

    def shifts(self, rule: _Rule) -> dict[int, float]:
        """What the rule adds to slots: what its outcomes set, less what they set where the value is known."""
        terms: defaultdict[int, list[float]] = defaultdict(list)
        for variable, entries in rule.effects.items():
            for value, probability in entries:
                terms[self.first[variable] + value].append(probability)
            if len(rule.known.get(variable, ())) == 1:
                (value,) = rule.known[variable]
                terms[self.first[variable] + value] += [-probability for _, probability in entries]
        total = {slot: math.fsum(terms[slot]) for slot in sorted(terms)}
        return {slot: shift for slot, shift in total.items() if shift}

    def losses(self, rule: _Rule) -> Losses:
        """What the rule takes from slots where the value that is lost is not known."""
        losses = {}
        for variable, entries in rule.effects.items():
            slots, given = self._possible(variable, rule.known.get(variable))
            probability = math.fsum(p for _, p in entries)
            losses.update(dict.fromkeys(slots, (given, probability)))
        return losses

    def _possible(self, variable: int, allowed: frozenset[int] | None) -> tuple[list[int], int]:
        """Slots of the values among which the variable's is not known, and the number of the literal that
        allows them; no slots where one value alone is allowed."""
        if allowed is None:
            return self.slots([variable]), self._one
        if len(allowed) == 1:
            return [], self._one
        return self.sums[variable, tuple(sorted(allowed))], self._literal(variable, allowed)


def _most(task: Task, rules_of: Sequence[Sequence[_Rule]]) -> list[float]:
    """Per action, with its rules, what it is paid at most for the conditions that may end or begin, less its
    cost.

    A rule as likely as p changes a literal's probability by at most p times that of the outcomes that change
    it, and a product of probabilities by at most the sum of what its factors change.
    """
    asking: list[list[tuple[float, frozenset[int]]]] = [[] for _ in task.variables]
    for reward in task.rewards:
        for variable, allowed in reward.condition:
            asking[variable].append((float(reward.decrease), allowed))
    best = [max((_paid_at_most(rule, asking) for rule in rules), default=0.0) for rules in rules_of]
    return [most - float(action.cost) for most, action in zip(best, task.actions, strict=True)]


def _paid_at_most(rule: _Rule, asking: Sequence[Sequence[tuple[float, frozenset[int]]]]) -> float:
    """`asking` has, for each variable, what the conditions pay that ask for it, and the values they allow."""
    return sum(
        probability * abs(decrease)
        for variable, entries in rule.effects.items()
        for decrease, allowed in asking[variable]
        for value, probability in entries
        if (decrease < 0) == (value in allowed)
    )
