"""Plain rules, grounded by columns: those whose condition is one conjunction of literals or several that
exclude each other, and whose outcomes set the same in every state.

Guaranteed by the checker: every variable is bound. Each literal and each effect is made once for each choice
of the objects that it speaks of itself, and not once for each binding of the rule: a rule for three objects
with literals for one has as many bindings as there are triples, and as many literals as objects.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from cleancli.array_types import Bools, Longs
from cleancli.compiler.column_join import ColumnJoin
from cleancli.compiler.conjunctions import Conjunction, conjunctions
from cleancli.compiler.fluents import Binding, Fluent
from cleancli.compiler.ragged import distinct, spans, starts
from cleancli.compiler.static_join import Universe, free_variables
from cleancli.language.model import (
    Assign,
    ForAll,
    Literal,
    Outcome,
    Rule,
    Value,
    Variable,
)

_Entry = TypeVar("_Entry", bound=Hashable)
NOTHING = -1
"""In the place of a literal that another one of its condition says already."""


class Numbered(Generic[_Entry]):
    """Numbers for what is met, in the order in which it is."""

    def __init__(self) -> None:
        self.entries: list[_Entry] = []
        self._number: dict[_Entry, int] = {}

    def number(self, entry: _Entry) -> int:
        """The entry's number, a new one if it was not met yet."""
        found = self._number.setdefault(entry, len(self.entries))
        if found == len(self.entries):
            self.entries.append(entry)
        return found


class Vocabulary:
    """All literals and assignments of the plain rules of a problem, and the fluents that they are about."""

    def __init__(self) -> None:
        self.fluents: Numbered[Fluent] = Numbered()
        self.literals: Numbered[tuple[Fluent, frozenset[Value]]] = Numbered()
        self.assignments: Numbered[tuple[Fluent, Value]] = Numbered()

    def fluents_of(self, entries: Iterable[tuple[Fluent, object]]) -> Longs:
        """The number of each entry's fluent."""
        return np.array([self.fluents.number(fluent) for fluent, _ in entries], dtype=np.int64)


@dataclass(frozen=True, slots=True)
class PlainInstances:
    """The n instances of a plain rule (its index in the domain) for one of its conjunctions, by objects.

    Literals and what outcomes assign are numbers of the vocabulary. Each outcome has two columns: instances,
    ascending, and what is assigned there.
    """

    rule: int
    objects: Longs  # (n, variables) numbers of the join
    literals: Longs  # (n, literals) `NOTHING` where there is none
    assigned: tuple[tuple[Longs, Longs], ...]

    def only(self, kept: Bools) -> PlainInstances:
        """Some of them."""
        if kept.all():
            return self
        place = np.cumsum(kept) - 1
        assigned = tuple([(place[rows[kept[rows]]], what[kept[rows]]) for rows, what in self.assigned])
        return PlainInstances(self.rule, self.objects[kept], self.literals[kept], assigned)

    def conflicts(self, about: Longs) -> list[int]:
        """The first instance in which each outcome gives a fluent two values, if there is one. `about` says
        what each assignment is about."""
        found = set()
        for rows, assigned in self.assigned:
            if not len(rows):
                continue
            order = np.lexsort((about[assigned], rows))
            row, fluent = rows[order], about[assigned][order]
            found |= set(row[1:][(row[1:] == row[:-1]) & (fluent[1:] == fluent[:-1])][:1].tolist())
        return sorted(found)


def plain_conjunctions(rule: Rule, universe: Universe) -> tuple[Conjunction, ...] | None:
    """The conjunctions (conjunctions.py) of a rule that is grounded by columns: it has no references, and the
    state decides none of its effects. None for another rule."""
    effects = [effect for outcome in rule.outcomes for effect in outcome.effects]
    if rule.references or not all(_sets_always(effect, universe) for effect in effects):
        return None
    return conjunctions(rule, universe)


def _sets_always(effect: object, universe: Universe) -> bool:
    if isinstance(effect, ForAll):
        inner = all(isinstance(each, Assign) for each in effect.effects)
        return inner and all(universe.is_static(part) for part in effect.condition)
    return isinstance(effect, Assign)


class _Rows:
    """What the variables of a rule stand for, a row for each instance."""

    def __init__(self, variables: Sequence[Variable], objects: Longs, join: ColumnJoin) -> None:
        self.objects = objects
        self._variables = list(variables)
        self._join = join
        self._choices: dict[tuple[Variable, ...], tuple[list[Binding], Longs]] = {}

    def choices(self, asked: Iterable[Variable]) -> tuple[list[Binding], Longs]:
        """What some of the variables stand for, each choice once, and the choice of each row."""
        wanted = tuple(dict.fromkeys(asked))
        if wanted not in self._choices:
            distinct, place = self._join.projected(self.objects[:, list(map(self._variables.index, wanted))])
            named = map(self._join.named, distinct.tolist())
            self._choices[wanted] = [dict(zip(wanted, names, strict=True)) for names in named], place
        return self._choices[wanted]


