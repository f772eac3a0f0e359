"""Lowering for beliefs: a task becomes the flat arrays with which a belief is updated and valued.

Guaranteed by `ground`: everything is sorted, and the rules of one action stand together and exclude each
other (unless the task was grounded as libPRADA does, which `Tables.independent` is for). Lists of lists are
stored as ragged.py says.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cleancli.compiler.ragged import Bools, Floats, floats, inverse, ragged, union
from cleancli.compiler.semantics import payment
from cleancli.compiler.task import GroundCondition, GroundRule, Task, advances, asked

Indices = NDArray[np.uint32]
"""Not signed, so that compiled code need not ask whether one counts from an array's end: a quarter of its
time."""

Effects = dict[int, list[tuple[int, float]]]
"""For each variable that a rule may set, ascending, the values that its outcomes give it, and how likely."""


class Tables(NamedTuple):
    """Arrays of a task with V variables, A actions, R rules and C conditions that the reward or the goal
    asks.

    A belief is N numbers: S slots, one per value of each variable, then sums of slots, one per literal that
    allows several values, then the number 1. So a literal's probability is one of these numbers, and a
    condition's is the product of some. Rules that change nothing are left out, unless they are taken as
    independent or waiting is a choice. (A named tuple and no dataclass, because compiled code takes it as it
    is.)

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


def lower(task: Task, *, independent: bool = False) -> Tables:
    """The arrays of a task, the same for each initial state; equal tasks give equal arrays.

    `independent`: for libPRADA's update, which takes whether rules of one action apply, and the values of
    variables, as independent of each other. Then rules may overlap.
    """
    changing = [any(outcome.effects for outcome in rule.outcomes) for rule in task.rules]
    kept = [i for i, changes in enumerate(changing) if changes or independent or task.waiting]
    rules, wanted = [task.rules[i] for i in kept], asked(task)
    effects = [_effects(rule) for rule in rules]
    numbers = _Numbers(task, rules, independent)
    start = np.searchsorted([rule.action for rule in rules], np.arange(len(task.actions) + 1))
    spans = [slice(a, b) for a, b in itertools.pairwise(start.tolist())]
    guards = [numbers.guard(rules[span]) for span in spans]
    rests = [sorted(set(numbers.of(rule.condition)) - set(guards[rule.action])) for rule in rules]
    shifts = list(map(numbers.shifts, rules, effects))
    losses = list(map(numbers.losses, rules, effects))
    variables = [sorted({v for effect in effects[span] for v in effect}) for span in spans]
    sums_of = inverse(len(task.variables), [[variable] for variable, _ in numbers.sums])
    wanted_of = inverse(len(task.variables), [[v for v, _ in each.condition] for each in wanted])
    return Tables(
        numbers.slot_start.astype(np.uint32),
        *_indices(list(numbers.sums.values())),
        *_indices(guards),
        *_indices([*rests, *(numbers.of(each.condition) for each in wanted)]),
        start.astype(np.uint32),
        np.array([changing[i] or (task.waiting and not independent) for i in kept], dtype=np.bool_),
        *_indices([list(s) for s in shifts]),
        floats(p for s in shifts for p in s.values()),
        *_indices([[slot for slot, _, _ in entries] for entries in losses]),
        np.array([given for entries in losses for _, given, _ in entries], dtype=np.uint32),
        floats(p for entries in losses for _, _, p in entries),
        *_indices([numbers.slots(chosen) for chosen in variables]),
        *_indices([union(sums_of, chosen) for chosen in variables]),
        *_indices([union(wanted_of, chosen) for chosen in variables]),
        floats(action.cost for action in task.actions),
        floats(payment(task, action) for action in range(len(task.actions))),
        floats(task.discounts),
        floats(_most(task, [effects[span] for span in spans])),
        floats(each.decrease for each in wanted),
        floats(each.state for each in wanted),
        floats(advances(task)),
        floats([task.constant_reward]),
        np.array([independent]),
    )


def _indices(lists: Sequence[Sequence[int]]) -> tuple[Indices, Indices]:
    start, entries = ragged(lists)
    return start.astype(np.uint32), entries.astype(np.uint32)


def _effects(rule: GroundRule) -> Effects:
    effects: Effects = {}
    for outcome in rule.outcomes:
        if outcome.probability:
            probability = float(outcome.probability)
            for variable, value in outcome.effects:
                effects.setdefault(variable, []).append((value, probability))
    return {variable: effects[variable] for variable in sorted(effects)}


