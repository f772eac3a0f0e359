"""Bindings of variables that satisfy what no action can change, by joining facts and not trying all tuples.

Guaranteed by the checker: every name is declared, arities and types fit, and functions list all their values.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

from cleancli.compiler.evaluate import Binding, Key, changeable_symbols, values_of
from cleancli.language.model import (
    Condition,
    Domain,
    Equality,
    Fact,
    Literal,
    Problem,
    Symbol,
    Term,
    Value,
    Variable,
)

_Row = tuple[str, ...]


class Universe:
    """The objects and initial facts of a problem, indexed for joins; decides what no rule can change."""

    def __init__(self, domain: Domain, problem: Problem) -> None:
        self.symbols: Mapping[str, Symbol] = {symbol.name: symbol for symbol in domain.symbols}
        self.changeable = changeable_symbols(domain)
        objects = (*domain.constants, *problem.objects)
        self._objects = {
            type_.name: tuple(sorted({o.name for o in objects if domain.is_a(o.type, type_.name)}))
            for type_ in domain.types
        }
        self._values = values_of(problem.state)
        self._rows = self._rows_by_value(problem.state)
        self._indices: dict[tuple[str, frozenset[Value], tuple[int, ...]], dict[_Row, list[_Row]]] = {}

    def key(self, symbol: str, terms: Sequence[Term], binding: Binding) -> Key:
        """The symbol for the objects that `terms` stand for, all of them bound."""
        return symbol, self.symbols[symbol].canonical(tuple(_name(term, binding) for term in terms))

    def initial(self, key: Key) -> Value:
        """The value in the initial state; a predicate that is not listed is false."""
        return self._values[key] if not self.symbols[key[0]].is_predicate else self._values.get(key, False)

    def extensions(
        self, variables: Sequence[Variable], condition: Condition, binding: Binding
    ) -> Iterator[dict[Variable, str]]:
        """Every extension of `binding` by `variables` that satisfies the unchangeable part of the condition.

        Unchangeable are equalities and literals of symbols that no outcome sets. Each extension comes once.
        """
        tests = [part for part in condition if isinstance(part, Equality) or self.is_static(part)]
        return self._extend(dict(binding), [v for v in variables if v not in binding], tests)

    def is_static(self, literal: Literal) -> bool:
        """Whether no outcome of any rule can change the literal's symbol."""
        return literal.symbol not in self.changeable

    def _extend(
        self, binding: dict[Variable, str], free: list[Variable], tests: list[Literal | Equality]
    ) -> Iterator[dict[Variable, str]]:
        decided = [test for test in tests if _is_bound(test, binding)]
        if not all(self._holds(test, binding) for test in decided):
            return
        if not free:
            yield binding
            return
        open_tests = [test for test in tests if test not in decided]
        for more in self._next_bindings(binding, free, open_tests):
            extended = {**binding, **more}
            yield from self._extend(extended, [v for v in free if v not in extended], open_tests)

    def _next_bindings(
        self, binding: dict[Variable, str], free: list[Variable], tests: list[Literal | Equality]
    ) -> Iterator[dict[Variable, str]]:
        """Bindings of some free variables: by the literal with fewest matches, or of one by its type."""
        joins = [
            (self._matches(test, binding), test)
            for test in tests
            if isinstance(test, Literal) and False not in test.values  # facts do not list what is false
        ]
        smallest = min(joins, key=lambda join: len(join[0]), default=None)
        if smallest is None or len(smallest[0]) > len(self._objects[free[0].type]):
            for name in self._objects[free[0].type]:
                yield {free[0]: name}
            return
        rows, literal = smallest
        for row in rows:
            more = self._unified(literal, row, binding)
            if more is not None:
                yield more

    def _unified(self, literal: Literal, row: _Row, binding: Binding) -> dict[Variable, str] | None:
        """What the row binds; None where a variable would need two objects or a type does not fit."""
        more: dict[Variable, str] = {}
        for term, name in zip(literal.terms, row, strict=True):
            if not isinstance(term, Variable) or term in binding:
                continue
            if more.setdefault(term, name) != name or name not in self._objects[term.type]:
                return None
        return more

    def _matches(self, literal: Literal, binding: Binding) -> Sequence[_Row]:
        """Object tuples for which the literal holds, given the variables that are bound."""
        known = tuple(
            position
            for position, term in enumerate(literal.terms)
            if not isinstance(term, Variable) or term in binding
        )
        name = (literal.symbol, literal.values, known)
        if name not in self._indices:
            index: dict[_Row, list[_Row]] = defaultdict(list)
            rows = {row for value in literal.values for row in self._rows.get((literal.symbol, value), ())}
            for row in sorted(rows):
                index[tuple(row[position] for position in known)].append(row)
            self._indices[name] = dict(index)
        return self._indices[name].get(tuple(_name(literal.terms[p], binding) for p in known), ())

    def _holds(self, test: Literal | Equality, binding: Binding) -> bool:
        match test:
            case Equality(left, right, equal):
                return (_name(left, binding) == _name(right, binding)) is equal
            case Literal(symbol, terms, values):
                return self.initial(self.key(symbol, terms, binding)) in values

    def _rows_by_value(self, state: frozenset[Fact]) -> dict[tuple[str, Value], list[_Row]]:
        """Object tuples by symbol and value; a symmetric fact stands in every order of its objects."""
        rows: dict[tuple[str, Value], list[_Row]] = defaultdict(list)
        for fact in state:
            symmetric = self.symbols[fact.symbol].symmetric
            orders = set(itertools.permutations(fact.objects)) if symmetric else (fact.objects,)
            rows[fact.symbol, fact.value].extend(orders)
        return dict(rows)


def _is_bound(test: Literal | Equality, binding: Binding) -> bool:
    terms = test.terms if isinstance(test, Literal) else (test.left, test.right)
    return all(not isinstance(term, Variable) or term in binding for term in terms)


def _name(term: Term, binding: Binding) -> str:
    return binding[term] if isinstance(term, Variable) else term.name
