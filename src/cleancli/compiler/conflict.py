"""Two values for one thing in one outcome (E602): which effects meet for these objects, and what to write.

Guaranteed by the checker: effects that meet for any objects were refused already (E308), so here terms differ
that stand for one object.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from cleancli.compiler.fluents import Binding, Fluent
from cleancli.compiler.lifted import ConflictError, LiftedState, Names
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import (
    Assign,
    ForAll,
    Outcome,
    Rule,
    Shift,
    Symbol,
    Term,
    Value,
    Variable,
)
from cleancli.language.printing.printer import print_term


def results(
    rules: LiftedRules, state: LiftedState, number: int, names: Names
) -> tuple[Mapping[Fluent, Value], ...]:
    """What each outcome of a rule sets in a state; `names` are what its variables stand for.

    An outcome of probability 0 never happens: where it would give something two values, it sets nothing.
    Raises `Refused` (E602).
    """
    rule, lifted = rules.domain.rules[number], rules[number]
    found: list[Mapping[Fluent, Value]] = []
    for outcome, changes in zip(rule.outcomes, lifted.changes, strict=True):
        try:
            found.append(changes(state, names))
        except ConflictError as error:
            if outcome.probability:
                binding = dict(zip(lifted.variables, names, strict=True))
                symbols = {symbol.name: symbol for symbol in rules.domain.symbols}
                raise Refused([conflicting_effects(rule, outcome, binding, error.key, symbols)]) from None
            found.append({})
    return tuple(found)


class _Effect(NamedTuple):
    """An effect, its terms in the order of the key that it is on, and the `forall` that it is of."""

    effect: Assign | Shift
    terms: tuple[Term, ...]
    forall: ForAll | None


def conflicting_effects(
    rule: Rule, outcome: Outcome, binding: Binding, key: Fluent, symbols: Mapping[str, Symbol]
) -> Diagnostic:
    """E602 for an outcome that gives `key` two values where the rule's variables are bound so.

    `binding` may leave out the variables of references.
    """
    action = f"{rule.action}({', '.join(binding[variable] for variable in rule.variables)})"
    one, other = _meeting(outcome, binding, key, symbols)
    thing = f"{key[0]}({', '.join(key[1])})"
    shifted = isinstance(one.effect, Shift) or isinstance(other.effect, Shift)
    does = f"sets {thing} and shifts it" if shifted else f"gives {thing} two values"
    return Diagnostic(
        "E602",
        f"for {action}, one outcome {does}",
        outcome.probability_span or rule.span,
        label=f"in this outcome of rule `{rule.name}`",
        help=_help(rule, one, other),
    )


def _meeting(
    outcome: Outcome, binding: Binding, key: Fluent, symbols: Mapping[str, Symbol]
) -> tuple[_Effect, _Effect]:
    """Two effects that may both be on the key and do not agree, plain ones before those of a `forall`."""
    pairs = itertools.combinations(_on(outcome, binding, key, symbols[key[0]]), 2)
    clashing = (pair for pair in pairs if _clash(pair[0].effect, pair[1].effect))
    return min(clashing, key=lambda pair: sum(each.forall is not None for each in pair))


def _clash(one: Assign | Shift, other: Assign | Shift) -> bool:
    both = (one, other)
    if all(isinstance(each, Shift) for each in both):
        return False
    return not all(isinstance(each, Assign) for each in both) or one != other


def _on(outcome: Outcome, binding: Binding, key: Fluent, symbol: Symbol) -> Iterator[_Effect]:
    for item in outcome.effects:
        forall = item if isinstance(item, ForAll) else None
        own = {} if forall is None else dict.fromkeys(forall.variables)
        bound = {variable: name for variable, name in binding.items() if variable not in own}
        for effect in (item,) if not isinstance(item, ForAll) else item.effects:
            terms = _fitting(effect, bound, key, symbol)
            if terms is not None:
                yield _Effect(effect, terms, forall)


def _fitting(
    effect: Assign | Shift, binding: Binding, key: Fluent, symbol: Symbol
) -> tuple[Term, ...] | None:
    """The effect's terms in the order in which they may stand for the key's objects; None if they can't."""
    if effect.symbol != key[0]:
        return None
    orders = itertools.permutations(effect.terms) if symbol.symmetric else (effect.terms,)
    return next((order for order in orders if _may_be(order, key[1], binding)), None)


def _may_be(terms: tuple[Term, ...], objects: tuple[str, ...], binding: Binding) -> bool:
    stands: dict[Term, str] = {}
    for term, name in zip(terms, objects, strict=True):
        here = binding.get(term, name) if isinstance(term, Variable) else term.name
        if here != name or stands.setdefault(term, name) != name:
            return False
    return True


def _help(rule: Rule, one: _Effect, other: _Effect) -> str:
    """The condition that keeps the two apart, and where to write it."""
    if one.forall is not None and one.forall is other.forall:
        return "two bindings of the `forall` meet here: narrow its condition so that each fact is set one way"
    differ = [
        f"{print_term(left)} != {print_term(right)}"
        for left, right in zip(one.terms, other.terms, strict=True)
        if left != right
    ]
    if not differ:
        return "an outcome gives each fact one value: drop one of the effects"
    wanted = " or ".join(f"`{text}`" for text in dict.fromkeys(differ))
    inner = one.forall or other.forall
    if inner is not None:
        word = "forall" if inner.variables else "if"
        return f"add {wanted} to the condition of the `{word}`, so that it passes over what is set beside it"
    same = " and ".join(f"`{text.replace('!=', '=')}`" for text in dict.fromkeys(differ))
    return (
        f"add {wanted} to the condition of `{rule.name}`; if the action is meant for one object too, say in a"
        f" rule with {same} what it does then"
    )
