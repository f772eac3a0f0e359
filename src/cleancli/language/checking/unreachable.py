"""Warnings about rules and goals that ask a problem for what can never come about in it.

Guaranteed before: domain and problem are without mistakes. What a symbol can be is taken from all facts and
effects together, whichever the objects, so that a warning is always right and some cases go unseen.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

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
    Symbol,
    Value,
)
from cleancli.language.printing.printer import print_literal, symbols_of

_MOST_NAMED = 3


def warn_impossible(problem: Problem, domain: Domain, where: Span, findings: Findings) -> None:
    """W402 for literals that no fact and no rule makes true, with the rules that so never apply."""
    possible = _possible(problem, domain)
    symbols = symbols_of(domain)
    needing: dict[str, list[str]] = {}
    for rule in domain.rules:
        for literal in _needed(rule):
            if _is_impossible(literal, possible):
                static = symbols[literal.symbol].static
                if not static or not _has_other_kind(rule, literal.symbol, domain, possible):
                    needing.setdefault(_generic(literal, symbols), []).append(f"the rule `{rule.name}`")
    for literal in _literals(problem.goal):
        if _is_impossible(literal, possible):
            needing.setdefault(_generic(literal, symbols), []).append("the goal")
    for shown, users in needing.items():
        names = list(dict.fromkeys(users))
        more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
        message = f"`{shown}` never holds in this problem: no fact and no rule makes it so"
        findings.warning("W402", message, where, help=f"asked for by {', '.join(names[:_MOST_NAMED])}{more}")


def _is_impossible(literal: Literal, possible: Mapping[str, set[Value]]) -> bool:
    return literal.symbol in possible and not possible[literal.symbol] & literal.values


def _has_other_kind(rule: Rule, symbol: str, domain: Domain, possible: Mapping[str, set[Value]]) -> bool:
    """Whether another rule of the action asks for a kind of objects, by a static symbol, that there may be: a
    problem need not have all kinds."""
    others = (other for other in domain.rules if other.action == rule.action and other != rule)
    literals = (literal for other in others for literal in _needed(other) if literal.symbol == symbol)
    return any(not _is_impossible(literal, possible) for literal in literals)


def _generic(literal: Literal, symbols: Mapping[str, Symbol]) -> str:
    return print_literal(Literal(literal.symbol, symbols[literal.symbol].parameters, literal.values), symbols)


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
