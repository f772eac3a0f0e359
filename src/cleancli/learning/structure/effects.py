"""What actions change, told of variables: by arguments, constants and references, or by a `forall`.

References and guards are found by set cover: a condition on one object more is tried for all objects that
changed and that nothing names yet, and the one that names most of them is taken, until none names two. It has
up to two parts, or a third with which it names more than with these two.
"""

from __future__ import annotations

import functools
import itertools
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Longs
from cleancli.language.model import (
    Assign,
    Domain,
    Equality,
    ForAll,
    Literal,
    Reference,
    Shift,
    Symbol,
    Term,
    Variable,
)
from cleancli.learning.structure.arrays import (
    UNDEFINED,
    ActionArrays,
    Arrays,
    holds,
    ranging,
    some,
)
from cleancli.learning.structure.literals import equalities, fits_types, literals, negated
from cleancli.learning.structure.sets import Change, Outcome, sets
from cleancli.learning.structure.terms import Effect, Named, Parts, defined, index_of_terms

MOST_REFERENCES = 3
"""Conditions on other objects that are looked for in an action; chosen."""
MOST_PATTERNS = 6
"""Kinds of changes of objects without a name of which a `forall` is looked for at once, the most frequent;
chosen."""
LEAST_COVERED = 0.02
"""The share of the objects that nothing names which a condition has to tell of; what flickers has fewer.
Chosen."""
MOST_PARTS = 40
"""Literals of which pairs are tried as such a condition, the ones that hold of most objects that changed;
chosen."""


def changes_of(arrays: Arrays) -> list[Change]:
    """All changes, but of values that are not known after."""
    found = []
    for symbol in arrays.domain.symbols:
        if symbol.static:
            continue
        before, after = arrays.before[symbol.name], arrays.after[symbol.name]
        rows, *places = np.nonzero((before != after) & (after >= 0) & (before >= 0))
        for row, *at in zip(rows.tolist(), *(each.tolist() for each in places), strict=True):
            if symbol.symmetric and at[0] > at[1]:
                continue
            old, new = int(before[(row, *at)]), int(after[(row, *at)])
            found.append(Change(row, symbol.name, tuple(at), old, new))
    return found


# ---- objects that nothing names yet


def with_references(action: ActionArrays, known: Named, changes: Sequence[Change]) -> Named:
    """The same with references to the objects that changed, as far as any name two of them or more."""
    for _ in range(MOST_REFERENCES):
        holes = _holes(action.arrays, known, changes)
        found = [
            each
            for type_name in sorted({each[2] for each in holes})
            if (each := _reference(action.arrays, known, [h for h in holes if h[2] == type_name], type_name))
        ]
        if not found:
            return known
        _, reference, column = max(found, key=lambda each: each[0])
        columns = {**known.columns, reference.variables[0]: column}
        known = replace(known, columns=columns, references=(*known.references, reference))
    return known


def _holes(arrays: Arrays, known: Named, changes: Sequence[Change]) -> list[tuple[int, int, str]]:
    """Row, place and type of the objects that changed and that no term names, each once."""
    symbols = {symbol.name: symbol for symbol in arrays.domain.symbols}
    at = _terms_at(known)
    explained = _explained(arrays, known)
    holes: dict[tuple[int, int], str] = {}
    for change in changes:
        if change in explained:
            continue
        for parameter, place in zip(symbols[change.symbol].parameters, change.places, strict=True):
            if place not in at[change.row]:
                holes.setdefault((change.row, place), parameter.type)
    return [(*where, type_name) for where, type_name in holes.items()]


def _terms_at(known: Named) -> list[dict[int, Term]]:
    """Of each row the first term that stands at a place."""
    columns = [(term, column.tolist()) for term, column in known.columns.items()]
    found: list[dict[int, Term]] = [{} for _ in range(known.size)]
    for term, column in columns:
        for row, place in enumerate(column):
            if place != UNDEFINED:
                found[row].setdefault(place, term)
    return found


