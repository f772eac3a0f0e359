"""Warnings about rules and goals that ask a problem for what can never come about in it.

Guaranteed before: domain and problem are without mistakes. What a symbol can be is taken from all facts and
effects together, whichever the objects, so that a warning is always right and some cases go unseen.
"""

from __future__ import annotations

from collections.abc import Iterator

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import (
    Assign,
    Condition,
    Domain,
    ForAll,
    Literal,
    Problem,
    Quantified,
    Rule,
    Shift,
    Value,
)
from cleancli.language.printing.printer import print_literal, symbols_of

_MOST_NAMED = 3


def warn_impossible(problem: Problem, domain: Domain, where: Span, findings: Findings) -> None:
    """W402 for literals that no fact and no rule makes true, with the rules that so never apply."""
    possible = _possible(problem, domain)
    symbols = symbols_of(domain)
    needing: dict[str, list[str]] = {}
    askers = [(f"the rule `{rule.name}`", _needed(rule)) for rule in domain.rules]
    for who, literals in [*askers, ("the goal", iter(_literals(problem.goal)))]:
        for literal in literals:
            if literal.symbol in possible and not possible[literal.symbol] & literal.values:
                generic = Literal(literal.symbol, symbols[literal.symbol].parameters, literal.values)
                needing.setdefault(print_literal(generic, symbols), []).append(who)
    for shown, users in needing.items():
        names = list(dict.fromkeys(users))
        more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
        message = f"`{shown}` never holds in this problem: no fact and no rule makes it so"
        findings.warning("W402", message, where, help=f"asked for by {', '.join(names[:_MOST_NAMED])}{more}")


def _possible(problem: Problem, domain: Domain) -> dict[str, set[Value]]:
    """The values that each symbol of the domain can have; derived ones are not listed."""
    possible: dict[str, set[Value]] = {s.name: {False} if s.is_predicate else set() for s in domain.symbols}
    for fact in problem.state:
        possible[fact.symbol].add(fact.value)
    everything = {s.name: set(s.values) for s in domain.symbols}
    for effect in _effects(domain):
        if isinstance(effect, Shift):
            possible[effect.symbol] |= everything[effect.symbol]
        else:
            possible[effect.symbol].add(effect.value)
    return possible


def _effects(domain: Domain) -> Iterator[Assign | Shift]:
    for rule in domain.rules:
        for outcome in rule.outcomes:
            for effect in outcome.effects:
                yield from effect.effects if isinstance(effect, ForAll) else (effect,)


def _needed(rule: Rule) -> Iterator[Literal]:
    """The literals without which the rule does not apply."""
    yield from _literals(rule.condition)
    for reference in rule.references:
        yield from _literals(reference.condition)


def _literals(condition: Condition) -> Iterator[Literal]:
    for part in condition:
        if isinstance(part, Literal):
            yield part
        elif isinstance(part, Quantified) and part.exists:
            yield from _literals(part.condition)