class _Numbers:
    """Which numbers of a belief literals, conditions and effects are about."""

    def __init__(self, task: Task, rules: Sequence[GroundRule], independent: bool) -> None:
        self._independent = independent
        sizes = [len(variable.values) for variable in task.variables]
        self.slot_start = np.cumsum([0, *sizes])
        self._first: list[int] = self.slot_start.tolist()
        conditions = [*(rule.condition for rule in rules), *(each.condition for each in asked(task))]
        several = {(v, tuple(sorted(a))) for condition in conditions for v, a in condition if len(a) > 1}
        self.sums = {(v, a): [self._first[v] + value for value in a] for v, a in sorted(several)}
        self._number: dict[tuple[int, tuple[int, ...]], int] = {
            literal: self._first[-1] + index for index, literal in enumerate(self.sums)
        }
        self.one = self._first[-1] + len(self.sums)

    def of(self, condition: GroundCondition) -> list[int]:
        """The numbers that the condition's probability is the product of."""
        return [self._literal(variable, allowed) for variable, allowed in condition]

    def _literal(self, variable: int, allowed: frozenset[int]) -> int:
        if len(allowed) == 1:
            (value,) = allowed
            return self._first[variable] + value
        return self._number[variable, tuple(sorted(allowed))]

    def slots(self, variables: Sequence[int]) -> list[int]:
        """Those of all their values."""
        return [slot for v in variables for slot in range(self._first[v], self._first[v + 1])]

    def guard(self, rules: Sequence[GroundRule]) -> list[int]:
        """What all the rules ask for; nothing where they are independent, because then the probability that
        one applies may be more than that of what all ask for."""
        if self._independent or not rules:
            return []
        return sorted(set.intersection(*(set(self.of(rule.condition)) for rule in rules)))

    def shifts(self, rule: GroundRule, effects: Effects) -> dict[int, float]:
        """What the rule adds to slots: what its outcomes set, less what they set where the value is known."""
        terms: dict[int, list[float]] = {}
        asked = self._asked(rule)
        for variable, entries in effects.items():
            first = self._first[variable]
            for value, probability in entries:
                terms.setdefault(first + value, []).append(probability)
            if len(asked.get(variable, ())) == 1:
                known = terms.setdefault(first + next(iter(asked[variable])), [])
                known += [-probability for _, probability in entries]
        total = {slot: math.fsum(terms[slot]) for slot in sorted(terms)}
        return {slot: shift for slot, shift in total.items() if shift}

    def losses(self, rule: GroundRule, effects: Effects) -> list[tuple[int, int, float]]:
        """Slot, given literal and probability where the value that is lost is not known."""
        losses = []
        asked = self._asked(rule)
        for variable, entries in effects.items():
            allowed = asked.get(variable)
            probability = math.fsum(p for _, p in entries)
            if allowed is None:
                losses += [(slot, self.one, probability) for slot in self.slots([variable])]
            elif len(allowed) > 1:
                given = self._literal(variable, allowed)
                losses += [(self._first[variable] + x, given, probability) for x in sorted(allowed)]
        return losses

    def _asked(self, rule: GroundRule) -> dict[int, frozenset[int]]:
        """What the update may take as known of each variable where the rule applies."""
        return {} if self._independent else dict(rule.condition)


def _most(task: Task, effects: Sequence[Sequence[Effects]]) -> list[float]:
    """Per action, with its rules' effects, what it is paid at most for the conditions that may end or begin,
    less its cost.

    A rule as likely as p changes a literal's probability by at most p times that of the outcomes that change
    it, and a product of probabilities by at most the sum of what its factors change.
    """
    asking: list[list[tuple[float, frozenset[int]]]] = [[] for _ in task.variables]
    for reward in task.rewards:
        for variable, allowed in reward.condition:
            asking[variable].append((float(reward.decrease), allowed))

    def paid(rule: Effects) -> float:
        return sum(
            probability * abs(decrease)
            for variable, entries in rule.items()
            for decrease, allowed in asking[variable]
            for value, probability in entries
            if (decrease < 0) == (value in allowed)
        )

    best = [max(map(paid, rules), default=0.0) for rules in effects]
    return [most - float(action.cost) for most, action in zip(best, task.actions, strict=True)]
