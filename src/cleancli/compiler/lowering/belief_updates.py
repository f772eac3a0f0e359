"""What rules do to a belief: what they add to slots, and what they take from slots."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Floats, Longs
from cleancli.compiler.lowering.belief_numbers import Conditions, Numbers
from cleancli.compiler.lowering.rule_columns import RuleColumns


class Shifts(NamedTuple):
    """By rule and slot, what is added: what outcomes set, less what they set where the value is known."""

    start: Longs  # (R + 1,)
    slot: Longs  # (n,)
    shift: Floats  # (n,)


class Losses(NamedTuple):
    """By rule and slot, how much of P(slot | given) goes where the value that is lost is not known."""

    start: Longs  # (R + 1,)
    slot: Longs  # (n,)
    given: Longs  # (n,) the number of the literal that is given
    loss: Floats  # (n,)


def shifts(columns: RuleColumns, conditions: Conditions, numbers: Numbers) -> Shifts:
    """What each rule adds; nothing that adds up to 0."""
    rule, variable, probability = columns.effect_rule, columns.effect_variable, columns.effect_probability
    given = conditions.given(rule, variable)
    known = given < numbers.slots
    owner = np.concatenate([rule, rule[known]])
    slot = np.concatenate([numbers.first[variable] + columns.effect_value, given[known]])
    terms = np.concatenate([probability, -probability[known]])
    found, total = _exact_sums(owner * numbers.slots + slot, terms)
    found, total = found[total != 0], total[total != 0]
    return Shifts(_rule_starts(found // max(numbers.slots, 1), columns), found % max(numbers.slots, 1), total)


def losses(columns: RuleColumns, conditions: Conditions, numbers: Numbers) -> Losses:
    """What each rule takes."""
    variables = len(numbers.first)
    found, total = _exact_sums(
        columns.effect_rule * variables + columns.effect_variable, columns.effect_probability
    )
    rule, variable = found // variables, found % variables
    given = conditions.given(rule, variable)
    which, slot = numbers.possible(variable, given)
    return Losses(_rule_starts(rule[which], columns), slot, given[which], total[which])


def _rule_starts(rule: Longs, columns: RuleColumns) -> Longs:
    return np.searchsorted(rule, np.arange(len(columns.action) + 1))


def _exact_sums(keys: Longs, terms: Floats) -> tuple[Longs, Floats]:
    """The keys, ascending and each once, and the sum of each one's terms, rounded once."""
    order = np.argsort(keys, kind="stable")
    found, first = np.unique(keys[order], return_index=True)
    ordered, end = terms[order], np.append(first[1:], len(keys))
    total = ordered[first]
    pairs = end - first == 2
    total[pairs] += ordered[first[pairs] + 1]
    long, values = np.flatnonzero(end - first > 2), ordered.tolist()
    spans = zip(first[long].tolist(), end[long].tolist(), strict=True)
    total[long] = [math.fsum(values[start:stop]) for start, stop in spans]
    return found, total
