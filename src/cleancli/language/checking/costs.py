"""The check of what actions cost by values of functions, and of what outcomes pay.

Guaranteed before: the actions with what they cost anyway, and all symbols.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from cleancli.language import syntax
from cleancli.language.checking.conditions import (
    Scope,
    is_integer,
    resolve_application,
    shown_values,
)
from cleancli.language.checking.declarations import sections_of
from cleancli.language.model import Action, CostPart, Symbol


def with_cost_parts(node: syntax.DomainNode, scope: Scope) -> dict[str, Action]:
    """The actions of a domain with the parts of their costs that functions say (E203 to E209, E228)."""
    actions = dict(scope.declared.actions)
    for section in sections_of(node.sections, syntax.Actions):
        for item in section.actions:
            prices = [each.value for each in item.attributes if isinstance(each.value, syntax.Price)]
            if prices and item.name.text in actions:
                action = actions[item.name.text]
                inner = scope.with_variables(action.parameters)
                parts = tuple(part for price in prices for part in _parts(price, inner))
                actions[action.name] = replace(action, cost_parts=parts)
    return actions


def _parts(node: syntax.Price, scope: Scope) -> Iterator[CostPart]:
    for item in node.parts:
        if item.weight is not None and item.weight.denominator_is_zero:
            scope.findings.error("E302", "division by zero", item.weight.span)
        resolved = resolve_application(item.application, scope)
        if resolved is not None and _may_count(resolved[0], item, scope):
            weight = Fraction(1) if item.weight is None else item.weight.value
            yield CostPart(weight, resolved[0].name, resolved[1])


def _may_count(symbol: Symbol, node: syntax.Priced, scope: Scope) -> bool:
    """Whether a cost can be counted with the values of a symbol."""
    low = symbol.values[0]
    if symbol.is_predicate:
        message, help = f"`{symbol.name}` is a predicate", "a cost counts integers that functions have"
    elif not is_integer(symbol) or not isinstance(low, int):
        message, help = f"`{symbol.name}` has no integers", f"its values are {shown_values(symbol)}"
    elif not symbol.static:
        message, help = f"`{symbol.name}` may change", "mark it `[static]` where it is declared"
    elif low < 0:
        message, help = f"`{symbol.name}` may be below 0", "no cost is: let its range begin at 0 or above"
    else:
        return True
    scope.findings.error("E228", message, node.application.span, help=help)
    return False


def check_payments(node: syntax.Effects, scope: Scope) -> tuple[Fraction, Fraction]:
    """What an outcome adds to the reward of its step, and to what its action costs (E229, E302)."""
    paid = {"reward": Fraction(0), "cost": Fraction(0)}
    for item in node.effects:
        if isinstance(item, syntax.PayNode) and _may_pay(item, scope):
            paid[item.what.text] += item.amount.value if item.rises else -item.amount.value
    return paid["reward"], paid["cost"]


def _may_pay(node: syntax.PayNode, scope: Scope) -> bool:
    what, sign = node.what.text, "+=" if node.rises else "-="
    if node.amount.denominator_is_zero:
        scope.findings.error("E302", "division by zero", node.amount.span)
        return False
    if what not in ("reward", "cost"):
        message, help = f"an outcome pays by `reward` or `cost`, not by `{what}`", ""
        if what in scope.declared.symbols:
            help = f"to change the function, write its objects: `{what}(...) {sign} n`"
    elif what == "cost" and not node.rises:
        message, help = "no cost is below 0", "say what it brings: `reward += n`"
    elif node.amount.value == 0:
        message, help = "this pays nothing", "leave it out; an outcome without effects is `nothing`"
    else:
        return True
    scope.findings.error("E229", message, node.span, help=help)
    return False