def _reference(
    arrays: Arrays, known: Named, holes: Sequence[tuple[int, int, str]], type_name: str
) -> tuple[int, Reference, Longs] | None:
    """The condition that alone names most of these objects, how many it names, and what it names in each
    transition."""
    variable = fresh(known, type_name)
    rows = np.array([row for row, _, _ in holes])
    places = np.array([place for _, place, _ in holes])
    least = max(1.0, LEAST_COVERED * len(rows))
    best: tuple[tuple[int, int, int], Parts, Bools] | None = None

    def enough(satisfied: float) -> bool:
        return satisfied > least if best is None else satisfied >= best[0][0]

    sought = _Open(rows, places, lambda satisfied: satisfied, enough, lambda: best and best[1:])
    for parts, fits in _conditions(arrays, known, _said_of(arrays, known, variable), sought):
        count = fits.sum(axis=1)
        covered = int((fits[rows, places] & (count[rows] == 1)).sum())
        rank = covered, -len(parts), int((count == 1).sum())
        if covered > least and (best is None or rank > best[0]):
            best = rank, parts, fits
    if best is None:
        return None
    (covered, *_), parts, fits = best
    column = np.where(fits.sum(axis=1) == 1, fits.argmax(axis=1), UNDEFINED)
    return covered, Reference((variable,), parts), column


def fresh(known: Named, type_name: str) -> Variable:
    """A variable that no term and no `forall` has: by the first letter of its type, or one after it."""
    taken = {term.name for term in known.columns if isinstance(term, Variable)}
    taken |= {each.variables[0].name for each in known.foralls}
    letters = "abcdefghijklmnopqrstuvwxyz"
    start = letters.find(type_name[0].lower())
    start = letters.index("m") if type_name[0].lower() in taken or start < 0 else start
    for number in range(len(letters)):
        letter = letters[(start + number) % len(letters)]
        if letter not in taken:
            return Variable(letter, type_name)
    return Variable(f"{type_name}_{len(taken)}", type_name)


@dataclass(frozen=True, slots=True, eq=False)
class _Open:
    """Objects that nothing names, by their rows and places, of which a condition is looked for.

    `whole` says of which units a condition tells wholly that satisfies these of the objects, (conditions,
    objects) to (conditions, units); `enough`, whether so many of them may be the best so far; `best`, which
    condition is the best so far, if any does, with the places that satisfy it.
    """

    rows: Longs
    places: Longs
    whole: Callable[[Bools], Bools]
    enough: Callable[[float], bool]
    best: Callable[[], tuple[Parts, Bools] | None]


_Told = tuple[Literal | Equality, Bools]
"""A part of a condition on an object, and the places that satisfy it in each transition, (n, N)."""


@dataclass(frozen=True, slots=True, eq=False)
class _Candidates:
    """The parts that a condition on an object may have: those that are `positive`, and those that deny."""

    positive: Sequence[_Told]
    denied: Sequence[_Told]

    def longer(self, parts: Parts, fits: Bools) -> Iterator[tuple[Parts, Bools]]:
        """A condition with one part more, of something that it asks nothing of; first that objects differ,
        which says least."""
        for part, more in (*reversed(self.denied), *self.positive):
            if all(_may_stand_beside(part, each) for each in parts):
                yield (*parts, part), fits & more


@dataclass(frozen=True, slots=True, eq=False)
class _Said:
    """What may be said of a variable that ranges over all places: where these are of its type, (n, N), and
    all literals about it with the places that satisfy each, (literals, n, N)."""

    variable: Variable
    typed: Bools
    literals: Sequence[Literal]
    fits: Bools


def _said_of(arrays: Arrays, known: Named, variable: Variable) -> _Said:
    """What may be said of a variable where all that a literal names is defined."""
    index, typed = ranging(arrays, index_of_terms(known), (variable,))
    every = literals(arrays.domain, (*known.columns, variable), variable)
    listed = [each for each in every if defined(each, known).any()]
    fits = np.zeros((len(listed), *typed.shape), dtype=bool)
    for number, literal in enumerate(listed):
        fits[number] = typed & holds(arrays, (literal,), index) & defined(literal, known)[:, None]
    return _Said(variable, typed, listed, fits)


