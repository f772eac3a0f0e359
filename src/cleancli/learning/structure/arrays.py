"""Transitions as arrays: what held before and after each, by the places of its objects.

The places of a transition are the domain's constants, in its order, and then the objects of the transition;
how many places there are is that of the transition with the most. A symbol's values are codes: their indices
in `Symbol.values`, or -1 where the state has none. A predicate that is not listed is false, which is 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Bools, Longs
from cleancli.compiler.fluents import Values
from cleancli.language.model import (
    Condition,
    DerivedPredicate,
    Domain,
    Equality,
    Literal,
    Object,
    Quantified,
    Symbol,
    Term,
    Variable,
)
from cleancli.learning.experience import Transition

Codes = NDArray[np.integer[Any]]
"""Values of symbols, -1 where there is none."""

UNDEFINED = -1
"""The place of what a reference names where it names nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """n transitions with N places each.

    `before` and `after` hold the codes of each symbol, (n, N, ...) with an axis for each parameter; `after`
    is of those that are not static. `derived` are the truth values of derived predicates before, alike.
    `is_a` says of each type which places hold an object of it, (n, N). `numbers` are the transitions' places
    in the experience, (n,); `changed` is how many fluents changed, (n,).
    """

    domain: Domain
    numbers: Longs
    before: Mapping[str, Codes]
    after: Mapping[str, Codes]
    derived: Mapping[str, Codes]
    is_a: Mapping[str, Bools]
    changed: Longs

    @property
    def size(self) -> int:
        """How many transitions there are."""
        return len(self.numbers)

    @property
    def places(self) -> int:
        """How many places there are."""
        return next(iter(self.is_a.values())).shape[1] if self.is_a else 0

    @property
    def facts(self) -> int:
        """How many facts all states after have that may change."""
        kinds = (symbol for symbol in self.domain.symbols if not symbol.static)
        numbers = {name: places.sum(axis=1) for name, places in self.is_a.items()}
        ones = np.ones(self.size, dtype=np.int64)
        return sum(
            int(math.prod((numbers[p.type] for p in kind.parameters), start=ones).sum()) for kind in kinds
        )

    def only(self, rows: Longs) -> Arrays:
        """The transitions of these rows."""
        before, after, derived = (
            {name: codes[rows] for name, codes in each.items()}
            for each in (self.before, self.after, self.derived)
        )
        is_a = {name: places[rows] for name, places in self.is_a.items()}
        numbers, changed = self.numbers[rows], self.changed[rows]
        return Arrays(self.domain, numbers, before, after, derived, is_a, changed)


@dataclass(frozen=True, slots=True, eq=False)
class ActionArrays:
    """The transitions of one action; `columns` are the places of its arguments, each (n,)."""

    arrays: Arrays
    columns: tuple[Longs, ...]


def compiled(domain: Domain, transitions: Sequence[Transition]) -> dict[str, ActionArrays]:
    """The transitions of each action that there are any of, in the order of the domain's actions."""
    places = _Places(domain)
    by_action: dict[str, list[int]] = {}
    for number, each in enumerate(transitions):
        by_action.setdefault(each.action, []).append(number)
    found = {}
    for action in domain.actions:
        numbers = by_action.get(action.name, [])
        if numbers:
            chosen = [transitions[number] for number in numbers]
            arguments = np.array(
                [[places.of(each)[name] for name in each.arguments] for each in chosen], dtype=np.int64
            ).reshape(len(chosen), len(action.parameters))
            arrays = _arrays(domain, chosen, np.array(numbers, dtype=np.int64), places)
            found[action.name] = ActionArrays(arrays, tuple(arguments.T))
    return found


