"""What an outcome does, in a form that is equal for outcomes that do the same wherever their rule applies,
and which of its effects change nothing there.

Guaranteed before: effects are well typed. Equal forms mean the same; the reverse is not promised, because
what conditions imply is not worked out. Names of bound variables, the order of parts and of symmetric terms,
one `forall` or several, and effects that set what the rule's condition says already make no difference.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations, product
from math import factorial, prod

from cleancli.language.checking.declarations import Declarations
from cleancli.language.checking.literals import leaders
from cleancli.language.model import (
    Assign,
    Condition,
    Equality,
    ForAll,
    Literal,
    Outcome,
    OutcomeKind,
    Shift,
    Symbol,
    Term,
    Value,
    Variable,
)

_MOST_ORDERS = 1_000
"""Orders of a `forall`'s variables that are tried; with more variables it is compared as it stands."""

_Terms = tuple[tuple[str, str], ...]
"""Bound variables by their place in an order, others by their name; always marked with which it is."""

_Part = tuple[str, _Terms, tuple[str, ...]]
"""A literal: symbol, terms and values. An equality: `=` or `!=`, and its terms in one order."""

_Place = tuple[str, _Terms]
_Guard = tuple[tuple[str, ...], tuple[_Part, ...]]
"""The types of a `forall`'s variables in an order, and its condition; both empty for a plain effect."""

_PLAIN: _Guard = ((), ())
_Assigned = tuple[_Guard, _Place, Value]
_Shifted = tuple[_Guard, _Place, int]


@dataclass(frozen=True, slots=True)
class Asked:
    """What a rule's condition says for sure: terms that are one object, and the values that facts may have.

    `idle`: whether effects are left out that set what is there anyway.
    """

    same: Mapping[Term, Term]
    values: Mapping[_Place, frozenset[Value]]
    idle: bool = True


def asked_by(condition: Condition, declared: Declarations) -> Asked:
    """What the literals and equalities of a condition say."""
    same = leaders([part for part in condition if isinstance(part, Equality)])
    literals = [part for part in condition if isinstance(part, Literal)]
    return Asked(same, _allowed(literals, {}, same, declared))


@dataclass(frozen=True, slots=True)
class _Done:
    """What the effects of an outcome come to: values that are set, and sums of shifts."""

    assigned: frozenset[_Assigned]
    shifted: frozenset[_Shifted]

    def sets(self, symbol: str) -> bool:
        return any(place[0] == symbol for _, place, _ in self.assigned)


def doing(outcome: Outcome, asked: Asked, declared: Declarations) -> object:
    """What the outcome does. Equal for two outcomes only if no observation could tell them apart."""
    if outcome.kind is OutcomeKind.NOISE:
        return OutcomeKind.NOISE
    done = _done(outcome, asked, declared)
    if not asked.idle:
        return done.assigned, done.shifted
    return (
        frozenset(each for each in done.assigned if not _is_idle(each, done, asked)),
        frozenset(each for each in done.shifted if not _stays(each, done, asked, declared)),
    )


def idle_because(outcome: Outcome, asked: Asked, declared: Declarations) -> tuple[Literal | None, ...]:
    """For each effect what the rule's condition says, if that is why the effect changes nothing; else None.

    Effects of a `forall` are not looked at.
    """
    said = [_said_of(effect, asked, declared) for effect in outcome.effects]
    if not any(said):  # as of most outcomes: what they come to needs no look
        return (None,) * len(said)
    done = _done(outcome, asked, declared)
    return tuple(
        None
        if literal is None or isinstance(effect, ForAll) or not _leaves(effect, done, asked, declared)
        else literal
        for effect, literal in zip(outcome.effects, said, strict=True)
    )


def _said_of(effect: Assign | Shift | ForAll, asked: Asked, declared: Declarations) -> Literal | None:
    """What the rule's condition says that a plain effect could leave as it is, None where nothing."""
    if isinstance(effect, ForAll):
        return None
    known = asked.values.get(_place(effect.symbol, effect.terms, {}, asked.same, declared.symbols))
    if known is None or (isinstance(effect, Assign) and known != {effect.value}):
        return None
    return Literal(effect.symbol, effect.terms, known)


def _leaves(effect: Assign | Shift, done: _Done, asked: Asked, declared: Declarations) -> bool:
    """Whether a plain effect leaves what it is on as the rule's condition says that it is."""
    place = _place(effect.symbol, effect.terms, {}, asked.same, declared.symbols)
    if isinstance(effect, Assign):
        return _is_idle((_PLAIN, place, effect.value), done, asked)
    sums = [each for each in done.shifted if each[:2] == (_PLAIN, place)]
    return any(_stays(each, done, asked, declared) for each in sums)


def _done(outcome: Outcome, asked: Asked, declared: Declarations) -> _Done:
    assigned: set[_Assigned] = set()
    amounts: dict[tuple[_Guard, _Place], int] = {}
    for effect, forall in _each(outcome):
        found = _normal(effect, forall, asked, declared)
        if found is None:
            continue
        if isinstance(effect, Shift):
            amounts[found] = amounts.get(found, 0) + effect.amount
        else:
            assigned.add((*found, effect.value))
    set_too = {place[0] for _, place, _ in assigned}
    shifted = {(*key, amount) for key, amount in amounts.items() if amount or key[1][0] in set_too}
    return _Done(frozenset(assigned), frozenset(shifted))


def _each(outcome: Outcome) -> Iterator[tuple[Assign | Shift, ForAll | None]]:
    for effect in outcome.effects:
        if isinstance(effect, ForAll):
            yield from ((inner, effect) for inner in effect.effects)
        else:
            yield effect, None


# ---- effects that change nothing