def _candidates(arrays: Arrays, known: Named, said: _Said, sought: _Open) -> _Candidates:
    """The parts that hold of most of the objects that are sought, and the opposites of such."""
    rows, places, typed = sought.rows, sought.places, said.typed
    counts = said.fits[:, rows, places].sum(axis=1)
    most = np.argsort(-counts, kind="stable")[:MOST_PARTS].tolist()
    listed = [(said.literals[each], said.fits[each]) for each in most]
    denied: list[_Told] = []
    for literal, fits in listed:
        if (typed & ~fits)[rows, places].any():
            without = typed & ~fits & defined(literal, known)[:, None]
            denied.append((negated(arrays.domain, literal), without))
    index, _ = ranging(arrays, index_of_terms(known), (said.variable,))
    for equality in equalities(arrays.domain, (*known.columns, said.variable), said.variable):
        same = np.broadcast_to(holds(arrays, (equality,), index), typed.shape)
        denied.append((replace(equality, equal=False), typed & ~same))
    return _Candidates([told for each, told in zip(most, listed, strict=True) if counts[each] > 0], denied)


def _conditions(arrays: Arrays, known: Named, said: _Said, sought: _Open) -> Iterator[tuple[Parts, Bools]]:
    """Conditions of one or two parts on an object, one of two being positive, and which places satisfy them
    in each transition, (n, N); only those that hold for some of the objects that are sought, and of two parts
    those that may be the best. Then the best of them with one part more."""
    among = _candidates(arrays, known, said, sought)
    positive, denied = among.positive, among.denied
    for part, fits in positive:
        yield (part,), fits
    for part, fits in denied:
        if isinstance(part, Literal):
            yield (part,), fits
    both, apart = (_whole(sought, positive, others) for others in (positive, denied))
    for number, (one, fits) in enumerate(positive):
        for others, told in ((positive, both[number]), (denied, apart[number])):
            if not sought.enough(max(told, default=0.0)):
                continue
            for place in range(number + 1 if others is positive else 0, len(others)):
                other, more = others[place]
                if sought.enough(told[place]) and _may_stand_beside(one, other):
                    yield (one, other), fits & more
    best = sought.best()
    if best is not None:
        yield from among.longer(*best)


def _may_stand_beside(one: Literal | Equality, other: Literal | Equality) -> bool:
    """Whether two parts ask for something of different fluents or terms."""
    if isinstance(one, Literal) and isinstance(other, Literal):
        return (one.symbol, one.terms) != (other.symbol, other.terms)
    return one != other


def _whole(sought: _Open, one: Sequence[_Told], other: Sequence[_Told]) -> list[list[float]]:
    """Of how many units two conditions together tell wholly, for each pair."""
    if not one or not other:
        return [[] for _ in one]
    first, second = (
        sought.whole(np.array([each[1][sought.rows, sought.places] for each in parts])).astype(np.float32)
        for parts in (one, other)
    )
    found: list[list[float]] = (first @ second.T).tolist()
    return found


# ---- changes of all that satisfy a guard


def with_foralls(action: ActionArrays, known: Named, changes: Sequence[Change]) -> Named:
    """The same with effects on all objects that satisfy a guard, for changes of objects that nothing
    names."""

    @functools.cache
    def said_of(type_name: str) -> _Said:
        return _said_of(action.arrays, known, fresh(replace(known, foralls=()), type_name))

    open_changes = list(_open_changes(action.arrays, known, changes))
    for _ in range(2 * MOST_REFERENCES):
        best = _forall(action.arrays, known, open_changes, said_of)
        if best is None:
            break
        known = replace(known, foralls=(*known.foralls, best))
    return replace(known, foralls=tuple(_alike(action.arrays, known, each) for each in known.foralls))


