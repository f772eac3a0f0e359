"""Conditions as cases, each a conjunction of literals: libPRADA's rules ask for nothing else."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cleancli.conversion.export.formulas import Formulas, NotSaid
from cleancli.conversion.export.instances import Instances
from cleancli.conversion.pddl.formula import (
    NEVER,
    Both,
    Either,
    Formula,
    Quantified,
    assuming,
    both,
    negated,
)
from cleancli.language.model import Equality, Literal, Term, Variable

MOST_CASES = 64
"""Rules that one rule may become. Chosen: far more than people read."""

Known = tuple[Literal | Equality, ...]
"""A case: literals and equalities that all hold."""


def cases_of(
    known: Formula, guards: Sequence[Formula], instances: Instances, formulas: Formulas
) -> list[Known]:
    """The cases in which a condition holds and each guard is decided; of what is written out for the
    problem's objects those alone that can be."""
    found: list[Known] = []
    undecided: list[tuple[Formula, Known]] = [(known, ())]
    while undecided:
        formula, case = undecided.pop(0)
        if formula == NEVER:
            continue
        parts = formula.parts if isinstance(formula, Both) else (formula,)
        plain = tuple(part for part in parts if isinstance(part, Literal | Equality))
        others = [part for part in parts if not isinstance(part, Literal | Equality)]
        here = (*case, *(part for part in plain if part not in case))
        if _contradicts(here, formulas):
            continue
        if instances.were_needed and not instances.can_hold(here):
            continue
        question = _question(others, here, guards, formulas)
        if question is None:
            found.append(here)
        else:
            rest = both(assuming(part, [*here]) for part in others)
            for chosen in (question, negated(question)):
                undecided.append((both([chosen, assuming(rest, [chosen])]), here))
        if len(found) + len(undecided) > MOST_CASES:
            raise NotSaid(f"the rule has more than {MOST_CASES} cases")
    return found


def differ_in(referred: Sequence[Variable], cases: Sequence[Known]) -> bool:
    """Whether cases ask different things of what is referred to."""
    asked = {part for case in cases for part in case if not {*_terms(part)}.isdisjoint(referred)}
    return any(negated(part) in asked for part in asked)


def _terms(part: Literal | Equality) -> tuple[Term, ...]:
    return (part.left, part.right) if isinstance(part, Equality) else part.terms


def _question(
    others: Sequence[Formula], case: Known, guards: Sequence[Formula], formulas: Formulas
) -> Literal | Equality | None:
    """A literal to decide next: of what a condition leaves open, then of what effects depend on. What cannot
    hold in the case needs no decision there."""
    for formula in others:
        return next(_basic(formula))
    for guard in guards:
        for part in _basic(assuming(guard, case)):
            if not _contradicts((*case, part), formulas):
                return part
    return None


def _basic(formula: Formula) -> Iterator[Literal | Equality]:
    """The literals of a formula without quantifiers."""
    match formula:
        case Literal() | Equality():
            yield formula
        case Both(parts) | Either(parts):
            for part in parts:
                yield from _basic(part)
        case Quantified():
            raise AssertionError("quantifiers are written out before")


def _contradicts(case: Known, formulas: Formulas) -> bool:
    """Whether literals cannot all hold: also where a function has two values, or none."""
    if any(negated(part) in case for part in case):
        return True
    held = [(part.symbol, part.terms) for part in case if isinstance(part, Literal) and True in part.values]
    fails = [(part.symbol, part.terms) for part in case if isinstance(part, Literal) and False in part.values]
    for symbol in formulas.symbols.values():
        if symbol.is_predicate:
            continue
        names = [formulas.predicates.of(symbol.name, value) for value in symbol.values]
        for terms in {terms for name, terms in (*held, *fails) if name in names}:
            if sum((name, terms) in held for name in names) > 1 or all(
                (name, terms) in fails for name in names
            ):
                return True
    return False
