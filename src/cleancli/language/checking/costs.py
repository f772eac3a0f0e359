"""The check of prices: what actions cost by values of functions, and what outcomes pay.

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
from cleancli.language.model import NOTHING_PAID, Action, Price, PricePart, Symbol


def with_prices(node: syntax.DomainNode, scope: Scope) -> dict[str, Action]:
    """The actions of a domain, which have the numbers that they cost, with what functions say that they cost
    beside (E203 to E209, E228)."""
    actions = dict(scope.declared.actions)
    for section in sections_of(node.sections, syntax.Actions):
        for item in section.actions:
            prices = [each.value for each in item.attributes if isinstance(each.value, syntax.Price)]
            if prices and item.name.text in actions:
                action = actions[item.name.text]
                inner = scope.with_variables(action.parameters)
                said = (_by_functions(price, inner) for price in prices)
                actions[action.name] = replace(action, cost=sum(said, action.cost))
    return actions


def _by_functions(node: syntax.Price, scope: Scope) -> Price:
    """What functions say of a price, each part once."""
    return sum((Price(parts=(part,)) for part in _parts(node, scope)), NOTHING_PAID)


def _parts(node: syntax.Price, scope: Scope) -> Iterator[PricePart]:
    for item in node.parts:
        if item.weight is not None and item.weight.denominator_is_zero:
            scope.findings.error("E302", "division by zero", item.weight.span)
        resolved = resolve_application(item.application, scope)
        if resolved is not None and _may_count(resolved[0], item, scope):
            weight = Fraction(1) if item.weight is None else item.weight.value
            yield PricePart(weight, resolved[0].name, resolved[1])


def _may_count(symbol: Symbol, node: syntax.Priced, scope: Scope) -> bool:
    """Whether a price can be counted with the values of a symbol."""
    low = symbol.values[0]
    if symbol.is_predicate:
        message, help = f"`{symbol.name}` is a predicate", "a price counts integers that functions have"
    elif not is_integer(symbol) or not isinstance(low, int):
        message, help = f"`{symbol.name}` has no integers", f"its values are {shown_values(symbol)}"
    elif not symbol.static:
        message, help = f"`{symbol.name}` may change", "mark it `[static]` where it is declared"
    elif low < 0:
        message, help = f"`{symbol.name}` may be below 0", "no price is: let its range begin at 0 or above"
    else:
        return True
    scope.findings.error("E228", message, node.application.span, help=help)
    return False


def check_payments(node: syntax.Effects, scope: Scope) -> tuple[Price, Price]:
    """What an outcome adds to the reward of its step, and to what its action costs (E203 to E209, E228, E229,
    E302)."""
    paid = {"reward": NOTHING_PAID, "cost": NOTHING_PAID}
    last: dict[str, syntax.PayNode] = {}
    for item in node.effects:
        if isinstance(item, syntax.PayNode):
            number = Fraction(0) if item.price.amount is None else item.price.amount.value
            parts = tuple(_parts(item.price, scope))
            price = sum((Price(parts=(part,)) for part in parts), Price(number))
            if _may_pay(item, price, len(parts) == len(item.price.parts), scope):
                paid[item.what.text] += price if item.rises else price.times(Fraction(-1))
                last[item.what.text] = item
    for what, item in last.items():
        if not paid[what]:
            scope.findings.error(
                "E229", f"what is paid as `{what}` comes to nothing in all", item.span, help=_NOTHING_PAID
            )
    return paid["reward"], paid["cost"]


_NOTHING_PAID = "leave it out; an outcome without effects is `nothing`"


def _may_pay(node: syntax.PayNode, price: Price, is_whole: bool, scope: Scope) -> bool:
    """Whether an outcome can pay a price, which `is_whole` where no part of it was refused."""
    what, sign = node.what.text, "+=" if node.rises else "-="
    amount = node.price.amount
    if amount is not None and amount.denominator_is_zero:
        scope.findings.error("E302", "division by zero", amount.span)
        return False
    if what not in ("reward", "cost"):
        message, help = f"an outcome pays by `reward` or `cost`, not by `{what}`", ""
        if what in scope.declared.symbols:
            help = f"to change the function, write its objects: `{what}(...) {sign} n`"
    elif what == "cost" and not node.rises:
        message, help = "no cost is below 0", "say what it brings: `reward += n`"
    elif is_whole and not price:
        message, help = "this pays nothing", _NOTHING_PAID
    else:
        return True
    scope.findings.error("E229", message, node.span, help=help)
    return False
