"""What an outcome is paid, said by what holds before it.

A count after an outcome is a count of the bindings for which its condition comes to hold: the condition with
each literal replaced by what makes it hold afterwards (regression, Reiter 1991). So `decrease(n)` is one for
each binding that n counts before and not after, less one for each that it counts after and not before.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from cleancli.conversion.export.changes import hits, referred
from cleancli.conversion.export.formulas import Formulas, NotSaid
from cleancli.conversion.pddl.effect_trees import (
    Change,
)
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Both,
    Either,
    Formula,
    Quantified,
    apart,
    assuming,
    both,
    either,
    free_variables,
    negated,
)
from cleancli.language.model import (
    Count,
    Equality,
    Literal,
    Price,
    RewardKind,
    RewardTerm,
    Rule,
    Term,
    Variable,
)


@dataclass(frozen=True, slots=True)
class Payment:
    """So much is paid for each binding of the variables that a guard holds for; more than 0, or less."""

    variables: tuple[Variable, ...]
    guard: Formula
    price: Price


def payments_of(
    terms: Sequence[RewardTerm], changes: Sequence[Change], known: Formula, formulas: Formulas
) -> Iterator[Payment]:
    """What the terms of a reward that are about counts pay for an outcome where `known` holds.

    Raises `NotSaid` where what is counted follows a closure that changes.
    """
    counts = {count.name: count for count in formulas.domain.counts}
    for term in terms:
        if term.count is None:
            continue
        before, after, count = _counted(counts[term.count], changes, known, formulas)
        if term.kind is RewardKind.COUNT:
            yield from _paid(count.variables, after, known, term.weight, formulas)
        elif before != after:
            lost = both([before, assuming(negated(after), [before])])
            won = both([negated(before), assuming(after, [negated(before)])])
            yield from _paid(count.variables, lost, known, term.weight, formulas)
            yield from _paid(count.variables, won, known, -term.weight, formulas)


def priced(price: Price, rule: Rule, formulas: Formulas) -> Iterator[Payment]:
    """A price that an outcome of a rule pays by itself: what it says of objects that references name, for
    their binding."""
    plain = Price(price.number)
    for part in price.parts:
        used = [term for term in part.terms if isinstance(term, Variable)]
        variables, guard = referred(used, rule.references, formulas)
        if variables:
            yield Payment(variables, guard, Price(parts=(part,)))
        else:
            plain += Price(parts=(part,))
    if plain:
        yield Payment((), ALWAYS, plain)


def _counted(
    count: Count, changes: Sequence[Change], known: Formula, formulas: Formulas
) -> tuple[Formula, Formula, Count]:
    """What is counted before and after, and the count, with variables that nothing else has the names of."""
    met: list[Term] = [*free_variables(known)]
    for change in changes:
        met += [*change.variables, *change.terms, *free_variables(change.guard)]
    names: dict[Term, Term] = {}
    for variable in count.variables:
        names[variable] = apart(variable, [*met, *names.values()])
    bound = tuple(each for each in names.values() if isinstance(each, Variable))
    before = formulas.renamed(formulas.condition(count.condition), names)
    return before, regressed(before, changes, formulas), replace(count, variables=bound)


def _paid(
    variables: tuple[Variable, ...], guard: Formula, known: Formula, amount: Fraction, formulas: Formulas
) -> Iterator[Payment]:
    """The payment for the bindings of a guard; a variable that must be one other term is replaced by it."""
    while (found := _same(variables, guard, formulas)) is not None:
        variable, term = found
        variables = tuple(each for each in variables if each != variable)
        guard = formulas.renamed(guard, {variable: term})
    guard = assuming(guard, [known])
    if guard != NEVER and amount:
        yield Payment(variables, guard, Price(amount))


def _same(variables: Sequence[Variable], guard: Formula, formulas: Formulas) -> tuple[Variable, Term] | None:
    """A variable, and the term that it must be, which is of its type or one below."""
    for part in guard.parts if isinstance(guard, Both) else (guard,):
        if isinstance(part, Equality) and part.equal:
            for one, other in ((part.left, part.right), (part.right, part.left)):
                if (
                    one in variables
                    and isinstance(one, Variable)
                    and formulas.domain.is_a(other.type, one.type)
                ):
                    return one, other
    return None


def regressed(formula: Formula, changes: Sequence[Change], formulas: Formulas) -> Formula:
    """What must hold before the changes so that a formula holds after them. No variable that it binds has the
    name of one that the changes have. Raises `NotSaid`."""
    match formula:
        case Literal():
            return _literal(formula, changes, formulas)
        case Equality():
            return formula
        case Both(parts):
            return both(regressed(part, changes, formulas) for part in parts)
        case Either(parts):
            return either(regressed(part, changes, formulas) for part in parts)
        case Quantified(exists, variables, part):
            met = [t for change in changes for t in (*change.terms, *free_variables(change.guard))]
            names: dict[Term, Term] = {}
            for variable in variables:
                others = [other for other in variables if other != variable]
                names[variable] = apart(variable, [*met, *others, *names.values()])
            bound = tuple(each for each in names.values() if isinstance(each, Variable))
            inner = formulas.renamed(part, names)
            return Quantified(exists, bound, regressed(inner, changes, formulas))


def _literal(formula: Literal, changes: Sequence[Change], formulas: Formulas) -> Formula:
    if True not in formula.values:
        return negated(_literal(negated_literal(formula), changes, formulas))
    if formulas.moving_closure(formula.symbol, {change.symbol for change in changes}):
        raise NotSaid(f"what is paid follows the closure `{formula.symbol}`, which the outcome changes")
    added = [hits(c, formula.terms, formulas) for c in changes if c.symbol == formula.symbol and c.value]
    deleted = [
        hits(c, formula.terms, formulas) for c in changes if c.symbol == formula.symbol and not c.value
    ]
    stays = both([formula, negated(either(deleted))])
    return either([*added, stays]) if ALWAYS not in added else ALWAYS


def negated_literal(formula: Literal) -> Literal:
    """The opposite of a literal, which is one."""
    opposite = negated(formula)
    assert isinstance(opposite, Literal)
    return opposite
