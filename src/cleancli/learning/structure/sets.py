"""What effects set in transitions, and which outcomes may have made these."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Longs
from cleancli.language.model import Assign, ForAll, Literal, Shift, Symbol
from cleancli.learning.structure.arrays import UNDEFINED, Arrays, Codes, codes_of, holds, ranging
from cleancli.learning.structure.terms import Effect, Named, defined, index_of_terms

UNFIT = 1_000_000
"""In place of a number of facts, of an outcome that cannot be."""

Outcome = frozenset[Effect]
"""The effects of one result; none of `nothing`."""


class Change(NamedTuple):
    """A fluent that changed in the transition of a row: the places of its objects, and its codes."""

    row: int
    symbol: str
    places: tuple[int, ...]
    old: int
    new: int


class Sets(NamedTuple):
    """What an effect sets in each transition: (n, 1), or (n, N) of a `forall`, for each object.

    `applies`: whether it does so there; `fluents`: of what, by a number among those of its symbol; `right`:
    whether that is what it was after; `moves`: whether that is another value than before; `changed`: whether
    it changed at all. `amount` is that of a shift.
    """

    applies: Bools
    fluents: Longs
    right: Bools
    moves: Bools
    changed: Bools
    symbol: Symbol
    columns: tuple[Longs, ...]
    before: Codes
    after: Codes
    amount: int | None

    def change(self, row: int, place: int) -> Change:
        """The change of what is set in a row for the object at a place."""
        shape = self.applies.shape
        places = [int(np.broadcast_to(column, shape)[row, place]) for column in self.columns]
        if self.symbol.symmetric:
            places.sort()
        old, new = int(self.before[row, place]), int(self.after[row, place])
        return Change(row, self.symbol.name, tuple(places), old, new)


def sets(arrays: Arrays, known: Named, effect: Effect) -> Sets:
    """What an effect sets in each transition; a `forall` has one effect here."""
    index = {term: column[:, None] for term, column in index_of_terms(known).items()}
    applies: Bools = np.ones((arrays.size, 1), dtype=bool)
    inner: Assign | Shift
    if isinstance(effect, ForAll):
        ranged, typed = ranging(arrays, index_of_terms(known), effect.variables)
        applies = typed & holds(arrays, effect.condition, ranged)
        index, (inner,) = dict(ranged), effect.effects
        variables = effect.variables
        for part in effect.condition:
            if isinstance(part, Literal):
                applies = applies & defined(part, known)[:, None]
    else:
        inner, variables = effect, ()
    for term in inner.terms:
        if term not in variables:
            applies = applies & (known.columns[term] != UNDEFINED)[:, None]
    symbol = next(each for each in arrays.domain.symbols if each.name == inner.symbol)
    before = codes_of(arrays.before[symbol.name], inner.terms, index, 2)
    after = codes_of(arrays.after[symbol.name], inner.terms, index, 2)
    amount = inner.amount if isinstance(inner, Shift) else None
    if isinstance(inner, Assign):
        told = np.full(before.shape, symbol.values.index(inner.value))
    else:
        told = _shifted(before, symbol, inner.amount)
    columns = tuple(index[term] for term in inner.terms)
    shape = np.broadcast_shapes(before.shape, applies.shape)
    before, after, told, applies = (np.broadcast_to(x, shape) for x in (before, after, told, applies))
    fluents = np.broadcast_to(_numbers(arrays, symbol, columns), shape)
    return Sets(
        applies,
        fluents,
        told == after,
        told != before,
        before != after,
        symbol,
        columns,
        before,
        after,
        amount,
    )


def _shifted(before: Codes, symbol: Symbol, amount: int | Longs) -> Longs:
    """The codes after a shift, which stops at the bounds; where there is no number, it stays so."""
    found: Longs = np.where(before < 0, before, np.clip(before + amount, 0, len(symbol.values) - 1))
    return found


def _numbers(arrays: Arrays, symbol: Symbol, columns: Sequence[Longs]) -> Longs:
    """A number for each fluent of a symbol in a transition."""
    if symbol.symmetric:
        columns = np.minimum(*columns), np.maximum(*columns)
    number: Longs = np.zeros((1, 1), dtype=np.int64)
    for column in columns:
        number = number * arrays.places + column
    return number


def _right_with(told: Sets, chosen: Sequence[Sets]) -> Bools:
    """Whether what an effect sets is what it was after, where all shifts of one number add up."""
    shifts = [each for each in chosen if each.amount is not None and each.symbol is told.symbol]
    if told.amount is None or (shifts == [told] and told.applies.shape[1] == 1):
        return told.right
    total = np.zeros(told.fluents.shape, dtype=np.int64)
    for each in shifts:
        same = (told.fluents[:, :, None] == each.fluents[:, None, :]) & each.applies[:, None, :]
        total = total + (each.amount or 0) * same.sum(axis=2)
    found: Bools = _shifted(told.before, told.symbol, total) == told.after
    return found


def mismatches(arrays: Arrays, known: Named, outcomes: Sequence[Outcome]) -> Longs:
    """About how many facts outcomes are wrong in transitions, (n, outcomes): those that they set otherwise
    than was seen after, and those that changed and that they do not set; UNFIT where a reference names
    nothing."""
    effects = {effect: sets(arrays, known, effect) for outcome in outcomes for effect in outcome}
    found: Longs = np.zeros((arrays.size, len(outcomes)), dtype=np.int64)
    for number, outcome in enumerate(outcomes):
        chosen = sorted((effects[effect] for effect in outcome), key=lambda each: each.applies.shape[1])
        unfit: Bools = np.zeros(arrays.size, dtype=bool)
        wrong = arrays.changed.copy()
        for told, first in zip(chosen, _first_told(chosen), strict=True):
            if told.applies.shape[1] == 1:
                unfit = unfit | ~told.applies[:, 0]
            is_wrong = told.applies & ~_right_with(told, chosen)
            wrong = wrong + is_wrong.sum(axis=1) - (first & told.changed).sum(axis=1)
        found[:, number] = np.where(unfit, UNFIT, wrong)
    return found


def _first_told(chosen: Sequence[Sets]) -> list[Bools]:
    """Where each of the effects sets a fluent that none before it sets."""
    found = [told.applies for told in chosen]
    by_symbol: dict[str, list[int]] = {}
    for number, told in enumerate(chosen):
        by_symbol.setdefault(told.symbol.name, []).append(number)
    for numbers in by_symbol.values():
        if len(numbers) > 1:
            applies = np.concatenate([chosen[each].applies for each in numbers], axis=1)
            fluents = np.concatenate([chosen[each].fluents for each in numbers], axis=1)
            apart = np.where(applies, fluents, -1 - np.arange(fluents.shape[1]))
            order = np.argsort(apart, axis=1, kind="stable")
            is_new = np.diff(np.take_along_axis(apart, order, axis=1), axis=1, prepend=np.nan) != 0
            first = np.zeros_like(applies)
            np.put_along_axis(first, order, is_new, axis=1)
            ends = np.cumsum([chosen[each].applies.shape[1] for each in numbers])[:-1]
            for each, part in zip(numbers, np.split(first & applies, ends, axis=1), strict=True):
                found[each] = part
    return found


def fits(arrays: Arrays, known: Named, outcomes: Sequence[Outcome]) -> Bools:
    """Which outcomes may have made which transitions, (n, outcomes): what they set is what was after, and all
    that changed is among it."""
    return np.equal(mismatches(arrays, known, outcomes), 0)