def _alike(arrays: Arrays, known: Named, forall: ForAll) -> ForAll:
    """The `forall` with the guard of another one, where it tells of the same changes with that."""
    told = _explained(arrays, replace(known, foralls=(forall,)))
    for other in known.foralls:
        same = replace(forall, condition=other.condition, variables=other.variables)
        (own,), (variable,) = forall.variables, other.variables
        terms = tuple(variable if term == own else term for term in forall.effects[0].terms)
        same = replace(same, effects=(replace(forall.effects[0], terms=terms),))
        is_longer = len(other.condition) > len(forall.condition)
        if (
            is_longer
            and own.type == variable.type
            and _explained(arrays, replace(known, foralls=(same,))) == told
        ):
            return same
    return forall


def _forall(
    arrays: Arrays, known: Named, open_changes: Sequence[_OpenChange], said_of: Callable[[str], _Said]
) -> ForAll | None:
    """The `forall` that tells wholly of the changes of its kind in most transitions."""
    explained = _explained(arrays, known)
    patterns: dict[_Pattern, list[_OpenChange]] = {}
    for each in open_changes:
        if each.change not in explained:
            patterns.setdefault(each.pattern, []).append(each)
    listed = sorted(patterns.items(), key=lambda each: (-len(each[1]), each[0][0].name, str(each[0][1])))
    found: tuple[tuple[int, int], ForAll] | None = None
    guards = {each.condition for each in known.foralls}
    for (symbol, terms, type_name), changes in listed[:MOST_PATTERNS]:
        for value in sorted({each.change.new for each in changes}):
            holes = [(each.change.row, each.place) for each in changes if each.change.new == value]
            to_beat = found[0][0] if found else 0
            best = _guard(arrays, known, symbol, terms, said_of(type_name), value, holes, guards, to_beat)
            if best is not None and (found is None or best[0] > found[0]):
                found = best
    return None if found is None else found[1]


_Pattern = tuple[Symbol, tuple[Term | None, ...], str]
"""A symbol with terms of which one, None, is an object that nothing names, and the type of that."""


class _OpenChange(NamedTuple):
    """A change of an object at a place that nothing names, and of which kind it is."""

    pattern: _Pattern
    change: Change
    place: int


def _open_changes(arrays: Arrays, known: Named, changes: Sequence[Change]) -> Iterator[_OpenChange]:
    """The changes of which all objects but one are named."""
    symbols = {symbol.name: symbol for symbol in arrays.domain.symbols}
    at = _terms_at(known)
    for change in changes:
        terms = tuple(at[change.row].get(place) for place in change.places)
        symbol = symbols[change.symbol]
        named = [(t, p) for t, p in zip(terms, symbol.parameters, strict=True) if t is not None]
        if terms.count(None) == 1 and all(arrays.domain.is_a(t.type, p.type) for t, p in named):
            hole = terms.index(None)
            yield _OpenChange((symbol, terms, symbol.parameters[hole].type), change, change.places[hole])


def _explained(arrays: Arrays, known: Named) -> set[Change]:
    """The changes of objects without a name that some `forall` tells of wholly in their transitions."""
    found: set[Change] = set()
    for forall in known.foralls:
        told = sets(arrays, known, forall)
        wrong, moved = told.applies & ~told.right, told.applies & told.changed
        for row, place in zip(*np.nonzero(moved & ~some(wrong, 1)[:, None]), strict=True):
            found.add(told.change(int(row), int(place)))
    return found


