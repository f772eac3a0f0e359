"""Rules of two domains side by side: which say the same, and in which states what they foretell differs.

Both domains have one vocabulary (`vocabulary_differences`). A state comes with an action in it, as a
transition whose state after is not looked at. What an outcome pays belongs to what is foretold.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from cleancli.compiler.fluents import Fluent
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Object
from cleancli.learning.experience import Transition
from cleancli.learning.likeness import Likeness, likeness
from cleancli.learning.variation import distance, foretold_paid


@dataclass(frozen=True, slots=True)
class Witness:
    """A state and an action for which what two domains foretell is so far apart (total variation)."""

    transition: Transition
    distance: float


@dataclass(frozen=True, slots=True)
class RulePair:
    """The states that a rule of the first domain covers and one of the second, by their indices; None:
    no rule does.

    `total` is the total variation of what they foretell there, in all; `witness` is where it is the most,
    None where it is nowhere more than rounding.
    """

    action: str
    first: int | None
    second: int | None
    likeness: Likeness
    states: int
    total: float
    witness: Witness | None


@dataclass(frozen=True, slots=True)
class Comparison:
    """The pairs of rules that some state, or their text, brings together, and the rules that none does.

    `variation` is the total variation over all states in the mean. In `unclear` of them, which count for
    nothing, an outcome gives one fact two values (E602); `conflict` says so of the first.
    """

    pairs: tuple[RulePair, ...]
    states: int
    variation: float
    unclear: int
    conflict: Diagnostic | None


NEGLIGIBLE = 1e-9
"""A total variation up to which rules foretell the same; more than rounding makes."""


def compared(one: Domain, other: Domain, states: Iterable[Transition]) -> Comparison:
    """What the rules of two domains foretell in these states, side by side."""
    both = LiftedRules(one), LiftedRules(other)
    numbers: Counter[_Key] = Counter()
    totals: dict[_Key, float] = {}
    worst: dict[_Key, Witness] = {}
    conflict: Diagnostic | None = None
    seen = unclear = 0
    for each in states:
        try:
            off = _distance(both, each)
        except Refused as refused:
            unclear += 1
            conflict = conflict or refused.diagnostics[0]
            continue
        seen += 1
        first, second = (_covering(rules, each) for rules in both)
        key = each.action, first, second
        numbers[key] += 1
        totals[key] = totals.get(key, 0.0) + off
        if off > max(NEGLIGIBLE, worst[key].distance if key in worst else 0.0):
            worst[key] = Witness(each, off)
    pairs = [
        RulePair(
            *key,
            _likeness(one, other, *key[1:]),
            numbers[key],
            totals.get(key, 0.0),
            _small(both, worst.get(key)),
        )
        for key in _keys(one, other, numbers)
    ]
    return Comparison(tuple(pairs), seen, sum(totals.values()) / seen if seen else 0.0, unclear, conflict)


_Key = tuple[str, int | None, int | None]


def _keys(one: Domain, other: Domain, met: Iterable[_Key]) -> list[_Key]:
    """What met in some state, rules of one text, and the rules that are in neither, in the order of
    actions and rules."""
    found = [key for key in met if key[1:] != (None, None)]
    pairs = itertools.product(enumerate(one.rules), enumerate(other.rules))
    found += [
        (rule.action, first, second)
        for (first, rule), (second, like) in pairs
        if rule.action == like.action and likeness(one, rule, other, like) is not Likeness.OTHER
    ]
    for side, domain in ((1, one), (2, other)):
        there = {key[side] for key in found}
        alone = ((number, rule.action) for number, rule in enumerate(domain.rules) if number not in there)
        found += [(name, number, None) if side == 1 else (name, None, number) for number, name in alone]
    order = {action.name: number for number, action in enumerate(one.actions)}

    def place(key: _Key) -> tuple[float, ...]:
        return order[key[0]], *(float("inf") if each is None else each for each in key[1:])

    return sorted(set(found), key=place)


def _covering(rules: LiftedRules, transition: Transition) -> int | None:
    state = rules.state(transition.objects, transition.before)
    found = rules.covering(state, transition.action, transition.arguments)
    return None if found is None else found[0]


def _distance(both: tuple[LiftedRules, LiftedRules], transition: Transition) -> float:
    first, second = (foretold_paid(rules, transition) for rules in both)
    return distance(first, second)


def _likeness(one: Domain, other: Domain, first: int | None, second: int | None) -> Likeness:
    if first is None or second is None:
        return Likeness.OTHER
    return likeness(one, one.rules[first], other, other.rules[second])


# ---- witnesses


def _small(both: tuple[LiftedRules, LiftedRules], witness: Witness | None) -> Witness | None:
    """The witness without the objects and facts that make no difference: what is left can be read.

    One after the other is left out, as long as the same rules cover the action and what they foretell is no
    nearer (after Zeller and Hildebrandt 2002, who simplify what makes a program fail).
    """
    if witness is None:
        return None
    transition, off = witness.transition, witness.distance
    covering = [_covering(rules, transition) for rules in both]
    true = [fact for fact, value in sorted(transition.before.items(), key=str) if value is True]
    parts: list[Object | Fluent] = [*transition.objects, *true]
    for part in parts:
        smaller = _without(transition, part)
        try:
            is_as_far = _distance(both, smaller) >= off - NEGLIGIBLE
        except Refused:
            continue
        if is_as_far and [_covering(rules, smaller) for rules in both] == covering:
            transition = smaller
    return Witness(transition, off)


def _without(transition: Transition, part: Object | Fluent) -> Transition:
    """The state without an object and all facts about it, or without a fact; an argument stays."""
    objects, before = transition.objects, transition.before
    if not isinstance(part, Object):
        values = {key: value for key, value in before.items() if key != part}
    elif part.name not in transition.arguments:
        objects = tuple(each for each in objects if each != part)
        values = {key: value for key, value in before.items() if part.name not in key[1]}
    else:
        return transition
    return transition._replace(objects=objects, before=values, after=values)
