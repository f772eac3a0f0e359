"""Formulas as conditions of .nid files: what these have no form for becomes a derived predicate with a name.

A condition is a conjunction, in which a disjunction has literals only, and so have quantifiers: what either
holds beyond literals is named. Where a quantifier holds a disjunction, it is written as the opposite of a
predicate that says that neither holds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cleancli.conversion.pddl.formula import (
    Both,
    Either,
    Formula,
    Quantified,
    apart,
    both,
    free_variables,
    is_basic,
    literal,
    negated,
)
from cleancli.conversion.pddl.naming import Naming
from cleancli.language.model import Condition, DerivedPredicate, Equality, Literal, Object, Term, Variable
from cleancli.language.model import Quantified as QuantifiedPart

_LONGEST_NAME = 40
"""Characters up to which a derived predicate is called by what it says. Chosen."""


class Definitions:
    """Derived predicates by what they say: each is made once."""

    def __init__(self, symbols: Naming) -> None:
        self._symbols = symbols
        self._names: dict[Formula, str] = {}
        self._made: dict[str, DerivedPredicate] = {}

    @property
    def predicates(self) -> tuple[DerivedPredicate, ...]:
        """All that were made, each before those that it uses."""
        return tuple(self._made.values())

    def condition(self, formula: Formula) -> Condition:
        """The formula as a conjunction."""
        match formula:
            case Literal() | Equality():
                return (formula,)
            case Both(parts):
                return tuple(part for each in parts for part in self.condition(each))
            case Either(parts):
                return (QuantifiedPart(False, (), tuple(map(self._not, parts))),)
            case Quantified(True, variables, part):
                return (QuantifiedPart(True, variables, self.literals(part)),)
            case Quantified(_, variables, part):
                return (QuantifiedPart(False, variables, self.literals(negated(part))),)

    def literals(self, formula: Formula) -> tuple[Literal | Equality, ...]:
        """The formula as a conjunction of literals."""
        match formula:
            case Literal() | Equality():
                return (formula,)
            case Both(parts):
                return tuple(literal for part in parts for literal in self.literals(part))
            case Either(parts):
                return (self._not(both(map(negated, parts))),)
            case Quantified(False, _, Either()):  # that none is so reads better than that all are otherwise
                return (self._not(negated(formula)),)
            case Quantified():
                return (self.named(formula),)

    def decision(self, formula: Formula, holds: bool, *, plainly: bool) -> Condition:
        """That the formula holds, or that it does not: in literals, or in one literal or quantifier, so that
        the two exclude each other; `plainly` in one literal, so that it takes no thought to see."""
        if isinstance(formula, Both | Either) and all(map(is_basic, formula.parts)):
            return self.condition(formula if holds else negated(formula))
        if isinstance(formula, Either):
            return self.decision(negated(formula), not holds, plainly=plainly)
        if isinstance(formula, Both) or (plainly and isinstance(formula, Quantified)):
            return (self.named(formula) if holds else self._not(formula),)
        return self.condition(formula if holds else negated(formula))

    def is_made(self, part: Literal | Equality | QuantifiedPart) -> bool:
        """Whether a part of a condition asks for a derived predicate."""
        literals = part.condition if isinstance(part, QuantifiedPart) else (part,)
        return any(isinstance(each, Literal) and each.symbol in self._made for each in literals)

    def named(self, formula: Formula) -> Literal:
        """The formula as a predicate of its free variables and of the objects that it names: so it says the
        same of others, and no object of a problem has to be a constant of the domain."""
        terms = _terms(formula)
        key = _canonical(formula, {term: Variable(f"{n}", term.type) for n, term in enumerate(terms)})
        if key not in self._names:
            parameters = _parameters(formula, terms)
            inner = _with_names(formula, parameters)
            said = says(inner)
            short = len(said) <= _LONGEST_NAME
            name = self._symbols.fresh(said if short else f"condition_{len(self._made) + 1}")
            self._names[key] = name
            self._made[name] = DerivedPredicate(name, tuple(parameters.values()), self.condition(inner))
        return literal(self._names[key], terms)

    def _not(self, formula: Formula) -> Literal | Equality:
        """The opposite as one literal."""
        opposite = negated(formula if is_basic(formula) else self.named(formula))
        assert isinstance(opposite, Literal | Equality)
        return opposite


def _terms(formula: Formula) -> tuple[Term, ...]:
    """The free variables of a formula, and then the objects that it names."""
    return (*free_variables(formula), *dict.fromkeys(_objects(formula)))


def _parameters(formula: Formula, terms: tuple[Term, ...]) -> dict[Term, Variable]:
    """The terms as variables: for an object one that is called by its type, since it is to stand for others,
    and that no variable of the formula has the name of."""
    taken = [term for term in _mentioned(formula) if isinstance(term, Variable)]
    found: dict[Term, Variable] = {}
    for term in terms:
        if isinstance(term, Variable):
            found[term] = term
        else:
            found[term] = apart(Variable(term.type, term.type), taken)
            taken.append(found[term])
    return found


def _objects(formula: Formula) -> Iterator[Object]:
    return (term for term in _mentioned(formula) if isinstance(term, Object))


def _mentioned(formula: Formula) -> Iterator[Term]:
    """The terms of a formula, bound ones too."""
    match formula:
        case Literal():
            yield from formula.terms
        case Equality():
            yield from (formula.left, formula.right)
        case Both(parts) | Either(parts):
            for part in parts:
                yield from _mentioned(part)
        case Quantified():
            yield from _mentioned(formula.part)


def _canonical(formula: Formula, names: Mapping[Term, Term]) -> Formula:
    """The formula with names that depend neither on where it stands nor on how its variables are called."""
    match formula:
        case Both(parts):
            return Both(tuple(_canonical(part, names) for part in parts))
        case Either(parts):
            return Either(tuple(_canonical(part, names) for part in parts))
        case Quantified(exists, variables, part):
            own: dict[Term, Variable] = {
                v: Variable(f"{len(names)}_{n}", v.type) for n, v in enumerate(variables)
            }
            return Quantified(exists, tuple(own.values()), _canonical(part, {**names, **own}))
    return _with_names(formula, names)


def _with_names(formula: Formula, names: Mapping[Term, Term]) -> Formula:
    match formula:
        case Literal(symbol, terms, values):
            return Literal(symbol, tuple(names.get(term, term) for term in terms), values)
        case Equality(left, right, equal):
            return Equality(names.get(left, left), names.get(right, right), equal)
        case Both(parts):
            return Both(tuple(_with_names(part, names) for part in parts))
        case Either(parts):
            return Either(tuple(_with_names(part, names) for part in parts))
        case Quantified(exists, variables, part):
            inner = {term: name for term, name in names.items() if term not in variables}
            return Quantified(exists, variables, _with_names(part, inner))


def says(formula: Formula) -> str:
    """The formula in a few words that make a name."""
    match formula:
        case Literal(symbol, _, values):
            return symbol if True in values else f"not_{symbol}"
        case Equality(left, right, equal):
            return f"{left.name}_{'is' if equal else 'is_not'}_{right.name}"
        case Both(parts):
            if all(isinstance(part, Literal) and False in part.values for part in parts):
                return "neither_" + "_nor_".join(says(negated(part)) for part in parts)
            return "_and_".join(map(says, parts))
        case Either(parts):
            return "_or_".join(map(says, parts))
        case Quantified(exists, _, part):
            if exists:
                return f"some_{says(part)}"
            return f"no_{says(negated(part))}" if isinstance(part, Literal) else f"all_{says(part)}"
