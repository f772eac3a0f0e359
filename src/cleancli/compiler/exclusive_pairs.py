"""Pairs of values that exclude each other: no state that actions lead to has both.

This is h^2 of Haslum and Geffner (2000, Admissible Heuristics for Optimal Planning), asked only whether it is
finite. A pair of values is possible if both are of the initial state, or if an outcome of probability above 0
may leave both where each pair that this asks of the state before is possible. So a state all of whose pairs
are possible leads only to such states.

Of what an outcome asks, pairs of literals are looked at, and of its choices that some member may hold. What
is not shown to be impossible so counts as possible.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cleancli.compiler.fluents import Fluent
from cleancli.compiler.ground_formula import Requirement
from cleancli.compiler.outcome_ways import (
    Asked,
    Bits,
    Numbers,
    Operator,
    count_ways,
    each_of,
    operators,
    union,
)
from cleancli.compiler.partial_evaluation import Conditions
from cleancli.compiler.relaxed_reachability import Reach
from cleancli.language.model import Value

MOST_VALUES = 3_000
"""Values of all keys up to which pairs are looked for: a bit for each two, a megabyte. Chosen."""

MOST_WAYS = 100_000
"""Ways in which outcomes leave values up to which they are. Chosen: ten seconds to prepare them."""

MOST_LOOKS = 20_000_000
"""Ways and pairs of ways that are looked at before the search is given up. Chosen: five seconds."""

MOST_DROPPED = 300_000
"""Requirements that are dropped before the division into cases is given up. Chosen: about ten seconds."""

_Literal = tuple[Fluent, frozenset[Value]]

Pair = tuple[_Literal, _Literal]
"""Two literals, in the order of their keys, that never hold together."""


class TooManyDropped(Exception):
    """A division drops more than `MOST_DROPPED` requirements."""


@dataclass(frozen=True, slots=True)
class Pairs:
    """For the number of each value, all values that may hold beside it."""

    numbers: Numbers
    beside: Sequence[Bits]


class Allowed:
    """Whether requirements may hold in a state that actions lead to, as far as pairs tell; `excluding` are
    the pairs of literals that spoke against others. Raises `TooManyDropped`."""

    def __init__(self, pairs: Pairs) -> None:
        self._pairs = pairs
        self._bits: dict[_Literal, tuple[Bits, Bits]] = {}
        self._dropped = 0
        self.excluding: set[Pair] = set()

    def __call__(self, required: Requirement) -> bool:
        """Whether no two of its literals exclude each other."""
        found = [self._literal(literal) for literal in required.items()]
        shared = -1
        for _, beside in found:
            shared &= beside
        if all(bits & shared for bits, _ in found):
            return True
        for one, other in itertools.combinations(sorted(required.items(), key=lambda each: each[0]), 2):
            if not self._literal(one)[0] & self._literal(other)[1]:
                self.excluding.add((one, other))
                self._dropped += 1
                if self._dropped > MOST_DROPPED:
                    raise TooManyDropped
                return False
        return True  # each of several values is excluded by another literal

    def _literal(self, literal: _Literal) -> tuple[Bits, Bits]:
        """The literal's values, and what may hold beside one of them."""
        if literal not in self._bits:
            bits = self._pairs.numbers.bits(*literal)
            self._bits[literal] = bits, union(self._pairs.beside[number] for number in each_of(bits))
        return self._bits[literal]


def pairs_of(reach: Reach, conditions: Conditions) -> Pairs | None:
    """The least fixpoint of this module's text; None where there is too much to look at."""
    if sum(map(len, reach.changing.values())) > MOST_VALUES or count_ways(reach) > MOST_WAYS:
        return None
    numbers = Numbers(reach, conditions)
    beside = [numbers.initial if numbers.initial >> number & 1 else 0 for number in range(numbers.count)]
    closed = _close(beside, numbers.initial, tuple(operators(reach, conditions, numbers)))
    return Pairs(numbers, beside) if closed else None


def _close(beside: list[Bits], reached: Bits, found: Sequence[Operator]) -> bool:
    """Adds in place what becomes possible, until nothing does; whether that is so within `MOST_LOOKS`. An
    operator is looked at again where more may hold beside one of the values that it speaks of."""
    looks = 0
    fresh = (1 << len(beside)) - 1
    while fresh:
        grown = 0
        for operator in found:
            if not operator.mentions & (fresh | grown):
                continue
            looks += 1 + len(operator.ways) ** 2
            if looks > MOST_LOOKS:
                return False
            for value, company in _results(operator, beside, reached):
                new = company & ~beside[value]
                beside[value] |= new
                for other in each_of(new):
                    beside[other] |= 1 << value
                if new:
                    grown |= new | 1 << value
            reached |= grown
        fresh = grown
    return True


def _results(operator: Operator, beside: Sequence[Bits], reached: Bits) -> Iterator[tuple[int, Bits]]:
    """The values that the outcome may leave, each with itself and all that may then hold beside it."""
    before = _may_hold(operator.asks, beside, reached)
    possible = [(way, company) for way in operator.ways if (company := _may_hold(way.asks, beside, before))]
    for way, company in possible:
        after = company & operator.untouched | 1 << way.value
        for other, others_company in possible:
            if (
                not way.rivals >> other.value & 1
                and all(company & literal.bits for literal in other.asks.literals)
                and all(others_company & literal.bits for literal in way.asks.literals)
            ):
                after |= 1 << other.value
        yield way.value, after


def _may_hold(asked: Asked, beside: Sequence[Bits], among: Bits) -> Bits:
    """Those `among` values that may hold where the formula does: beside a value of each literal, and beside
    some member of each choice. None of them where the formula can't hold: in a state in which it does, some
    value of each literal is among those that hold beside all the others."""
    for literal in asked.literals:
        among &= union(beside[number] for number in literal.numbers)
    for choice in asked.choices:
        among = union(_may_hold(member, beside, among) for member in choice)
    return among if all(among & literal.bits for literal in asked.literals) else 0
