"""The rules of a domain as RDDL has them: where each applies, what is drawn, what that changes and pays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.conversion.export.changes import changes_of
from cleancli.conversion.export.draws import draws_of
from cleancli.conversion.export.formulas import Formulas
from cleancli.conversion.export.rddl_formulas import FormulaWriter
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.pddl.effect_trees import (
    Change,
)
from cleancli.conversion.pddl.formula import Formula
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import NOTHING_PAID, Domain, Outcome, Price, RewardKind, Rule, weight_of


@dataclass(frozen=True, slots=True)
class Draw:
    """What is drawn by itself when a rule applies: what each result changes, and what it pays. The fluent and
    its type have names, and so has each result, where there are several."""

    chances: tuple[Fraction, ...]
    changes: tuple[tuple[Change, ...], ...]
    paid: tuple[Price, ...]
    fluent: str
    type: str
    results: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Ruled:
    """A rule, where it applies, and what is drawn of its outcomes that may happen."""

    rule: Rule
    name: str
    known: Formula
    draws: tuple[Draw, ...]


def ruled_by(domain: Domain, texts: FormulaWriter, unsaid: Unsaid) -> tuple[Ruled, ...]:
    """The rules of a domain; what can't be said is told to `unsaid`, and the rule left out."""
    found: list[Ruled] = []
    for rule in domain.rules:
        with unsaid.of(rule.span):
            found.append(_ruled(rule, domain, texts, unsaid))
    return tuple(found)


def _ruled(rule: Rule, domain: Domain, texts: FormulaWriter, unsaid: Unsaid) -> Ruled:
    known = texts.formulas.applies(rule)
    likely = [outcome for outcome in rule.outcomes if outcome.probability]
    price = weight_of(domain, RewardKind.COST)
    parts = [(outcome.probability, _parts(outcome, rule, known, price, texts)) for outcome in likely]
    refuse_closures(texts.formulas, unsaid, rule.span, "")
    name = texts.name("rule", f"{rule.name}_applies")
    return Ruled(rule, name, known, tuple(_draws(rule, parts, texts)))


def _parts(
    outcome: Outcome, rule: Rule, known: Formula, price: Fraction, texts: FormulaWriter
) -> list[Change | Price]:
    """What an outcome changes, and what it pays by itself, where a cost counts with its price."""
    paid = outcome.reward + outcome.cost.times(price)
    changes = changes_of(outcome, rule, known, texts.formulas, texts.noise)
    return [*changes, *([paid] if paid else [])]


def _draws(
    rule: Rule, parts: Sequence[tuple[Fraction, list[Change | Price]]], texts: FormulaWriter
) -> Iterator[Draw]:
    """The draws of a rule; they are numbered where several have several results."""
    found = draws_of(parts)
    several = [draw for draw in found if len(draw) > 1]
    for draw in found:
        title = rule.name if len(several) < 2 else f"{rule.name}_{found.index(draw) + 1}"
        own = f"{rule.name} {found.index(draw)}"  # what tells the names of one draw from those of others
        results = range(1, len(draw) + 1) if len(draw) > 1 else ()
        yield Draw(
            tuple(chance for chance, _ in draw),
            tuple(tuple(each for each in result if isinstance(each, Change)) for _, result in draw),
            tuple(sum((e for e in result if isinstance(e, Price)), NOTHING_PAID) for _, result in draw),
            texts.name(f"drawn {own}", f"{title}_drawn") if results else "",
            texts.name(f"outcomes {own}", f"{title}_outcome") if results else "",
            tuple(f"@{texts.name(f'outcome {own}', f'{title}_{number}')}" for number in results),
        )


def refuse_closures(formulas: Formulas, unsaid: Unsaid, place: Span | None, of: str) -> None:
    """Tells of closures that what was said last speaks of, and that are no facts."""
    for said in formulas.forget_moving():
        unsaid.note(f"{of}{said}", place)


def results_of(ruled: Ruled) -> Iterator[tuple[Draw, int, tuple[Change, ...]]]:
    """All results of the draws of a rule, each with its draw and its place there."""
    for draw in ruled.draws:
        for place, changes in enumerate(draw.changes):
            yield draw, place, changes


def happens(ruled: Ruled, draw: Draw, place: int, hit: str, texts: FormulaWriter) -> str:
    """That the rule applies, a draw has the result at a place, and something holds."""
    return texts.some(ruled.rule.variables, [*when(ruled, draw, place, texts), hit])


def when(ruled: Ruled, draw: Draw, place: int, texts: FormulaWriter) -> list[str]:
    """That the rule applies, and a draw has the result at a place."""
    applies = f"{ruled.name}{texts.arguments(ruled.rule.variables)}"
    return [applies, *([f"({draw.fluent} == {draw.results[place]})"] if draw.results else [])]
