"""The changeable part of a rule's condition as conjunctions of literals, before objects are known.

A derived predicate that is itself a conjunction of literals is written out; where it must not hold, in cases
that exclude each other: the first literal fails, or it holds and the second one fails, and so on.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from cleancli.compiler.static_join import Part, Universe
from cleancli.language.model import Literal, Rule, Term

MOST = 16
"""Conjunctions of a rule; one with more is grounded instance by instance, where cases of the same objects are
found together. Chosen: two negated predicates of four literals."""

Conjunction = tuple[Literal, ...]


def conjunctions(rule: Rule, universe: Universe) -> tuple[Conjunction, ...] | None:
    """Conjunctions that exclude each other, one of which holds where the changeable part of the condition
    does; None where it has parts that are no such thing, or more than `MOST` conjunctions."""
    found: list[Conjunction] = [()]
    for part in rule.condition:
        if universe.is_static(part):
            continue
        cases = _cases(part, universe)
        if cases is None or len(found) * len(cases) > MOST:
            return None
        found = [(*before, *case) for before, case in itertools.product(found, cases)]
    return tuple(found)


def _cases(part: Part, universe: Universe) -> list[Conjunction] | None:
    """The same of one part."""
    if not isinstance(part, Literal):
        return None
    if part.symbol not in universe.derived:
        return [(part,)]
    literals = _definition(part, universe)
    if literals is None:
        return None
    return [tuple(literals)] if part.values == {True} else list(_failing(literals, universe))


def _definition(literal: Literal, universe: Universe) -> list[Literal] | None:
    """The changeable literals that a derived predicate stands for; None where it is no such conjunction."""
    derived = universe.derived[literal.symbol]
    if derived.closure is not None:
        return None
    stands_for: dict[Term, Term] = dict(zip(derived.parameters, literal.terms, strict=True))
    found = []
    for part in derived.condition:
        if not isinstance(part, Literal) or part.symbol in universe.derived or universe.is_static(part):
            return None
        terms = tuple([stands_for.get(term, term) for term in part.terms])
        found.append(Literal(part.symbol, terms, part.values))
    return found


def _failing(literals: Sequence[Literal], universe: Universe) -> Iterator[Conjunction]:
    """Where one of them does not hold, by the first that does not."""
    for place, literal in enumerate(literals):
        others = frozenset(universe.symbols[literal.symbol].values) - literal.values
        yield (*literals[:place], Literal(literal.symbol, literal.terms, others))
