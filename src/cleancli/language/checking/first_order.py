"""When a rule applies, as one first-order formula: references and derived predicates spelled out.

Guaranteed before: literals are well typed. What a formula asks to exist gets a variable of its own, so that
only `Every` is left of the quantifiers. A derived predicate is replaced by its definition, unless that would
ask for something to exist for every object, or is a closure, cyclic or very long: then it stays as a symbol
that may hold anywhere, and the reading is not exact.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cleancli.language.checking.declarations import Declarations
from cleancli.language.checking.literals import negated, with_terms
from cleancli.language.model import Equality, Literal, Quantified, Rule, Term, Variable

_LONGEST = 2000
"""Parts of definitions that one formula may take in."""
_DEEPEST = 50


@dataclass(frozen=True, slots=True)
class Both:
    """All parts hold."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Either:
    """One part holds at least."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Every:
    """The body holds for every binding of the variables."""

    variables: tuple[Variable, ...]
    body: Formula


Formula = Literal | Equality | Both | Either | Every

_Names = Mapping[Term, Term]


class _Alternates(Exception):
    """Something would have to exist for every object."""


class Reading:
    """Reads the conditions of rules into formulas over common variables.

    `variables` are those that stand for one object each; `optional` those of them that are needed only where
    their part of an `Either` holds. `exact` is False once a definition was left out.
    """

    def __init__(self, declared: Declarations, variables: tuple[Variable, ...]) -> None:
        self.variables = list(variables)
        self.optional: set[Variable] = set()
        self.exact = True
        self._declared = declared
        self._taken = {variable.name: 1 for variable in variables}
        self._length = 0

    def rule(self, rule: Rule) -> tuple[Formula, ...]:
        """That the rule applies, its own variables being the first of the reading's."""
        names: dict[Term, Term] = dict(zip(rule.variables, self.variables, strict=False))
        formulas = [self._part(part, names, True, _TOP) for part in rule.condition]
        for reference in rule.references:
            one = {**names, **self._exist(reference.variables, _TOP)}
            formulas += [self._part(part, one, True, _TOP) for part in reference.condition]
            formulas.append(self._no_other(reference.variables, reference.condition, names, one))
            names = one
        return tuple(formulas)

    def _no_other(
        self,
        variables: tuple[Variable, ...],
        condition: tuple[Literal | Equality, ...],
        names: _Names,
        one: _Names,
    ) -> Formula:
        """Exactly one binding: any that fits is the one that was found."""
        others: dict[Term, Term] = {v: self._fresh(v) for v in variables}
        fails = tuple(self._part(p, {**names, **others}, False, _EVERY) for p in condition)
        same = Both(tuple(Equality(others[v], one[v], True) for v in variables))
        return Every(tuple(v for v in others.values() if isinstance(v, Variable)), Either((*fails, same)))

    def _part(
        self, part: Literal | Equality | Quantified, names: _Names, holds: bool, place: _Place
    ) -> Formula:
        if isinstance(part, Quantified):
            return self._quantified(part, names, holds, place)
        if isinstance(part, Literal) and part.symbol in self._declared.derived:
            return self._derived(part, names, holds, place)
        renamed = with_terms(part, names)
        return renamed if holds else negated(renamed, self._declared)

    def _quantified(self, part: Quantified, names: _Names, holds: bool, place: _Place) -> Formula:
        if part.exists == holds:
            inner = {**names, **self._exist(part.variables, place)}
            return Both(tuple(self._part(p, inner, True, place) for p in part.condition))
        others: dict[Term, Term] = {v: self._fresh(v) for v in part.variables}
        inner = {**names, **others}
        below = _Place(True, place.in_either, place.definitions)
        fails = Either(tuple(self._part(p, inner, False, below) for p in part.condition))
        return Every(tuple(v for v in others.values() if isinstance(v, Variable)), fails)

    def _derived(self, part: Literal, names: _Names, holds: bool, place: _Place) -> Formula:
        renamed = with_terms(part, names)
        free = renamed if holds else negated(renamed, self._declared)
        definition = self._declared.derived[part.symbol]
        self._length += len(definition.condition)
        if (
            definition.closure is not None
            or part.symbol in place.definitions
            or len(place.definitions) > _DEEPEST
            or self._length > _LONGEST
        ):
            self.exact = False
            return free
        assert isinstance(renamed, Literal)
        inner: dict[Term, Term] = dict(zip(definition.parameters, renamed.terms, strict=True))
        truth = holds == (True in part.values)
        below = _Place(place.in_every, place.in_either or not truth, (*place.definitions, part.symbol))
        kept = len(self.variables)
        try:
            parts = tuple(self._part(p, inner, truth, below) for p in definition.condition)
        except _Alternates:
            del self.variables[kept:]
            self.exact = False
            return free
        return Both(parts) if truth else Either(parts)

    def _exist(self, variables: tuple[Variable, ...], place: _Place) -> dict[Term, Term]:
        if place.in_every:
            raise _Alternates
        fresh = [self._fresh(variable) for variable in variables]
        self.variables += fresh
        if place.in_either:
            self.optional.update(fresh)
        return dict(zip(variables, fresh, strict=True))

    def _fresh(self, variable: Variable) -> Variable:
        number = self._taken.get(variable.name, 0) + 1
        self._taken[variable.name] = number
        return Variable(variable.name if number == 1 else f"{variable.name}_{number}", variable.type)


@dataclass(frozen=True, slots=True)
class _Place:
    """What is around a part of a formula."""

    in_every: bool
    in_either: bool
    definitions: tuple[str, ...]


_TOP = _Place(False, False, ())
_EVERY = _Place(True, False, ())
