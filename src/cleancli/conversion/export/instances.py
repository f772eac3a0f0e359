"""Formulas and changes written out for the objects of one problem, so that no quantifier is left.

That some object satisfies a formula is that one of them does. What happens to all that a guard holds of
happens to each of them where the guard holds of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from math import prod

from cleancli.conversion.export.formulas import LARGEST, Formulas, NotSaid
from cleancli.conversion.pddl.effect_trees import (
    Change,
)
from cleancli.conversion.pddl.formula import (
    NEVER,
    Both,
    Either,
    Formula,
    Quantified,
    both,
    either,
    free_variables,
)
from cleancli.language.model import Equality, Literal, Object, Problem, Term, Variable

MOST_TRIED = 20_000
"""Bindings that are tried to find out whether some objects can be meant at all. Chosen."""


class Instances:
    """Writes formulas out for the objects of a problem; `were_needed` tells whether one was."""

    def __init__(self, formulas: Formulas, problem: Problem) -> None:
        self.were_needed = False
        self._formulas = formulas
        self._things = (*formulas.domain.constants, *problem.objects)
        fixed = [symbol for symbol in formulas.domain.symbols if symbol.name not in formulas.changed]
        of = formulas.predicates.of
        self._unchanged = {
            of(symbol.name, value)
            for symbol in fixed
            for value in ((None,) if symbol.is_predicate else symbol.values)
        }
        self._known: set[tuple[str, tuple[str, ...]]] = set()
        symbols = {symbol.name: symbol for symbol in fixed}
        for fact in problem.state:
            if symbol := symbols.get(fact.symbol):
                name = of(symbol.name, None if symbol.is_predicate else fact.value)
                self._known.add((name, fact.objects))
                if symbol.symmetric:
                    self._known.add((name, fact.objects[::-1]))

    def formula(self, formula: Formula) -> Formula:
        """The formula without quantifiers. Raises `NotSaid` where it grows too large."""
        match formula:
            case Both(parts):
                return both(map(self.formula, parts))
            case Either(parts):
                return either(map(self.formula, parts))
            case Quantified(exists, variables, part):
                join = either if exists else both
                return join(self.formula(each) for each in self._each(part, variables))
        return formula

    def changes(self, changes: Iterable[Change], names: Mapping[Term, Term]) -> tuple[Change, ...]:
        """The changes of each object by itself, whose guards have no quantifiers; with other terms for free
        variables that have `names`."""
        found: dict[Change, None] = {}
        for change in changes:
            for things in self._bindings(change.variables):
                terms = {**names, **things}
                guard = self.formula(self._formulas.renamed(change.guard, terms))
                if guard != NEVER:
                    here = tuple(terms.get(term, term) for term in change.terms)
                    found[Change((), guard, change.symbol, here, change.value)] = None
        return tuple(found)

    def _each(self, part: Formula, variables: Sequence[Variable]) -> Iterator[Formula]:
        for terms in self._bindings(variables):
            yield self._formulas.renamed(part, terms)

    def _bindings(self, variables: Sequence[Variable]) -> Iterator[dict[Term, Term]]:
        fitting = [self._fitting(variable) for variable in variables]
        if prod(map(len, fitting)) > LARGEST:
            raise NotSaid(f"what is said of all objects is said more than {LARGEST} times")
        self.were_needed = self.were_needed or bool(variables)
        for things in product(*fitting):
            yield dict(zip(variables, things, strict=True))

    def _fitting(self, variable: Variable) -> list[Object]:
        return [thing for thing in self._things if self._formulas.domain.is_a(thing.type, variable.type)]

    # ---- what can hold at all

    def can_hold(self, parts: Iterable[Literal | Equality]) -> bool:
        """Whether some objects of the problem satisfy those parts of which nothing changes the truth. True
        where too many would have to be tried."""
        fixed = [part for part in parts if isinstance(part, Equality) or part.symbol in self._unchanged]
        variables = list(dict.fromkeys(v for part in fixed for v in free_variables(part)))
        fitting = [self._fitting(variable) for variable in variables]
        if prod(map(len, fitting)) > MOST_TRIED:
            return True
        every = (dict[Term, Term](zip(variables, things, strict=True)) for things in product(*fitting))
        return any(all(self._holds(part, terms) for part in fixed) for terms in every)

    def _holds(self, part: Literal | Equality, terms: dict[Term, Term]) -> bool:
        if isinstance(part, Equality):
            return (terms.get(part.left, part.left) == terms.get(part.right, part.right)) is part.equal
        names = tuple(terms.get(term, term).name for term in part.terms)
        return ((part.symbol, names) in self._known) is (True in part.values)