class _Places:
    """Where the objects of transitions stand; the same objects are mostly those of many."""

    def __init__(self, domain: Domain) -> None:
        self.constants = domain.constants
        self._known: dict[tuple[Object, ...], dict[str, int]] = {}

    def of(self, transition: Transition) -> dict[str, int]:
        """The places of a transition's objects by their names."""
        found = self._known.get(transition.objects)
        if found is None:
            names = dict.fromkeys(each.name for each in (*self.constants, *transition.objects))
            found = self._known[transition.objects] = {name: place for place, name in enumerate(names)}
        return found


def _arrays(domain: Domain, chosen: Sequence[Transition], numbers: Longs, places: _Places) -> Arrays:
    width = max(len(places.of(each)) for each in chosen)
    rows = [places.of(each) for each in chosen]
    before = _codes(domain.symbols, [each.before for each in chosen], rows, width)
    fluid = [symbol for symbol in domain.symbols if not symbol.static]
    after = _codes(fluid, [each.after for each in chosen], rows, width)
    is_a = {each.name: np.zeros((len(chosen), width), dtype=bool) for each in domain.types}
    for row, each in enumerate(chosen):
        for thing in (*domain.constants, *each.objects):
            is_a[thing.type][row, rows[row][thing.name]] = True
    for each_type in reversed(domain.types):
        if each_type.parent is not None:
            is_a[each_type.parent] |= is_a[each_type.name]
    static = {symbol.name for symbol in domain.symbols if symbol.static}
    changed = np.array([sum(key[0] not in static for key in each.changed) for each in chosen], dtype=np.int64)
    bare = Arrays(domain, numbers, before, after, {}, is_a, changed)
    return Arrays(domain, numbers, before, after, _derived(bare), is_a, changed)


def _codes(
    symbols: Sequence[Symbol], states: Sequence[Values], rows: Sequence[Mapping[str, int]], width: int
) -> dict[str, Codes]:
    """The codes of the symbols in states whose objects have these places, among `width`."""
    codes = {symbol.name: {value: code for code, value in enumerate(symbol.values)} for symbol in symbols}
    found: dict[str, tuple[list[int], list[int]]] = {symbol.name: ([], []) for symbol in symbols}
    symmetric = {symbol.name for symbol in symbols if symbol.symmetric}
    for row, (state, place) in enumerate(zip(states, rows, strict=True)):
        for (name, objects), value in state.items():
            if name not in codes:
                continue
            at, filled = found[name]
            code = codes[name][value]
            at.append(_flat(row, [place[each] for each in objects], width))
            filled.append(code)
            if name in symmetric:
                at.append(_flat(row, [place[each] for each in reversed(objects)], width))
                filled.append(code)
    arrays: dict[str, Codes] = {}
    for symbol in symbols:
        shape = (len(states), *(width,) * len(symbol.parameters))
        kind = np.int8 if len(symbol.values) < 128 else np.int16
        array: Codes = np.full(math.prod(shape), 0 if symbol.is_predicate else -1, dtype=kind)
        at, filled = found[symbol.name]
        array[at] = filled
        arrays[symbol.name] = array.reshape(shape)
    return arrays


def _flat(row: int, places: Sequence[int], width: int) -> int:
    for place in places:
        row = row * width + place
    return row


# ---- what holds


Index = Mapping[Term, Longs]
"""The places of terms, each to be broadcast with the others: a row for each transition, and an axis for each
variable that ranges over all places."""


def index_of(arrays: Arrays, columns: Mapping[Term, Longs]) -> Index:
    """The index of terms whose places are known for each transition, (n,); those of constants are added."""
    constants: dict[Term, Longs] = {
        constant: np.full(arrays.size, place) for place, constant in enumerate(arrays.domain.constants)
    }
    return {**constants, **columns}


def ranging(arrays: Arrays, index: Index, variables: Sequence[Variable]) -> tuple[Index, Bools]:
    """The index with variables that range over all places, each along a new last axis; and where what they
    stand for is of their types, for each transition."""
    extended = dict(index)
    axes = axes_of(index)
    typed = np.ones((arrays.size,) + (1,) * (axes - 1), dtype=bool)
    for variable in variables:
        extended = {term: places[..., None] for term, places in extended.items()}
        axes += 1
        extended[variable] = np.arange(arrays.places).reshape((1,) * (axes - 1) + (-1,))
        of_type = arrays.is_a[variable.type].reshape((arrays.size,) + (1,) * (axes - 2) + (-1,))
        typed = typed[..., None] & of_type
    return extended, typed