class PlainGrounding:
    """Makes instances of plain rules in one universe."""

    def __init__(self, universe: Universe, join: ColumnJoin) -> None:
        self._universe = universe
        self._join = join
        self.vocabulary = Vocabulary()

    def instances(
        self, index: int, rule: Rule, cases: Sequence[Conjunction], objects: Longs
    ) -> Iterator[PlainInstances]:
        """All for these objects, by the rule's conjunctions, but for those whose literals exclude each
        other."""
        rows = _Rows(rule.variables, objects, self._join)
        found = [self._literals(conjunction, rows) for conjunction in cases]
        assigned = tuple([self._assigned(outcome, rows) for outcome in rule.outcomes])
        for conjunction, literals in zip(cases, found, strict=True):
            possible = self._merge(literals, [literal.symbol for literal in conjunction])
            yield PlainInstances(index, objects, literals, assigned).only(possible)

    def _literals(self, parts: Sequence[Literal], rows: _Rows) -> Longs:
        columns = []
        for part in parts:
            bindings, place = rows.choices(free_variables(part))
            keys = [self._universe.key(part.symbol, part.terms, binding) for binding in bindings]
            numbers = [self.vocabulary.literals.number((key, part.values)) for key in keys]
            columns.append(np.array(numbers, dtype=np.int64)[place])
        return np.array(columns, dtype=np.int64).reshape(len(columns), len(rows.objects)).T

    def _merge(self, literals: Longs, symbols: Sequence[str]) -> Bools:
        """Makes one literal in place of two about one fluent; whether each row can hold."""
        known = self.vocabulary.literals
        possible = np.ones(len(literals), dtype=np.bool_)
        pairs = itertools.combinations(range(len(symbols)), 2)
        alike = [(one, other) for one, other in pairs if symbols[one] == symbols[other]]
        about = self.vocabulary.fluents_of(known.entries)[literals] if alike else literals
        for one, other in alike:
            rows = np.flatnonzero((about[:, one] == about[:, other]) & (about[:, other] != NOTHING))
            for row in rows.tolist():
                (fluent, left), (_, right) = (known.entries[literals[row, each]] for each in (one, other))
                possible[row] &= bool(left & right)
                literals[row, one] = known.number((fluent, left & right))
            literals[rows, other] = NOTHING
            about[rows, other] = NOTHING
        return possible

    def _assigned(self, outcome: Outcome, instances: _Rows) -> tuple[Longs, Longs]:
        """What an outcome assigns; nothing if it never happens."""
        rows, assigned = [np.empty(0, dtype=np.int64)], [np.empty(0, dtype=np.int64)]
        for effect in outcome.effects if outcome.probability else ():
            own = effect.variables if isinstance(effect, ForAll) else ()
            bindings, place = instances.choices(v for v in _mentioned(effect) if v not in own)
            found = [list(self._assignments(effect, binding)) for binding in bindings]
            start = starts(found).astype(np.int64)
            row, entry = spans(start[place], np.diff(start)[place])
            rows.append(row)
            assigned.append(np.array([each for several in found for each in several], dtype=np.int64)[entry])
        if len(rows) == 1:
            return rows[0], assigned[0]
        size = max(len(self.vocabulary.assignments.entries), 1)
        once = distinct(np.concatenate(rows) * size + np.concatenate(assigned))
        return once // size, once % size

    def _assignments(self, effect: object, binding: Binding) -> Iterator[int]:
        """What an effect assigns, for what its variables from outside stand for."""
        if isinstance(effect, ForAll):
            for extended in self._universe.extensions(effect.variables, effect.condition, binding):
                for inner in effect.effects:
                    yield from self._assignments(inner, extended)
        else:
            assert isinstance(effect, Assign)
            key = self._universe.key(effect.symbol, effect.terms, binding)
            yield self.vocabulary.assignments.number((key, effect.value))


def _mentioned(effect: object) -> list[Variable]:
    """The variables that an effect speaks of."""
    if isinstance(effect, ForAll):
        inside = [variable for part in effect.condition for variable in free_variables(part)]
        return [*inside, *(variable for inner in effect.effects for variable in _mentioned(inner))]
    assert isinstance(effect, Assign)
    return [term for term in effect.terms if isinstance(term, Variable)]
