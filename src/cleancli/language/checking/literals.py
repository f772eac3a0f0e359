"""Whether two conjunctions of literals can hold together (§3.3.2: preconditions must be disjoint).

Guaranteed before: the literals of each condition are well typed. The test is sound and complete, because
objects are not known yet: a problem may add as many of each type as it likes. If conditions hold in any
state, they also hold where only those terms are one object that an equality makes one; every other
coincidence adds constraints and removes none. So one way of identifying terms decides: none are enumerated.

Quantified parts of a condition and the definitions of derived predicates are not looked at here: literals
that cannot hold together decide alone, and where they can, `satisfiable` decides.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from cleancli.language.checking.declarations import Declarations
from cleancli.language.model import (
    Condition,
    Equality,
    Literal,
    Object,
    Quantified,
    Rule,
    Symbol,
    Term,
    Value,
    Variable,
)


@dataclass(frozen=True, slots=True)
class Witness:
    """A state in which conditions hold: terms that are one object, and the values that symbols may have."""

    equal: tuple[tuple[Term, Term], ...]
    allowed: tuple[Literal, ...]


_Allowed = dict[tuple[str, tuple[Term, ...]], frozenset[Value]]
"""The values that each fluent may have."""


def witness(conditions: Iterable[Condition], declared: Declarations) -> Witness | None:
    """A state in which the literals of all conditions (over the same variables) hold, None if none is."""
    found = _found(conditions, declared)
    if found is None:
        return None
    stands, allowed = found
    literals = tuple(Literal(*fluent, values) for fluent, values in allowed.items())
    return Witness(tuple((one, leader) for one, leader in stands.items() if one != leader), literals)


def can_hold(conditions: Iterable[Condition], declared: Declarations) -> bool:
    """Whether there is a state in which the literals of all conditions (over the same variables) hold."""
    return _found(conditions, declared) is not None


def _found(
    conditions: Iterable[Condition], declared: Declarations
) -> tuple[Mapping[Term, Term], _Allowed] | None:
    """The terms that are one object, with the one that stands for them, and the values of each fluent."""
    parts = [part for condition in conditions for part in condition]
    equalities = [part for part in parts if isinstance(part, Equality)]
    stands = leaders(equalities)
    if not _can_stand(stands, equalities, declared):
        return None
    allowed = _allowed([part for part in parts if isinstance(part, Literal)], stands, declared)
    return (stands, allowed) if all(allowed.values()) else None


def _can_stand(stands: Mapping[Term, Term], equalities: Iterable[Equality], declared: Declarations) -> bool:
    """Whether the terms of each class can be one object, and no class holds two that are to differ."""
    if not all(_can_be_one(one, leader, stands, declared) for one, leader in stands.items()):
        return False
    return all(e.equal or _leader(e.left, stands) != _leader(e.right, stands) for e in equalities)


def _allowed(literals: Iterable[Literal], stands: Mapping[Term, Term], declared: Declarations) -> _Allowed:
    """The values that all literals of a fluent allow; terms that are one object have their leader's name."""
    allowed: _Allowed = {}
    for literal in literals:
        terms = tuple([_leader(term, stands) for term in literal.terms]) if stands else literal.terms
        fluent = literal.symbol, canonical(declared.symbols[literal.symbol], terms)
        allowed[fluent] = allowed.get(fluent, literal.values) & literal.values
    return allowed


def canonical(symbol: Symbol, terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """The terms in one order where the symbol is symmetric."""
    return tuple(sorted(terms, key=lambda t: (isinstance(t, Object), t.name))) if symbol.symmetric else terms


def _leader(term: Term, leaders: Mapping[Term, Term]) -> Term:
    return leaders.get(term, term)


def leaders(equalities: Iterable[Equality]) -> dict[Term, Term]:
    """Each term of an equality with the term that stands for its class: an object if there is one."""
    found: dict[Term, Term] = {}
    for equality in equalities:
        if not equality.equal:
            continue
        left, right = _leader(equality.left, found), _leader(equality.right, found)
        kept, gone = (right, left) if isinstance(right, Object) else (left, right)
        found |= {equality.left: left, equality.right: right}
        found = {term: kept if leader == gone else leader for term, leader in found.items()}
    return found


def _can_be_one(one: Term, leader: Term, leaders: Mapping[Term, Term], declared: Declarations) -> bool:
    for other, its_leader in leaders.items():
        if its_leader != leader or other == one:
            continue
        if isinstance(one, Object) and isinstance(other, Object):
            return False
        meet = declared.meet(one.type, other.type)
        if meet is None or (isinstance(one, Object) and not declared.is_a(one.type, other.type)):
            return False
    return True


def renamed(rule: Rule, variables: tuple[Variable, ...]) -> Condition:
    """The literals of the rule's condition over other names of its action's parameters."""
    literals = tuple([part for part in rule.condition if not isinstance(part, Quantified)])
    if rule.variables == variables:
        return literals
    names: dict[Term, Term] = dict(zip(rule.variables, variables, strict=True))
    return tuple([with_terms(part, names) for part in literals])


def with_terms(part: Literal | Equality, names: Mapping[Term, Term]) -> Literal | Equality:
    """The literal with other terms in place of some."""
    if isinstance(part, Literal):
        terms = tuple([names.get(term, term) for term in part.terms])
        return Literal(part.symbol, terms, part.values, part.relation)
    return Equality(names.get(part.left, part.left), names.get(part.right, part.right), part.equal)


def separating(one: Condition, other: Condition, declared: Declarations) -> Literal | Equality | None:
    """A part of `one` whose opposite, added to `other`, would tell the two apart; None if there is none."""
    for part in one:
        if isinstance(part, Quantified):
            continue
        opposite = negated(part, declared)
        if can_hold([other, (opposite,)], declared):
            return part
    return None


def negated(part: Literal | Equality, declared: Declarations) -> Literal | Equality:
    """The opposite of a literal."""
    if isinstance(part, Equality):
        return Equality(part.left, part.right, not part.equal)
    return part.opposite(declared.symbols[part.symbol])