def holds(arrays: Arrays, condition: Condition, index: Index) -> Bools:
    """Whether a condition holds before, for each transition and whatever the index ranges over."""
    axes = axes_of(index)
    found: Bools = np.ones((arrays.size,) + (1,) * (axes - 1), dtype=bool)
    for part in condition:
        match part:
            case Literal():
                found = found & _literal(arrays, part, index, axes)
            case Equality(left, right, equal):
                found = found & ((index[left] == index[right]) == equal)
            case Quantified(exists, variables, inner):
                extended, typed = ranging(arrays, index, variables)
                satisfied = typed & holds(arrays, inner, extended)
                found = found & (some(satisfied, len(variables)) == exists)
    return found


def some(truth: Bools, axes: int) -> Bools:
    """Whether anything holds along so many last axes."""
    found: Bools = np.logical_or.reduce(truth, axis=tuple(range(-axes, 0)))
    return found


def axes_of(index: Index) -> int:
    """How many axes what is told of an index has."""
    return max((each.ndim for each in index.values()), default=1)


def codes_of(tensor: Codes, terms: Sequence[Term], index: Index, axes: int) -> Codes:
    """The codes of a symbol for terms, from its tensor."""
    rows = np.arange(len(tensor)).reshape((-1,) + (1,) * (axes - 1))
    found: Codes = tensor[(rows, *(index[term] for term in terms))]
    return found


def _literal(arrays: Arrays, literal: Literal, index: Index, axes: int) -> Bools:
    if literal.symbol in arrays.derived:
        truth = codes_of(arrays.derived[literal.symbol], literal.terms, index, axes)
        return np.equal(truth, int(True in literal.values))
    values = next(each for each in arrays.domain.symbols if each.name == literal.symbol).values
    wanted = np.array([*(value in literal.values for value in values), False])
    found: Bools = wanted[codes_of(arrays.before[literal.symbol], literal.terms, index, axes)]
    return found


def _derived(arrays: Arrays) -> dict[str, Codes]:
    """The truth values of derived predicates, each after those that it is defined by."""
    found: dict[str, Codes] = {}
    waiting = {each.name: each for each in arrays.domain.derived}
    while waiting:
        for name, each in list(waiting.items()):
            if not waiting.keys() & _asked(each):
                known = replace(arrays, derived=found)
                found[name] = _truth(known, each)
                del waiting[name]
    return found


def _asked(derived: DerivedPredicate) -> set[str]:
    if derived.closure is not None:
        return {derived.closure}
    inner = [part.condition if isinstance(part, Quantified) else (part,) for part in derived.condition]
    return {each.symbol for parts in inner for each in parts if isinstance(each, Literal)}


def _truth(arrays: Arrays, derived: DerivedPredicate) -> Codes:
    if derived.closure is not None:
        return _closure(arrays, derived)
    index, typed = ranging(arrays, index_of(arrays, {}), derived.parameters)
    truth = typed & holds(arrays, derived.condition, index)
    shape = (arrays.size, *(arrays.places,) * len(derived.parameters))
    return np.broadcast_to(truth, shape).astype(np.int8)


def _closure(arrays: Arrays, derived: DerivedPredicate) -> Codes:
    """The transitive closure, by squaring."""
    assert derived.closure is not None
    known = arrays.derived if derived.closure in arrays.derived else arrays.before
    reached = known[derived.closure].astype(np.int16)
    for _ in range(max(arrays.places, 1).bit_length()):
        reached = ((reached + reached @ reached) > 0).astype(np.int16)
    return reached.astype(np.int8)
