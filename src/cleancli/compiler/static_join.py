"""Joins static facts to bindings of variables, where trying all tuples of objects would take too long.

Guaranteed by the checker: every name is declared, arities and types fit, and functions list all their values.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from cleancli.compiler.fluents import (
    Binding,
    Fluent,
    changeable_symbols,
    name_of,
    names_of,
    parameters_of,
    values_of,
)
from cleancli.compiler.objects_by_type import ObjectsByType
from cleancli.compiler.paths import Paths
from cleancli.language.model import (
    Condition,
    DerivedPredicate,
    Domain,
    Equality,
    Fact,
    Literal,
    Object,
    Problem,
    Quantified,
    Symbol,
    Term,
    Value,
    Variable,
)

Part = Literal | Equality | Quantified

_Row = tuple[str, ...]


class Universe:
    """The objects and initial facts of a problem, indexed for joins; decides what no rule can change."""

    def __init__(self, domain: Domain, problem: Problem) -> None:
        self.symbols: Mapping[str, Symbol] = {symbol.name: symbol for symbol in domain.symbols}
        self.derived: Mapping[str, DerivedPredicate] = {derived.name: derived for derived in domain.derived}
        self.changeable = _changeable(domain)
        objects = (*domain.constants, *problem.objects)
        self.everything = tuple(sorted({each.name for each in objects}))
        self._objects = ObjectsByType(domain, sorted(set(objects)))
        self._values = values_of(problem.state)
        self._rows = self._rows_by_value(problem.state)
        self._indices: dict[tuple[str, frozenset[Value], tuple[int, ...]], dict[_Row, list[_Row]]] = {}
        self._follows: dict[tuple[str, _Row], bool] = {}
        self._paths: dict[str, Paths] = {}

    def key(self, symbol: str, terms: Sequence[Term], binding: Binding) -> Fluent:
        """The symbol for the objects that `terms` stand for, all of them bound."""
        return symbol, self.symbols[symbol].canonical(names_of(terms, binding))

    def initial(self, key: Fluent) -> Value:
        """The value in the initial state; a predicate that is not listed is false."""
        return self._values[key] if not self.symbols[key[0]].is_predicate else self._values.get(key, False)

    def extensions(
        self, variables: Sequence[Variable], condition: Condition, binding: Binding
    ) -> Iterator[dict[Variable, str]]:
        """Every extension of `binding` by `variables` that satisfies the unchangeable part of the condition.

        Unchangeable are equalities, literals of symbols that no outcome sets, and what is made of these. Each
        extension comes once.
        """
        return (found for found in self.search(variables, condition, binding) if found is not None)

    def search(
        self, variables: Sequence[Variable], condition: Condition, binding: Binding
    ) -> Iterator[dict[Variable, str] | None]:
        """As `extensions`, with a None for each dead end: the length is what the search costs."""
        tests = [part for part in condition if self.is_static(part)]
        outer = {variable: name for variable, name in binding.items() if variable not in variables}
        return self._extend(outer, list(variables), tests)

    def is_static(self, part: Part) -> bool:
        """Whether no outcome of any rule can change if the part holds."""
        match part:
            case Literal(symbol):
                return symbol not in self.changeable
            case Equality():
                return True
            case Quantified(condition=condition):
                return all(self.is_static(inner) for inner in condition)

    def objects(self, type_name: str) -> tuple[str, ...]:
        """Names of the objects of a type, sorted."""
        return self._objects[type_name]

    def _extend(
        self, binding: dict[Variable, str], free: list[Variable], tests: list[Part]
    ) -> Iterator[dict[Variable, str] | None]:
        decided = [test for test in tests if _is_bound(test, binding)]
        if not all(self.holds(test, binding) for test in decided):
            yield None
            return
        if not free:
            yield binding
            return
        open_tests = [test for test in tests if test not in decided]
        for more in self._next_bindings(binding, free, open_tests):
            extended = {**binding, **more}
            left = [variable for variable in free if variable not in more]
            if left:
                yield from self._extend(extended, left, open_tests)
            else:
                yield extended if all(self.holds(test, extended) for test in open_tests) else None

    def _next_bindings(
        self, binding: dict[Variable, str], free: list[Variable], tests: list[Part]
    ) -> Iterator[dict[Variable, str]]:
        """Bindings of some free variables: of one by an equality, by the literal with fewest matches, or of
        one by its type."""
        equated = _equated_first(tests, binding)
        if equated is not None:
            variable, name = equated
            if variable in free and name in self._objects.names(variable.type):
                yield {variable: name}
            return
        everything = self._objects[free[0].type]
        smallest = self._fewest_matches(tests, binding)
        if smallest is None or len(smallest[0]) > len(everything):
            yield from ({free[0]: name} for name in everything)
            return
        rows, literal = smallest
        unified = (self._unified(literal, row, binding) for row in rows)
        yield from (more for more in unified if more is not None)

    def _fewest_matches(
        self, tests: Iterable[Part], binding: Binding
    ) -> tuple[Sequence[_Row], Literal] | None:
        """Of the literals whose object tuples facts list, the one with fewest, and these tuples."""
        listed = [test for test in tests if isinstance(test, Literal) and self.lists_rows(test)]
        joins = [(self._matches(literal, binding), literal) for literal in listed]
        return min(joins, key=lambda join: len(join[0]), default=None)

    def _unified(self, literal: Literal, row: _Row, binding: Binding) -> dict[Variable, str] | None:
        """What the row binds; None where a variable would need two objects or a type does not fit."""
        more: dict[Variable, str] = {}
        for term, name in zip(literal.terms, row, strict=True):
            if not isinstance(term, Variable) or term in binding:
                continue
            if more.setdefault(term, name) != name or name not in self._objects[term.type]:
                return None
        return more

    def lists_rows(self, literal: Literal) -> bool:
        """Whether facts list where it holds: not what is false, and not what only follows from facts."""
        return literal.symbol not in self.derived and not any(value is False for value in literal.values)

    def _matches(self, literal: Literal, binding: Binding) -> Sequence[_Row]:
        """Object tuples for which the literal holds, given the variables that are bound."""
        known = _known(literal, binding)
        index = self._index(literal, binding)
        return index.get(names_of([literal.terms[p] for p in known], binding), ())

    def rows(self, literal: Literal) -> list[_Row]:
        """Object tuples for which a literal holds whose rows facts list, sorted."""
        rows = {row for value in literal.values for row in self._rows.get((literal.symbol, value), ())}
        return sorted(rows)

    def _index(self, literal: Literal, bound: Collection[Variable]) -> dict[_Row, list[_Row]]:
        """Object tuples for which the literal holds, by the objects of its known terms."""
        known = _known(literal, bound)
        name = (literal.symbol, literal.values, known)
        if name not in self._indices:
            index: dict[_Row, list[_Row]] = defaultdict(list)
            for row in self.rows(literal):
                index[tuple(row[position] for position in known)].append(row)
            self._indices[name] = dict(index)
        return self._indices[name]

    def holds(self, test: Part, binding: Binding) -> bool:
        """Whether an unchangeable part holds, whose own variables are all bound."""
        match test:
            case Equality(left, right, equal):
                return (name_of(left, binding) == name_of(right, binding)) is equal
            case Literal(symbol, terms, values) if symbol in self.derived:
                return self._derives(self.derived[symbol], names_of(terms, binding)) in values
            case Literal(symbol, terms, values):
                return self.initial(self.key(symbol, terms, binding)) in values
            case Quantified(exists, variables, condition):
                return (next(self.extensions(variables, condition, binding), None) is not None) is exists

    def _derives(self, derived: DerivedPredicate, objects: _Row) -> bool:
        if derived.closure is not None:
            return self._closed(derived.closure).lead(*objects)
        known = self._follows.get((derived.name, objects))
        if known is None:
            binding = dict(zip(derived.parameters, objects, strict=True))
            known = next(self.extensions((), derived.condition, binding), None) is not None
            self._follows[derived.name, objects] = known
        return known

    def _closed(self, predicate: str) -> Paths:
        """Where the steps of an unchangeable predicate of two parameters lead."""
        if predicate not in self._paths:
            steps: dict[str, list[str]] = defaultdict(list)
            for source, target in self._pairs(predicate):
                steps[source].append(target)
            self._paths[predicate] = Paths(steps)
        return self._paths[predicate]

    def _pairs(self, predicate: str) -> Iterator[tuple[str, str]]:
        """The pairs for which an unchangeable predicate holds."""
        derived = self.derived.get(predicate)
        if derived is None:
            yield from ((one, two) for one, two in self._rows.get((predicate, True), ()))
        elif derived.closure is None:
            for found in self.extensions(derived.parameters, derived.condition, {}):
                one, two = (found[parameter] for parameter in derived.parameters)
                yield one, two
        else:
            inner = self._closed(derived.closure)
            source, target = derived.parameters
            everyone = itertools.product(self._objects[source.type], self._objects[target.type])
            yield from (pair for pair in everyone if inner.lead(*pair))

    def steps(self, predicate: str, start: str) -> tuple[str, ...]:
        """The objects that a predicate of two parameters may relate `start` to, by their types."""
        source, target = parameters_of(predicate, self.symbols, self.derived)
        return self._objects[target.type] if start in self._objects[source.type] else ()

    def _rows_by_value(self, state: frozenset[Fact]) -> dict[tuple[str, Value], list[_Row]]:
        """Object tuples by symbol and value; a symmetric fact stands in every order of its objects."""
        rows: dict[tuple[str, Value], list[_Row]] = defaultdict(list)
        for fact in state:
            symmetric = self.symbols[fact.symbol].symmetric
            orders = set(itertools.permutations(fact.objects)) if symmetric else (fact.objects,)
            rows[fact.symbol, fact.value].extend(orders)
        return dict(rows)


def step(predicate: str, source: str, target: str) -> Literal:
    """A predicate of two parameters for two objects; their types play no part."""
    return Literal(predicate, (Object(source, ""), Object(target, "")), frozenset({True}))


def _changeable(domain: Domain) -> frozenset[str]:
    """Names of the symbols that outcomes set, and of the derived predicates that depend on them."""
    changeable = set(changeable_symbols(domain))
    while True:
        follow = {d.name for d in domain.derived if not changeable.isdisjoint(_mentioned(d))}
        if follow <= changeable:
            return frozenset(changeable)
        changeable |= follow


def _mentioned(derived: DerivedPredicate) -> set[str]:
    inner = [q for part in derived.condition if isinstance(part, Quantified) for q in part.condition]
    found = {part.symbol for part in (*derived.condition, *inner) if isinstance(part, Literal)}
    return found if derived.closure is None else {derived.closure}


def _known(literal: Literal, bound: Collection[Variable]) -> tuple[int, ...]:
    """Positions of the literal's terms that are objects or bound."""
    return tuple(
        position
        for position, term in enumerate(literal.terms)
        if not isinstance(term, Variable) or term in bound
    )


def _equated_first(tests: Iterable[Part], binding: Binding) -> tuple[Variable, str] | None:
    """What the first of the equalities binds that bind anything."""
    equalities = (test for test in tests if isinstance(test, Equality) and test.equal)
    bound = (_equated(equality, binding) for equality in equalities)
    return next((found for found in bound if found is not None), None)


def _equated(equality: Equality, binding: Binding) -> tuple[Variable, str] | None:
    """The variable that an equality binds to what its other term stands for, if only one is known."""
    for term, other in ((equality.left, equality.right), (equality.right, equality.left)):
        known = not isinstance(other, Variable) or other in binding
        if isinstance(term, Variable) and term not in binding and known:
            return term, name_of(other, binding)
    return None


def _is_bound(test: Part, binding: Binding) -> bool:
    return all(term in binding for term in free_variables(test))


def free_variables(part: Part) -> list[Variable]:
    """The variables that a part needs to have bound from outside."""
    match part:
        case Literal(terms=terms):
            return [term for term in terms if isinstance(term, Variable)]
        case Equality(left, right):
            return [term for term in (left, right) if isinstance(term, Variable)]
        case Quantified(variables=own, condition=condition):
            return [v for inner in condition for v in free_variables(inner) if v not in own]