def _guard(
    arrays: Arrays,
    known: Named,
    symbol: Symbol,
    terms: tuple[Term | None, ...],
    said: _Said,
    value: int,
    holes: Sequence[tuple[int, int]],
    guards: set[Parts],
    to_beat: int,
) -> tuple[tuple[int, int], ForAll] | None:
    """The best guard of `forall` for a kind of change, with how many transitions it tells of: if that may be
    as many as are `to_beat`. None asks that the change is still to be made, which says nothing."""
    variable = said.variable
    effect = Assign(symbol.name, tuple(variable if t is None else t for t in terms), symbol.values[value])
    every = sets(arrays, known, ForAll((variable,), (), (effect,)))
    open_places = np.zeros(every.applies.shape, dtype=bool)
    open_places[tuple(np.array(holes).T)] = True
    would, wrong = every.applies & every.moves, every.applies & ~every.right
    has = open_places.any(axis=1)
    best: tuple[tuple[int, int], Parts, Bools] | None = None
    rows, places = np.array(sorted(holes)).T
    least = max(1.0, LEAST_COVERED * len(rows))

    def whole(satisfied: Bools) -> Bools:
        ends = np.flatnonzero(np.diff(rows, prepend=-1))
        found: Bools = np.logical_and.reduceat(satisfied, ends, axis=1)
        return found

    def enough(satisfied: float) -> bool:
        return satisfied > least and satisfied >= max(to_beat, best[0][0] if best else 0)

    sought = _Open(rows, places, whole, enough, lambda: best and best[1:])
    all_of_them: tuple[Parts, Bools] = (), np.ones(would.shape, dtype=bool)
    conditions = _conditions(arrays, known, said, sought)
    still_open = negated(arrays.domain, Literal(symbol.name, effect.terms, frozenset({effect.value})))
    for parts, fits in itertools.chain([all_of_them], conditions):
        if still_open in parts:
            continue
        missed = open_places & ~(fits & would)
        covered = int((has & ~some(fits & wrong, 1) & ~some(missed, 1)).sum())
        rank = covered, -2 * len(parts) + (parts in guards)
        if covered > least and (best is None or rank > best[0]):
            best = rank, parts, fits
    if best is None:
        return None
    return best[0], ForAll((variable,), best[1], (effect,))


# ---- outcomes


def raw_outcomes(arrays: Arrays, known: Named, changes: Sequence[Change]) -> Counter[Outcome]:
    """What happened in each transition, as far as it can be told of terms, and how often."""
    at = _terms_at(known)
    by_row: dict[int, set[Effect]] = {row: set() for row in range(arrays.size)}
    told: dict[Change, Effect] = {}
    for forall in known.foralls:
        for change in _explained(arrays, replace(known, foralls=(forall,))):
            told.setdefault(change, forall)
    plain: dict[tuple[str, tuple[Term, ...]], list[Change]] = {}
    symbols = {symbol.name: symbol for symbol in arrays.domain.symbols}
    order = {term: number for number, term in enumerate(known.columns)}
    for change in changes:
        terms = tuple(at[change.row].get(place) for place in change.places)
        if None not in terms:
            if symbols[change.symbol].symmetric:
                terms = tuple(sorted(terms, key=lambda term: order[term]))  # type: ignore[index]
            if fits_types(arrays.domain, symbols[change.symbol], terms):  # type: ignore[arg-type]
                plain.setdefault((change.symbol, terms), []).append(change)  # type: ignore[arg-type]
        elif change in told:
            by_row[change.row].add(told[change])
    for (symbol, terms), found in sorted(plain.items(), key=str):
        for change, effect in _plain_effects(arrays.domain, symbol, terms, found):
            by_row[change.row].add(effect)
    return Counter(map(frozenset, by_row.values()))


def _plain_effects(
    domain: Domain, name: str, terms: tuple[Term, ...], found: Sequence[Change]
) -> Iterator[tuple[Change, Assign | Shift]]:
    """The effect that each change of a fluent is told by: of those that tell of most changes the first, and
    so on."""
    symbol = next(each for each in domain.symbols if each.name == name)
    candidates: dict[Assign | Shift, set[Change]] = {}
    for change in found:
        candidates.setdefault(Assign(name, terms, symbol.values[change.new]), set()).add(change)
    exact = {effect: len(told) for effect, told in candidates.items()}
    if isinstance(symbol.values[0], int) and not symbol.is_predicate:
        for amount in sorted({change.new - change.old for change in found}):
            reached = {
                change
                for change in found
                if min(max(change.old + amount, 0), len(symbol.values) - 1) == change.new
            }
            candidates[Shift(name, terms, amount)] = reached
            exact[Shift(name, terms, amount)] = sum(c.new - c.old == amount for c in found)
    left = set(found)
    while left:
        effect = max(candidates, key=lambda each: (len(candidates[each] & left), exact[each]))
        for change in sorted(candidates[effect] & left):
            yield change, effect
        left -= candidates.pop(effect)
