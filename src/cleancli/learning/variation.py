"""How far the states are from each other that two domains foretell: total variation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple, TypeVar

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Fluent
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.compiler.prices import comes_to
from cleancli.language.model import Domain, Value
from cleancli.learning.experience import Transition

Changes = frozenset[tuple[Fluent, Value]]
"""The fluents that get other values, with these."""


class Paid(NamedTuple):
    """What an outcome changes in a state, and what it pays beside."""

    changes: Changes
    reward: Fraction = Fraction(0)
    cost: Fraction = Fraction(0)


_Result = TypeVar("_Result")


def foretold(rules: LiftedRules, transition: Transition) -> Mapping[Changes, float]:
    """What rules say that an action changes in a state, whatever it pays, and how likely."""
    likely: dict[Changes, float] = {}
    for result, share in foretold_paid(rules, transition).items():
        likely[result.changes] = likely.get(result.changes, 0.0) + share
    return likely


def foretold_paid(rules: LiftedRules, transition: Transition) -> Mapping[Paid, float]:
    """What rules say that an action changes in a state and what its outcomes pay, and how likely; noise
    changes nothing."""
    state = rules.state(transition.objects, transition.before)
    found = rules.covering(state, transition.action, transition.arguments)
    if found is None:
        return {Paid(frozenset()): 1.0}
    number, names = found
    likely: dict[Paid, float] = {}
    outcomes = rules.domain.rules[number].outcomes
    binding = dict(zip(rules[number].variables, names, strict=True))
    for outcome, changes in zip(outcomes, results(rules, state, number, names), strict=True):
        before = {key: transition.before.get(key, rules.meaning.missing(key[0])) for key in changes}
        moved = frozenset((key, value) for key, value in changes.items() if before[key] != value)
        paid = (comes_to(price, binding, transition.before) for price in (outcome.reward, outcome.cost))
        result = Paid(moved, *paid)
        likely[result] = likely.get(result, 0.0) + float(outcome.probability)
    return likely


def distance(one: Mapping[_Result, float], other: Mapping[_Result, float]) -> float:
    """The total variation of two distributions: half of what their probabilities differ by in all."""
    keys = one.keys() | other.keys()
    return sum(abs(one.get(key, 0.0) - other.get(key, 0.0)) for key in keys) / 2


def variation(one: Domain, other: Domain, transitions: Sequence[Transition]) -> float:
    """How far two domains are from each other, as the total variation of the states that follow these states
    and actions, in the mean."""
    first, second = LiftedRules(one), LiftedRules(other)
    total = sum(distance(foretold(first, each), foretold(second, each)) for each in transitions)
    return total / len(transitions)
