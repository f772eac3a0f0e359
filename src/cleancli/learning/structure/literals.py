"""What a context may ask for: literals of known terms, and of one object more that need not be named.

What is listed is positive, or asks for values of a function; what asks for the opposite is its negation.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence

from cleancli.language.model import (
    DerivedPredicate,
    Domain,
    Equality,
    Literal,
    Quantified,
    Symbol,
    Term,
    Value,
    Variable,
)

MOST_TERMS = 3
"""Parameters of a symbol up to which literals of it are looked for; there are too many of others. Chosen."""
MOST_BOUNDS = 12
"""Values of a function that literals compare it with; of more, so many are chosen. Chosen."""


def symbols(domain: Domain) -> tuple[Symbol, ...]:
    """All that a literal may be of; derived predicates look like predicates."""
    return (*domain.symbols, *(Symbol(each.name, each.parameters) for each in domain.derived))


def literals(domain: Domain, known: Sequence[Term], among: Term | None = None) -> Iterator[Literal]:
    """Literals of known terms, which may stand in one literal once each; only those that are about the term
    `among`, where one is named."""
    for symbol in symbols(domain):
        if len(symbol.parameters) > MOST_TERMS:
            continue
        for terms in itertools.permutations(known, len(symbol.parameters)):
            if among is not None and among not in terms:
                continue
            if symbol.symmetric and known.index(terms[0]) > known.index(terms[1]):
                continue
            if fits_types(domain, symbol, terms):
                for values in value_sets(symbol):
                    yield Literal(symbol.name, terms, values)


def fits_types(domain: Domain, symbol: Symbol, terms: Sequence[Term]) -> bool:
    """Whether a symbol can be said of terms: whether they are of its parameters' types, or of types below."""
    return all(domain.is_a(t.type, p.type) for t, p in zip(terms, symbol.parameters, strict=True))


def value_sets(symbol: Symbol) -> Iterator[frozenset[Value]]:
    """The sets of values that literals of a symbol ask for: that a predicate is true; that a function has one
    value, or one up to another."""
    if symbol.is_predicate:
        yield frozenset({True})
        return
    values = symbol.values
    if len(values) > MOST_BOUNDS:
        step = (len(values) - 1) / (MOST_BOUNDS - 1)
        chosen = sorted({round(number * step) for number in range(MOST_BOUNDS)})
    else:
        chosen = list(range(len(values)))
    for number in chosen:
        if number == 0 or len(values) > 2:
            yield frozenset({values[number]})
    for number in chosen:
        if 0 < number < len(values) - 2:
            yield frozenset(values[: number + 1])


def negated(domain: Domain, literal: Literal) -> Literal:
    """The literal that holds where this one does not."""
    symbol = next((each for each in domain.symbols if each.name == literal.symbol), None)
    return literal.opposite(Symbol(literal.symbol, ()) if symbol is None else symbol)


def is_provable(domain: Domain, literal: Literal, inside: bool) -> bool:
    """Whether `check` can tell a literal from its opposite: of a derived predicate if it reads both of them
    as what they are defined by, or neither. `inside`: within a quantifier.

    What would have to exist for every object it leaves unread (language/checking/first_order.py).
    """
    derived = {each.name: each for each in domain.derived}
    holds = True in literal.values
    both = ((holds, False), (not holds, inside))
    return len({_is_read(derived, literal.symbol, *each) for each in both}) == 1


def _is_read(derived: Mapping[str, DerivedPredicate], name: str, holds: bool, in_every: bool) -> bool:
    """Whether all that a symbol is defined by can be read where it holds, or does not."""
    if name not in derived:
        return True
    if derived[name].closure is not None:
        return False
    for part in derived[name].condition:
        if isinstance(part, Literal):
            if not _is_read(derived, part.symbol, holds == (True in part.values), in_every):
                return False
        elif isinstance(part, Quantified):
            asks = part.exists == holds
            inner = (each for each in part.condition if isinstance(each, Literal))
            if (asks and in_every) or not all(
                _is_read(derived, each.symbol, asks == (True in each.values), in_every or not asks)
                for each in inner
            ):
                return False
    return True


def equalities(domain: Domain, known: Sequence[Term], among: Term | None = None) -> Iterator[Equality]:
    """That two known terms are one object, where their types allow it; one of them is no constant."""
    for one, other in itertools.combinations(known, 2):
        if among is not None and among not in (one, other):
            continue
        if (isinstance(one, Variable) or isinstance(other, Variable)) and meet(domain, one.type, other.type):
            yield Equality(one, other, True)


def meet(domain: Domain, one: str, other: str) -> bool:
    """Whether an object may be of both types."""
    return domain.is_a(one, other) or domain.is_a(other, one)
