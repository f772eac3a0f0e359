"""What an outcome does, as changes of predicates that are true or false.

An assignment of a function makes the predicate of one value true and those of its others false. A shift is a
change for each value, made where the function has that value before. Shifts of one number add up
(docs/language.md, Outcomes), so where several may be of one thing there are changes for each way in which
they can meet.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from cleancli.conversion.export.formulas import Formulas, NotSaid
from cleancli.conversion.pddl.effect_trees import (
    Change,
)
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Both,
    Formula,
    apart,
    assuming,
    both,
    free_variables,
    literal,
    negated,
    quantified,
)
from cleancli.language.model import (
    Assign,
    ForAll,
    Outcome,
    OutcomeKind,
    Reference,
    Rule,
    Shift,
    Symbol,
    Term,
    Value,
    Variable,
)

MOST_SHIFTS = 4
"""Shifts of one number, of which any may be of one thing, that one outcome may have. Chosen: there are
changes for each of their subsets."""


@dataclass(frozen=True, slots=True)
class _Made:
    """An effect on one symbol, for each binding of variables that a guard holds for; `once` tells that no two
    bindings are of one thing."""

    variables: tuple[Variable, ...]
    guard: Formula
    effect: Assign | Shift
    once: bool


def changes_of(
    outcome: Outcome, rule: Rule, known: Formula, formulas: Formulas, noise: str | None
) -> tuple[Change, ...]:
    """The changes of an outcome of a rule where `known` holds; `noise` is the predicate that noise makes
    true, if any.

    Raises `NotSaid`.
    """
    if outcome.kind is OutcomeKind.NOISE and noise is not None:
        return (Change((), ALWAYS, noise, (), True),)
    shifts: dict[str, list[_Made]] = {}
    found: list[Change] = []
    for made in _made(outcome, rule, formulas):
        effect = made.effect
        if isinstance(effect, Shift):
            shifts.setdefault(effect.symbol, []).append(made)
        else:
            found += _assigned(made, effect, known, formulas)
    for name, several in shifts.items():
        found += _shifted(formulas.symbols[name], several, formulas)
    told = [(change, assuming(change.guard, [known])) for change in found]
    return tuple(
        Change(each.variables, guard, each.symbol, each.terms, each.value)
        for each, guard in told
        if guard != NEVER
    )


def _made(outcome: Outcome, rule: Rule, formulas: Formulas) -> Iterator[_Made]:
    """The effects, each below what binds its variables."""
    scope = [*rule.variables, *(v for reference in rule.references for v in reference.variables)]
    for effect in outcome.effects:
        inner = effect.effects if isinstance(effect, ForAll) else (effect,)
        names: dict[Term, Term] = {}
        asked: Formula = ALWAYS
        if isinstance(effect, ForAll):
            for variable in effect.variables:
                names[variable] = apart(variable, [*scope, *names.values()])
            asked = formulas.renamed(formulas.condition(effect.condition), names)
        own = tuple(each for each in names.values() if isinstance(each, Variable))
        for each in inner:
            terms = tuple(names.get(term, term) for term in each.terms)
            used = [*(t for t in terms if isinstance(t, Variable)), *free_variables(asked)]
            bound, guard = referred(used, rule.references, formulas)
            once = set(own) <= set(terms)
            yield _Made((*bound, *own), both([guard, asked]), replace(each, terms=terms), once)


def referred(
    used: Sequence[Variable], references: Sequence[Reference], formulas: Formulas
) -> tuple[tuple[Variable, ...], Formula]:
    """The variables of the references that some variables are of, directly or by others, and what binds
    them."""
    bound: tuple[Variable, ...] = ()
    guard: Formula = ALWAYS
    wanted = set(used)
    for reference in reversed(references):
        if wanted.intersection(reference.variables):
            fits = formulas.condition(reference.condition)
            bound, guard = (*reference.variables, *bound), both([fits, guard])
            wanted.update(free_variables(fits))
    return bound, guard


def _change(made: _Made, guard: Formula, symbol: str, value: bool, formulas: Formulas) -> Change:
    """The change of a predicate by an effect; variables that its terms do not have are asked for."""
    terms = made.effect.terms
    bound = tuple(variable for variable in made.variables if variable in terms)
    others = [variable for variable in made.variables if variable not in terms]
    return Change(bound, formulas.some(others, guard), symbol, terms, value)


def _assigned(made: _Made, effect: Assign, known: Formula, formulas: Formulas) -> Iterator[Change]:
    symbol, name = formulas.symbols[effect.symbol], formulas.predicates.of
    if not symbol.is_predicate:
        yield _change(made, made.guard, name(symbol.name, effect.value), True, formulas)
        for value in _before(symbol, effect, known, formulas):
            if value != effect.value:
                yield _change(made, made.guard, name(symbol.name, value), False, formulas)
        return
    change = _change(made, made.guard, name(symbol.name), effect.value is True, formulas)
    yield change
    if symbol.symmetric and len(set(change.terms)) > 1:
        yield Change(change.variables, change.guard, change.symbol, change.terms[::-1], change.value)


def _before(symbol: Symbol, effect: Assign, known: Formula, formulas: Formulas) -> tuple[Value, ...]:
    """The values that a function may have before: one, where that is known."""
    parts = known.parts if isinstance(known, Both) else (known,)
    asked = {v: literal(formulas.predicates.of(symbol.name, v), effect.terms) for v in symbol.values}
    return next(((value,) for value, said in asked.items() if said in parts), symbol.values)


# ---- shifts


def _shifted(symbol: Symbol, several: Sequence[_Made], formulas: Formulas) -> Iterator[Change]:
    """The changes of all shifts of one function together."""
    if not all(made.once for made in several):
        raise NotSaid(f"`{symbol.name}` is shifted by as much as there are objects that something holds of")
    if not _may_meet(several, formulas):
        for made in several:
            yield from _stepped(made, symbol, formulas)
        return
    if len(several) > MOST_SHIFTS:
        raise NotSaid(f"more than {MOST_SHIFTS} shifts of `{symbol.name}` may be of one thing")
    met = [t for made in several for t in (*made.variables, *made.effect.terms, *free_variables(made.guard))]
    terms: list[Variable] = []
    for parameter in symbol.parameters:
        terms.append(apart(parameter, [*met, *terms]))
    asked = [_asked(made, terms, formulas) for made in several]
    for size in range(1, len(several) + 1):
        for chosen in combinations(range(len(several)), size):
            total = sum(_amount(several[number]) for number in chosen)
            guard = both(f if number in chosen else negated(f) for number, f in enumerate(asked))
            if total and guard != NEVER:
                shift = Shift(symbol.name, tuple(terms), total)
                yield from _stepped(_Made(tuple(terms), guard, shift, True), symbol, formulas)


def _amount(made: _Made) -> int:
    assert isinstance(made.effect, Shift)
    return made.effect.amount


def _may_meet(several: Sequence[_Made], formulas: Formulas) -> bool:
    """Whether two of the shifts may be of one thing."""
    return any(
        all(
            one == other or formulas.may_be_one(one, other)
            for one, other in zip(a.effect.terms, b.effect.terms, strict=True)
        )
        for a, b in combinations(several, 2)
    )


def _asked(made: _Made, terms: Sequence[Variable], formulas: Formulas) -> Formula:
    """Under what a shift is of these terms."""
    same = [formulas.equal(own, term) for own, term in zip(made.effect.terms, terms, strict=True)]
    return formulas.some(made.variables, both([made.guard, *same]))


def _stepped(made: _Made, symbol: Symbol, formulas: Formulas) -> Iterator[Change]:
    """A change for each value that is not the last in the direction of the shift."""
    name, values = formulas.predicates.of, symbol.values
    for place, value in enumerate(values):
        goal = values[min(max(place + _amount(made), 0), len(values) - 1)]
        if goal != value:
            guard = both([made.guard, literal(name(symbol.name, value), made.effect.terms)])
            yield _change(made, guard, name(symbol.name, value), False, formulas)
            yield _change(made, guard, name(symbol.name, goal), True, formulas)


# ---- what is changed


def hits(change: Change, terms: Sequence[Term], formulas: Formulas) -> Formula:
    """Under what a change is of these terms."""
    names: dict[Term, Term] = {}
    met: list[Term] = [*terms, *change.terms, *free_variables(change.guard)]
    for variable in change.variables:
        names[variable] = apart(variable, [*met, *names.values()]) if variable in terms else variable
    same, stands = [], dict[Term, Term]()
    for own, term in zip(change.terms, terms, strict=True):
        here = names.get(own, own)
        if own in names and here not in stands and formulas.domain.is_a(term.type, own.type):
            stands[here] = term
        else:
            same.append((here, term))
    guard = formulas.renamed(formulas.renamed(change.guard, names), stands)
    asked = [formulas.equal(stands.get(one, one), other) for one, other in same]
    left = [v for v in names.values() if v not in stands and isinstance(v, Variable)]
    return quantified(True, left, both([guard, *asked]))
