"""The outcomes of instances as operators over numbered values: in which ways each leaves what it touches.

Guaranteed by `Reach`: its instances are all that can apply, and their conditions hold literals over
changeable keys alone.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from cleancli.compiler.fluents import Fluent, shifted
from cleancli.compiler.ground_formula import (
    ALWAYS,
    Formula,
    can_hold,
    conjunction,
    negation,
    restricted,
)
from cleancli.compiler.instances import Changes, StateEffect
from cleancli.compiler.partial_evaluation import Conditions
from cleancli.compiler.plain_rules import NOTHING
from cleancli.compiler.relaxed_reachability import Reach
from cleancli.language.model import Assign, Shift, Value

_MOST_SUMS = 64
"""Sums of the shifts of one number whose conditions are told apart. Chosen."""

Bits = int
"""A set of numbered values, a bit each."""


@dataclass(frozen=True, slots=True)
class AskedValues:
    """One of these values holds."""

    bits: Bits
    numbers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Asked:
    """A formula over numbered values."""

    literals: tuple[AskedValues, ...]
    choices: tuple[tuple[Asked, ...], ...]

    @property
    def mentions(self) -> Bits:
        """All values that it speaks of."""
        inner = union(member.mentions for choice in self.choices for member in choice)
        return inner | union(literal.bits for literal in self.literals)


@dataclass(frozen=True, slots=True)
class Way:
    """A way in which an outcome leaves a key, of which `rivals` are all values, with a value: what it asks of
    the state before, beside what the operator asks."""

    value: int
    rivals: Bits
    asks: Asked


@dataclass(frozen=True, slots=True)
class Operator:
    """An outcome of an instance: what it asks, the ways in which it leaves what it touches, and the values
    that it does not touch. Of a key that is set in some states alone, one of the ways is to leave it as it
    is. `mentions` are all values that conditions speak of, all there are where nothing is asked."""

    asks: Asked
    ways: tuple[Way, ...]
    untouched: Bits
    mentions: Bits


class Numbers:
    """Numbers for the values that keys can ever have, those of a key beside each other."""

    def __init__(self, reach: Reach, conditions: Conditions) -> None:
        universe, changing = conditions.universe, reach.changing
        self.count = 0
        self._number: dict[Fluent, dict[Value, int]] = {}
        self.initial: Bits = 0
        for key in sorted(changing):
            values = [value for value in universe.symbols[key[0]].values if value in changing[key]]
            self._number[key] = {value: self.count + place for place, value in enumerate(values)}
            self.count += len(values)
            self.initial |= 1 << self._number[key][universe.initial(key)]

    def __contains__(self, key: Fluent) -> bool:
        return key in self._number

    def of(self, key: Fluent, value: Value) -> int:
        """The number of a value of a key."""
        return self._number[key][value]

    def bits(self, key: Fluent, values: Iterable[Value]) -> Bits:
        """Some values of a key."""
        return union(1 << self._number[key][value] for value in values)


def count_ways(reach: Reach) -> int:
    """How many ways all operators have at most, but for sums of several shifts."""
    plain = sum(len(rows) for block in reach.plain for rows, _ in block.assigned)
    always = sum(len(changes) for instance in reach.instances for changes in instance.changes)
    effects = (effect for instance in reach.instances for effect in instance.effects)
    return plain + always + sum(1 + len(reach.known(effect.key)) for effect in effects)


def operators(reach: Reach, conditions: Conditions, numbers: Numbers) -> Iterator[Operator]:
    """Those of all outcomes that can happen and touch something."""
    maker = _Maker(reach, conditions, numbers)
    for condition, changes in _plain(reach):
        yield from maker.operator(condition, changes, ())
    for instance in reach.instances:
        for place, changes in enumerate(instance.changes):
            effects = [effect for effect in instance.effects if effect.outcome == place]
            yield from maker.operator(instance.condition, changes, effects)


def _plain(reach: Reach) -> Iterator[tuple[Formula, Changes]]:
    """The condition, and what is assigned, of each outcome of each plain instance."""
    literals, assignments = reach.vocabulary.literals.entries, reach.vocabulary.assignments.entries
    for block in reach.plain:
        asked = [[number for number in row if number != NOTHING] for row in block.literals.tolist()]
        for rows, assigned in block.assigned:
            changes: dict[int, dict[Fluent, frozenset[Value]]] = defaultdict(dict)
            for row, number in zip(rows.tolist(), assigned.tolist(), strict=True):
                key, value = assignments[number]
                changes[row][key] = changes[row].get(key, frozenset()) | {value}
            for row, each in changes.items():
                yield Formula(dict(literals[number] for number in asked[row])), each


class _Maker:
    """Makes operators in one universe."""

    def __init__(self, reach: Reach, conditions: Conditions, numbers: Numbers) -> None:
        self._known, self._conditions, self._numbers = reach.known, conditions, numbers

    def operator(
        self, condition: Formula, changes: Changes, effects: Sequence[StateEffect]
    ) -> Iterator[Operator]:
        """The operator of an outcome, if it can happen and touches something."""
        on: dict[Fluent, list[StateEffect]] = {key: [] for key in changes if key in self._numbers}
        for effect in effects:
            if effect.key in self._numbers and can_hold(effect.when, self._known):
                on.setdefault(effect.key, []).append(effect)
        asked = restricted(condition, self._known)
        if asked is None or not on:
            return
        ways = [way for key in on for way in self._ways(key, changes.get(key, ()), on[key], asked)]
        every = (1 << self._numbers.count) - 1
        untouched = every & ~union(self._values(key) for key in on)
        numbered = self._asked(asked)
        mentions = numbered.mentions | union(way.asks.mentions for way in ways)
        yield Operator(numbered, tuple(ways), untouched, every if asked.always else mentions)

    def _ways(
        self, key: Fluent, always: Iterable[Value], effects: Sequence[StateEffect], asked: Formula
    ) -> Iterator[Way]:
        """Those to the values of one key, to which an outcome assigns some values `always`, and on which it
        has these effects."""
        assigned = [(value, ALWAYS) for value in always]
        assigned += [(each.effect.value, each.when) for each in effects if isinstance(each.effect, Assign)]
        for value, when in assigned:
            yield from self._way(key, value, asked, when)
        unassigned = conjunction(negation(when, self._conditions.all_values) for _, when in assigned)
        if unassigned is None:
            return
        symbol = self._conditions.universe.symbols[key[0]]
        shifts = [(each.effect.amount, each.when) for each in effects if isinstance(each.effect, Shift)]
        for amount, when in self._sums(shifts):
            for value in self._known(key):
                before = Formula({key: frozenset({value})})
                after = shifted(symbol, value, amount) if amount else value
                yield from self._way(key, after, asked, conjunction((before, when, unassigned)))

    def _sums(self, shifts: Iterable[tuple[int, Formula]]) -> Sequence[tuple[int, Formula]]:
        """By how much a number is shifted in all, and where. Of many sums it is not told where."""
        sums = [(0, ALWAYS)]
        for more, when in shifts:
            opposite = negation(when, self._conditions.all_values)
            divided = [
                *((amount + more, conjunction((where, when))) for amount, where in sums),
                *((amount, conjunction((where, opposite))) for amount, where in sums),
            ]
            sums = [(amount, where) for amount, where in divided if where is not None]
            if len(sums) > _MOST_SUMS:
                sums = [(amount, ALWAYS) for amount in sorted({amount for amount, _ in sums})]
        return sums

    def _way(self, key: Fluent, value: Value, asked: Formula, when: Formula | None) -> Iterator[Way]:
        """The way to a value where a formula holds, unless it can't beside what the operator asks."""
        both = conjunction((asked, when))
        whole = None if both is None else restricted(both, self._known)
        if whole is not None:
            required = {key: v for key, v in whole.required.items() if asked.required.get(key) != v}
            choices = tuple([choice for choice in whole.choices if choice not in asked.choices])
            more = self._asked(Formula(required, choices))
            yield Way(self._numbers.of(key, value), self._values(key), more)

    def _values(self, key: Fluent) -> Bits:
        return self._numbers.bits(key, self._known(key))

    def _asked(self, formula: Formula) -> Asked:
        found = [self._numbers.bits(key, values) for key, values in formula.required.items()]
        literals = [AskedValues(bits, tuple(each_of(bits))) for bits in found]
        choices = [tuple([self._asked(member) for member in choice]) for choice in formula.choices]
        return Asked(tuple(literals), tuple(choices))


def union(sets: Iterable[Bits]) -> Bits:
    """All that is in one of the sets."""
    found = 0
    for each in sets:
        found |= each
    return found


def each_of(bits: Bits) -> Iterator[int]:
    """The numbers in a set, ascending."""
    while bits:
        lowest = bits & -bits
        yield lowest.bit_length() - 1
        bits ^= lowest
