"""Joins static facts by columns: all that some variables may stand for at once, a column of objects each.

Guaranteed by the checker: every name is declared, and arities and types fit. What is found is the same as by
`Universe.extensions`, which takes one binding after the other, and is for short joins inside of others.
"""

from __future__ import annotations

import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from cleancli.array_types import Bools, Longs
from cleancli.compiler.ragged import spans
from cleancli.compiler.static_join import Part, Universe, free_variables
from cleancli.language.model import Condition, Equality, Literal, Term, Variable

_Columns = Mapping[Variable, Longs]

FEW = 50
"""Tuples of objects, by their types alone, up to which they are tried one by one, which is faster. Measured
with benchmarks/planning.nid."""


@dataclass(frozen=True, slots=True)
class _Step:
    """What the next variables may stand for: of each column of `new`, so many entries as `fitting` says for
    each row so far, from `first` on."""

    first: Longs  # (rows so far,)
    fitting: Longs  # (rows so far,)
    new: _Columns

    @property
    def rows(self) -> int:
        """How many it leaves."""
        return int(self.fitting.sum())

    def taken(self, columns: _Columns) -> dict[Variable, Longs]:
        """The columns after it."""
        row, entry = spans(self.first, self.fitting)
        before = {variable: column[row] for variable, column in columns.items()}
        return before | {variable: column[entry] for variable, column in self.new.items()}


