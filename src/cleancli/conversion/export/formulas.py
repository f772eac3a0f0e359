"""Conditions of a .nid domain as formulas over predicates that are true or false.

A function becomes a predicate for each of its values, of which one holds; a derived predicate is replaced by
what it says; that a deictic reference has exactly one binding is said in full (docs/language.md). The closure
of a predicate stays a symbol, since no formula of first-order logic says it for any number of objects; for a
few objects there is one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from cleancli.conversion.export.names import Predicates
from cleancli.conversion.pddl.formula import (
    NEVER,
    Both,
    Either,
    Formula,
    Quantified,
    apart,
    both,
    either,
    equality,
    free_variables,
    literal,
    negated,
    substituted,
)
from cleancli.language.model import (
    Condition,
    DerivedPredicate,
    Domain,
    Equality,
    ForAll,
    Literal,
    Reference,
    Rule,
    Term,
    Value,
    Variable,
)
from cleancli.language.model import Quantified as QuantifiedPart

MOST_STEPS = 16
"""Objects up to which a closure is written out: the formula then has 81 literals. Chosen."""

LARGEST = 20_000
"""Parts that a formula may have when derived predicates are replaced. Chosen: far more than people read."""


class NotSaid(Exception):
    """Something has no form in the other language; the text says what it is."""


class Formulas:
    """Makes formulas of the conditions of one domain. Raises `NotSaid`.

    `closures` has those that formulas have spoken of until now. The closure of what changes is written out
    where there are objects of its type, `steps` of them, and not too many;
    `written_out` tells whether one was.
    """

    def __init__(self, domain: Domain, predicates: Predicates, steps: Mapping[str, int]) -> None:
        self.domain = domain
        self.predicates = predicates
        self.symbols = {symbol.name: symbol for symbol in domain.symbols}
        self.changed = changed_by(domain.rules)
        self.written_out = False
        self.closures: dict[str, DerivedPredicate] = {}
        self._derived = {each.name: each for each in domain.derived}
        self._steps = steps
        self._said: dict[str, Formula] = {}
        self._closures = {
            predicates.of(each.name): predicates.of(each.closure)
            for each in domain.derived
            if each.closure in self.changed
        }

    def may_be_one(self, one: Term, other: Term) -> bool:
        """Whether the types of two terms allow that they are one object."""
        is_a = self.domain.is_a
        return (isinstance(other, Variable) and is_a(one.type, other.type)) or (
            isinstance(one, Variable) and is_a(other.type, one.type)
        )

    def closure_of(self, predicate: str) -> str | None:
        """The predicate whose closure this one is; None for what is no closure, or is one of what never
        changes."""
        return self._closures.get(predicate)

    def condition(self, condition: Condition) -> Formula:
        """The formula of a conjunction."""
        return both(self._part(part) for part in condition)

    def applies(self, rule: Rule) -> Formula:
        """Where a rule applies: its condition holds, and each reference has exactly one binding."""
        return both([self.condition(rule.condition), self._referred(rule.references)])

    def equal(self, one: Term, other: Term) -> Formula:
        """That two terms are one object."""
        return equality(one, other, self.may_be_one)

    def renamed(self, formula: Formula, terms: Mapping[Term, Term]) -> Formula:
        """The formula with other terms in place of some."""
        return substituted(formula, terms, self.may_be_one)

    def has_value(self, symbol: str, terms: tuple[Term, ...], values: Collection[Value]) -> Formula:
        """That a symbol's value is one of these; said by those that it is not where they are fewer."""
        declared = self.symbols[symbol]
        if declared.is_predicate:
            return literal(self.predicates.of(symbol), terms, True in values)
        others = [value for value in declared.values if value not in values]
        named = [value for value in declared.values if value in values]
        if len(others) < len(named):
            return both(literal(self.predicates.of(symbol, value), terms, False) for value in others)
        return either(literal(self.predicates.of(symbol, value), terms) for value in named)

    def _part(self, part: Literal | Equality | QuantifiedPart) -> Formula:
        match part:
            case Literal(symbol, terms, values) if symbol in self._derived:
                said = self._derivation(self._derived[symbol], terms)
                return said if True in values else negated(said)
            case Literal(symbol, terms, values):
                return self.has_value(symbol, terms, values)
            case Equality(left, right, equal):
                same = self.equal(left, right)
                return same if equal else negated(same)
            case QuantifiedPart(exists, variables, condition):
                found = some(variables, self.condition(condition))
                return found if exists else negated(found)

    def _derivation(self, derived: DerivedPredicate, terms: tuple[Term, ...]) -> Formula:
        if derived.closure is not None:
            steps = self._steps.get(derived.name, 0) if derived.closure in self.changed else 0
            if 0 < steps <= MOST_STEPS:
                self.written_out = True
                return self._path(derived, terms, steps)
            self.closures[derived.name] = derived
            return literal(self.predicates.of(derived.name), terms)
        if derived.name not in self._said:
            said = self.condition(derived.condition)
            if _size(said) > LARGEST:
                raise NotSaid(
                    f"a condition has more than {LARGEST} parts when derived predicates are written out"
                )
            self._said[derived.name] = said
        stands: dict[Term, Term] = dict(zip(derived.parameters, terms, strict=True))
        return self.renamed(self._said[derived.name], stands)

    def _path(self, derived: DerivedPredicate, ends: tuple[Term, ...], steps: int) -> Formula:
        """That up to so many steps of a predicate, or a few more, lead from the first term to the second."""
        assert derived.closure is not None
        if steps == 1:
            return self.has_value(derived.closure, ends, {True})
        half = (steps + 1) // 2
        middle = apart(Variable("via", derived.parameters[0].type), ends)
        first, last = ends
        parts = [self._path(derived, pair, half) for pair in ((first, middle), (middle, last))]
        return either([self._path(derived, ends, half), some([middle], both(parts))])

    def _referred(self, references: Sequence[Reference]) -> Formula:
        """That the first reference has one binding, and with it the next has one, and so on."""
        if not references:
            return both([])
        first, *later = references
        fits = self.condition(first.condition)
        met = [variable for reference in references for variable in reference.variables]
        others: dict[Term, Term] = {}
        for variable in first.variables:
            others[variable] = apart(variable, met)
            met += [each for each in (others[variable],) if isinstance(each, Variable)]
        bound = tuple(each for each in others.values() if isinstance(each, Variable))
        same = both(self.equal(one, other) for one, other in others.items())
        alone = Quantified(False, bound, either([negated(self.renamed(fits, others)), same]))
        return some(first.variables, both([fits, alone, self._referred(later)]))


def some(variables: Sequence[Variable], part: Formula) -> Formula:
    """That some binding of the variables satisfies a formula.

    Raises `NotSaid` where it says nothing of one of them: then all that matters is whether there are objects
    of its type, which would be lost when formulas are simplified.
    """
    if part == NEVER or not variables:
        return part
    silent = next((variable for variable in variables if variable not in free_variables(part)), None)
    if silent is not None:
        raise NotSaid(f"`?{silent.name}` stands for any `{silent.type}`, and nothing is said of it")
    return Quantified(True, tuple(variables), part)


def changed_by(rules: Iterable[Rule]) -> frozenset[str]:
    """The symbols that outcomes of rules set or shift."""
    found: set[str] = set()
    for rule in rules:
        for outcome in rule.outcomes:
            for effect in outcome.effects:
                inner = effect.effects if isinstance(effect, ForAll) else (effect,)
                found.update(each.symbol for each in inner)
    return frozenset(found)


def _size(formula: Formula) -> int:
    match formula:
        case Both(parts) | Either(parts):
            return 1 + sum(map(_size, parts))
        case Quantified():
            return 1 + _size(formula.part)
    return 1