def _is_idle(each: _Assigned, done: _Done, asked: Asked) -> bool:
    """Whether what is set is there already, as the rule's condition or the `forall`'s says, and no other
    effect may be on the same thing: leaving this one out would end a conflict with that."""
    guard, place, value = each
    known = asked.values.get(place)
    if known is not None:
        there = known == {value}
    else:
        there = bool(guard[1]) and (*place, _shown(frozenset({value}))) in guard[1]
    return (
        there
        and not any(other[0] == place[0] and set_to != value for _, other, set_to in done.assigned)
        and not any(other[0] == place[0] for _, other, _ in done.shifted)
    )


def _stays(each: _Shifted, done: _Done, asked: Asked, declared: Declarations) -> bool:
    """Whether a shift leads beyond the bound at which the rule's condition finds the number."""
    _, place, amount = each
    values = declared.symbols[place[0]].values
    bound = values[-1] if amount > 0 else values[0]
    opposed = any(other[0] == place[0] and (by > 0) != (amount > 0) for _, other, by in done.shifted)
    at_bound = asked.values.get(place) == frozenset({bound})
    return at_bound and not opposed and not done.sets(place[0])


# ---- one effect


def _normal(
    effect: Assign | Shift, forall: ForAll | None, asked: Asked, declared: Declarations
) -> tuple[_Guard, _Place] | None:
    """Under which guard the effect is on what; None where the guard can't hold."""
    if forall is None:
        return _PLAIN, _place(effect.symbol, effect.terms, {}, asked.same, declared.symbols)
    same = {term: leader for term, leader in asked.same.items() if term not in forall.variables}
    forms = []
    for order in _orders(forall.variables):
        numbers: dict[Term, int] = {variable: number for number, variable in enumerate(order)}
        parts = _parts(forall.condition, numbers, same, asked, declared)
        if parts is None:
            return None
        place = _place(effect.symbol, effect.terms, numbers, same, declared.symbols)
        forms.append(((tuple(variable.type for variable in order), parts), place))
    return min(forms)


def _orders(variables: tuple[Variable, ...]) -> Iterator[tuple[Variable, ...]]:
    """The orders that differ only among variables of one type."""
    groups = [[v for v in variables if v.type == kind] for kind in sorted({v.type for v in variables})]
    if prod(factorial(len(group)) for group in groups) > _MOST_ORDERS:
        yield variables
        return
    for chosen in product(*(permutations(group) for group in groups)):
        yield tuple(variable for group in chosen for variable in group)


def _parts(
    condition: tuple[Literal | Equality, ...],
    numbers: Mapping[Term, int],
    same: Mapping[Term, Term],
    asked: Asked,
    declared: Declarations,
) -> tuple[_Part, ...] | None:
    """The condition in one order, without what the rule's condition says already; None if it can't hold."""
    equalities = _equalities([part for part in condition if isinstance(part, Equality)], numbers, same)
    literals = [part for part in condition if isinstance(part, Literal)]
    allowed = _allowed(literals, numbers, same, declared)
    if equalities is None or any(
        not values & asked.values.get(place, values) for place, values in allowed.items()
    ):
        return None
    unsaid = [
        (*place, _shown(values))
        for place, values in allowed.items()
        if not _is_said(place, values, asked, declared)
    ]
    return tuple(sorted((*unsaid, *equalities)))


def _equalities(
    equalities: Sequence[Equality], numbers: Mapping[Term, int], same: Mapping[Term, Term]
) -> set[_Part] | None:
    """Those that do not hold by themselves; None if they can't hold together."""
    found: dict[bool, set[_Terms]] = {True: set(), False: set()}
    for each in equalities:
        found[each.equal].add(tuple(sorted(_named((each.left, each.right), numbers, same))))
    if found[True] & found[False] or any(left == right for left, right in found[False]):
        return None
    equal: set[_Part] = {("=", terms, ()) for terms in found[True] if terms[0] != terms[1]}
    return equal | {("!=", terms, ()) for terms in found[False]}


def _allowed(
    literals: Iterable[Literal],
    numbers: Mapping[Term, int],
    same: Mapping[Term, Term],
    declared: Declarations,
) -> dict[_Place, frozenset[Value]]:
    """The values that all literals about a place allow."""
    allowed: dict[_Place, frozenset[Value]] = {}
    for literal in literals:
        place = _place(literal.symbol, literal.terms, numbers, same, declared.symbols)
        allowed[place] = allowed.get(place, literal.values) & literal.values
    return allowed


def _is_said(place: _Place, values: frozenset[Value], asked: Asked, declared: Declarations) -> bool:
    """Whether the rule's condition leaves a place none but these values; none but all are left of a bound
    variable's."""
    return asked.values.get(place, frozenset(declared.symbols[place[0]].values)) <= values


def _place(
    symbol: str,
    terms: tuple[Term, ...],
    numbers: Mapping[Term, int],
    same: Mapping[Term, Term],
    symbols: Mapping[str, Symbol],
) -> _Place:
    named = _named(terms, numbers, same)
    return symbol, tuple(sorted(named)) if symbols[symbol].symmetric else named


def _named(terms: tuple[Term, ...], numbers: Mapping[Term, int], same: Mapping[Term, Term]) -> _Terms:
    return tuple([_name(term, numbers, same) for term in terms])


def _name(term: Term, numbers: Mapping[Term, int], same: Mapping[Term, Term]) -> tuple[str, str]:
    if numbers and term in numbers:
        return "bound", f"{numbers[term]:03}"
    stands = same.get(term, term) if same else term  # mostly there are none, and a term takes long to hash
    return "variable" if isinstance(stands, Variable) else "object", stands.name


def _shown(values: frozenset[Value]) -> tuple[str, ...]:
    return tuple(sorted(map(repr, values)))