class ColumnJoin:
    """Joins in one universe. Objects are numbered in the order of their names."""

    def __init__(self, universe: Universe) -> None:
        self.universe = universe
        self.names: tuple[str, ...] = universe.everything
        self._number = {name: number for number, name in enumerate(self.names)}
        self._facts: dict[tuple[str, frozenset[object]], Longs] = {}
        self._members: dict[str, Bools] = {}

    def bindings(self, variables: Sequence[Variable], condition: Condition) -> Longs:
        """Every tuple of objects that the unchangeable part of a condition allows: (n, variables), sorted."""
        if prod(len(self.universe.objects(each.type)) for each in variables) <= FEW:
            found = self.universe.extensions(variables, condition, {})
            numbers = sorted([self._number[each[v]] for v in variables] for each in found)
            return np.array(numbers, dtype=np.int64).reshape(len(numbers), len(variables))
        rows = self._joined(variables, condition, sys.maxsize)
        assert rows is not None, "nothing is more than that"
        return rows[np.lexsort(rows.T[::-1])] if variables else rows

    def count(self, variables: Sequence[Variable], condition: Condition, most: int) -> int | None:
        """How many there are; None where a step of the join would leave more than `most` rows."""
        rows = self._joined(variables, condition, most)
        return None if rows is None else len(rows)

    def widest(self, literal: Literal, bound: Collection[Variable]) -> int | None:
        """The most object tuples that a literal leaves; None where facts do not list what it holds for."""
        if not self.universe.lists_rows(literal):
            return None
        terms = enumerate(literal.terms)
        known = [place for place, term in terms if not isinstance(term, Variable) or term in bound]
        facts = self._rows(literal)[:, known]
        codes, _ = self._codes(facts, facts[:0])
        return int(np.unique(codes, return_counts=True)[1].max(initial=0))

    def _joined(self, variables: Sequence[Variable], condition: Condition, most: int) -> Longs | None:
        """The same in any order; None where a step would leave more than `most` rows."""
        tests = [part for part in condition if self.universe.is_static(part)]
        columns: dict[Variable, Longs] = {}
        count = 1
        while True:
            for test in [test for test in tests if columns.keys() >= set(free_variables(test))]:
                tests.remove(test)
                kept = np.flatnonzero(self._holds(test, columns, count))
                columns = {variable: column[kept] for variable, column in columns.items()}
                count = len(kept)
            free = [variable for variable in variables if variable not in columns]
            if not free:
                return _table([columns[each] for each in variables], count)
            step = self._narrowest(free, tests, columns, count)
            if step.rows > most:
                return None
            columns = step.taken(columns)
            count = step.rows

    def _narrowest(
        self, free: Sequence[Variable], tests: Sequence[Part], columns: _Columns, count: int
    ) -> _Step:
        """The next step: what an equality says, or the literal that leaves fewest, or a variable's type."""
        for test in tests:
            if isinstance(test, Equality) and test.equal and (step := self._equated(test, columns, count)):
                return step
        objects = np.flatnonzero(self._is_object(free[0]))
        whole = np.full(count, len(objects))
        by_type = _Step(np.zeros(count, dtype=np.int64), whole, {free[0]: objects})
        listed = [each for each in tests if isinstance(each, Literal) and self.universe.lists_rows(each)]
        steps = [self._matching(literal, columns, count) for literal in listed]
        return min([*steps, by_type], key=lambda step: step.rows)

    def _equated(self, equality: Equality, columns: _Columns, count: int) -> _Step | None:
        for term, other in ((equality.left, equality.right), (equality.right, equality.left)):
            if isinstance(term, Variable) and term not in columns:
                if isinstance(other, Variable) and other not in columns:
                    continue
                values = self._column(other, columns, count)
                fits = self._is_object(term)[values]
                return _Step(np.arange(count), fits.astype(np.int64), {term: values})
        return None

    def _matching(self, literal: Literal, columns: _Columns, count: int) -> _Step:
        """The facts that fit what is bound already, for each row."""
        facts = self._rows(literal)
        new: dict[Variable, Longs] = {}
        known: list[tuple[Term, int]] = []
        fits = np.ones(len(facts), dtype=np.bool_)
        for position, term in enumerate(literal.terms):
            if not isinstance(term, Variable) or term in columns:
                known.append((term, position))
            elif term in new:
                fits &= new[term] == facts[:, position]
            else:
                new[term] = facts[:, position]
                fits &= self._is_object(term)[new[term]]
        facts = facts[fits]
        asked, given = self._codes(
            _table([self._column(term, columns, count) for term, _ in known], count),
            facts[:, [position for _, position in known]],
        )
        order = np.argsort(given, kind="stable")
        first = np.searchsorted(given[order], asked)
        fitting = np.searchsorted(given[order], asked, side="right") - first
        return _Step(first, fitting, {term: column[fits][order] for term, column in new.items()})

    def _holds(self, test: Part, columns: _Columns, count: int) -> Bools:
        """Whether a test holds whose variables are all bound, for each row."""
        if isinstance(test, Equality):
            left, right = (self._column(term, columns, count) for term in (test.left, test.right))
            equal: Bools = left == right
            return equal if test.equal else ~equal
        if isinstance(test, Literal) and test.terms and self.universe.lists_rows(test):
            asked = _table([self._column(term, columns, count) for term in test.terms], count)
            codes, given = self._codes(asked, self._rows(test))
            given = np.append(np.sort(given), -1)
            holds: Bools = given[np.searchsorted(given[:-1], codes)] == codes
            return holds
        return self._holds_each(test, columns, count)

    def _holds_each(self, test: Part, columns: _Columns, count: int) -> Bools:
        """The same by asking once for each choice of the objects that the test speaks of."""
        variables = list(dict.fromkeys(free_variables(test)))
        rows = (
            np.array([columns[each] for each in variables], dtype=np.int64).reshape(len(variables), count).T
        )
        distinct, place = self.projected(rows)
        bindings = [dict(zip(variables, self.named(row), strict=True)) for row in distinct.tolist()]
        answers = [self.universe.holds(test, binding) for binding in bindings]
        return np.array(answers, dtype=np.bool_)[place]

    def named(self, row: Sequence[int]) -> tuple[str, ...]:
        """The names of objects."""
        return tuple([self.names[number] for number in row])

    def _column(self, term: Term, columns: _Columns, count: int) -> Longs:
        return columns[term] if isinstance(term, Variable) else np.full(count, self._number[term.name])

    def _is_object(self, variable: Variable) -> Bools:
        """Whether each object is of the variable's type: (objects,)."""
        if variable.type not in self._members:
            members = np.zeros(len(self.names), dtype=np.bool_)
            members[[self._number[name] for name in self.universe.objects(variable.type)]] = True
            self._members[variable.type] = members
        return self._members[variable.type]

    def _rows(self, literal: Literal) -> Longs:
        """The object tuples for which a literal holds, in numbers: (n, terms)."""
        name = (literal.symbol, frozenset[object](literal.values))
        if name not in self._facts:
            rows = self.universe.rows(literal)
            numbers = [self._number[each] for row in rows for each in row]
            self._facts[name] = np.array(numbers, dtype=np.int64).reshape(len(rows), len(literal.terms))
        return self._facts[name]

    def projected(self, rows: Longs) -> tuple[Longs, Longs]:
        """The distinct of some rows of objects, sorted, and which of them each row is."""
        codes, _ = self._codes(rows, rows[:0])
        _, first, place = np.unique(codes, return_index=True, return_inverse=True)
        return rows[first], place.astype(np.int64)

    def _codes(self, one: Longs, other: Longs) -> tuple[Longs, Longs]:
        """A number for each row of two tables, in the order of rows, and the same where they are."""
        codes = np.zeros(len(one) + len(other), dtype=np.int64)
        largest, size = 1, max(len(self.names), 1)
        for column in np.concatenate([one, other]).T:
            if largest > 2**62 // size:
                codes = np.unique(codes, return_inverse=True)[1].astype(np.int64)
                largest = len(codes)
            codes = codes * size + column
            largest *= size
        return codes[: len(one)], codes[len(one) :]


def _table(columns: Sequence[Longs], count: int) -> Longs:
    """Columns of `count` entries as one array: (count, columns)."""
    return np.array(columns, dtype=np.int64).reshape(len(columns), count).T
