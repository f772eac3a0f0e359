"""Conditions of a .nid domain as formulas over predicates that are true or false.

A function becomes a predicate for each of its values, of which one holds; a derived predicate is replaced by
what it says; that a deictic reference has exactly one binding is said in full (docs/language.md). The closure
of a predicate stays a symbol, since no formula of first-order logic says it for any number of objects; for a
few objects there is one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

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
    quantified,
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

    `closures` has those that formulas have spoken of until now. `counts` tells for each problem how many
    objects it has of each type: the closure of what changes is written out where these are not too many
    (`written_out` tells whether one was).
    """

    def __init__(
        self, domain: Domain, predicates: Predicates, counts: Sequence[Mapping[str, int]] = ()
    ) -> None:
        self.domain = domain
        self.predicates = predicates
        self.symbols = {symbol.name: symbol for symbol in domain.symbols}
        self.changed = changed_by(domain.rules)
        self.written_out = False
        self.closures: dict[str, DerivedPredicate] = {}
        self._derived = {each.name: each for each in domain.derived}
        self._is_counted = bool(counts)
        self._most = {
            kind.name: max((each[kind.name] for each in counts), default=0) for kind in domain.types
        }
        held = {
            kind.name
            for kind in domain.types
            if any(domain.is_a(o.type, kind.name) for o in domain.constants)
        }
        everywhere = {
            kind.name for kind in domain.types if counts and all(each[kind.name] for each in counts)
        }
        self._inhabited = held | everywhere
        self._said: dict[str, Formula] = {}

    def moves(self, derived: DerivedPredicate) -> bool:
        """Whether a derived predicate follows from what outcomes change."""
        return not self.changed.isdisjoint(self._rests_on(derived.name))

    def moving_closure(self, predicate: str, changed: Collection[str]) -> bool:
        """Whether a predicate is a closure that follows from one of those that are `changed`."""
        for derived in self.closures.values():
            if self.predicates.of(derived.name) == predicate:
                return not self._predicates(self._rests_on(derived.name)).isdisjoint(changed)
        return False

    def _predicates(self, symbols: Iterable[str]) -> frozenset[str]:
        """The predicates of symbols and of all their values."""
        found: set[str] = set()
        for symbol in (self.symbols[name] for name in symbols):
            values = (None,) if symbol.is_predicate else symbol.values
            found.update(self.predicates.of(symbol.name, value) for value in values)
        return frozenset(found)

    def _rests_on(self, name: str) -> frozenset[str]:
        """The declared symbols that a predicate is, or follows from."""
        if name in self.symbols:
            return frozenset({name})
        derived = self._derived[name]
        asked = [derived.closure] if derived.closure is not None else list(_symbols_of(derived.condition))
        return frozenset().union(*map(self._rests_on, asked))

    def may_be_one(self, one: Term, other: Term) -> bool:
        """Whether the types of two terms allow that they are one object."""
        is_a = self.domain.is_a
        return (isinstance(other, Variable) and is_a(one.type, other.type)) or (
            isinstance(one, Variable) and is_a(other.type, one.type)
        )

    def some(self, variables: Sequence[Variable], part: Formula) -> Formula:
        """That some binding of the variables satisfies a formula.

        Where it says nothing of one of them all that matters is whether there are objects of its type. Raises
        `NotSaid` where that is not known.
        """
        if part == NEVER:
            return NEVER
        said = free_variables(part)
        for silent in (variable for variable in variables if variable not in said):
            if silent.type not in self._inhabited:
                raise NotSaid(f"`?{silent.name}` stands for any `{silent.type}`, and nothing is said of it")
        return quantified(True, variables, part)

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

    def apart(self, formula: Formula, scope: Iterable[Variable]) -> Formula:
        """The formula, no quantifier of which binds a variable of the scope anew."""
        return self.renamed(formula, {variable: variable for variable in scope})

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
                found = self.some(variables, self.condition(condition))
                return found if exists else negated(found)

    def _derivation(self, derived: DerivedPredicate, terms: tuple[Term, ...]) -> Formula:
        if derived.closure is not None:
            steps = self._most[derived.parameters[0].type]
            if self._is_counted and steps <= MOST_STEPS and not self.has_facts(derived):
                self.written_out = True
                return self._path(derived, terms, max(steps, 1))  # of no object any formula says the same
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

    def has_facts(self, closure: DerivedPredicate) -> bool:
        """Whether a problem has the facts of a closure: it is of a declared predicate that never changes."""
        return closure.closure in self.symbols and closure.closure not in self.changed

    def forget_moving(self) -> list[str]:
        """Takes those closures out that formulas have spoken of and that no problem has facts of; what each
        is."""
        found = [name for name, closure in self.closures.items() if not self.has_facts(closure)]
        for name in found:
            del self.closures[name]
        return [f"the closure `{name}` of more than a few objects" for name in found]

    def step(self, closure: DerivedPredicate, first: Term, last: Term) -> Formula:
        """That one step leads from a term to another."""
        assert closure.closure is not None
        return self._part(Literal(closure.closure, (first, last), frozenset({True})))

    def _path(self, derived: DerivedPredicate, ends: tuple[Term, ...], steps: int) -> Formula:
        """That up to so many steps of a predicate, or a few more, lead from the first term to the second."""
        if steps == 1:
            return self.step(derived, *ends)
        half = (steps + 1) // 2
        middle = apart(Variable("via", derived.parameters[0].type), ends)
        first, last = ends
        parts = [self._path(derived, pair, half) for pair in ((first, middle), (middle, last))]
        return either([self._path(derived, ends, half), self.some([middle], both(parts))])

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
        return self.some(first.variables, both([fits, alone, self._referred(later)]))


def changed_by(rules: Iterable[Rule]) -> frozenset[str]:
    """The symbols that outcomes of rules set or shift."""
    found: set[str] = set()
    for rule in rules:
        for outcome in rule.outcomes:
            for effect in outcome.effects:
                inner = effect.effects if isinstance(effect, ForAll) else (effect,)
                found.update(each.symbol for each in inner)
    return frozenset(found)


def _symbols_of(condition: Condition) -> Iterator[str]:
    """The symbols that a condition speaks of."""
    for part in condition:
        for inner in part.condition if isinstance(part, QuantifiedPart) else (part,):
            if isinstance(inner, Literal):
                yield inner.symbol


def _size(formula: Formula) -> int:
    match formula:
        case Both(parts) | Either(parts):
            return 1 + sum(map(_size, parts))
        case Quantified():
            return 1 + _size(formula.part)
    return 1
