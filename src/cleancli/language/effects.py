"""The check of effects: what an outcome may set, and what it must not."""

from __future__ import annotations

from cleancli.language import syntax
from cleancli.language.conditions import (
    Scope,
    bind_variables,
    check_literals,
    is_integer,
    resolve_application,
    resolve_value,
    shown_values,
    wants_function,
    wants_predicate,
    warn_unused_variables,
)
from cleancli.language.declarations import without_point
from cleancli.language.model import Assign, ForAll, Shift, Symbol, Value
from cleancli.language.overlap import canonical


def check_effects(node: syntax.Effects, scope: Scope) -> tuple[Assign | Shift | ForAll, ...]:
    """The effects of one outcome that are right; each fact is changed once (E308)."""
    effects: list[Assign | Shift | ForAll] = []
    changed: dict[tuple[object, ...], Assign | Shift] = {}
    for item in node.effects:
        if isinstance(item, syntax.ForAllNode):
            effects.append(_forall(item, scope))
            way_out = "put all its effects in parentheses, `forall ?m - type: p(?m) => (q(?m), r(?m))`"
            scope = scope.behind(item.groups, way_out)
            continue
        effect = _assignment(item, scope)
        if effect is None:
            continue
        effects.append(effect)
        key = (effect.symbol, canonical(scope.declared.symbols[effect.symbol], effect.terms))
        if key in changed:
            what = "a second time" if _does(changed[key]) == _does(effect) else "in two ways"
            scope.findings.error(
                "E308",
                f"this outcome changes `{effect.symbol}` {what}",
                item.span,
                help="an outcome gives each fact one value",
            )
        changed[key] = effect
    return tuple(effects)


def _does(effect: Assign | Shift) -> tuple[bool, Value]:
    return (False, effect.amount) if isinstance(effect, Shift) else (True, effect.value)


def _assignment(node: syntax.Assignment, scope: Scope) -> Assign | Shift | None:
    resolved = resolve_application(node.application, scope)
    if resolved is None or not _may_change(resolved[0], node, scope):
        return None
    symbol, terms = resolved
    match node:
        case syntax.SetTruth():
            fits = wants_predicate(symbol, node, scope, ":=")
            return Assign(symbol.name, terms, node.value) if fits else None
        case syntax.SetValue():
            if not wants_function(symbol, node, scope):
                return None
            value = resolve_value(node.value, symbol, scope)
            return None if value is None else Assign(symbol.name, terms, value)
        case syntax.ShiftNode():
            amount = _amount(node, symbol, scope)
            return None if amount is None else Shift(symbol.name, terms, amount)


def _may_change(symbol: Symbol, node: syntax.Assignment, scope: Scope) -> bool:
    if symbol.name in scope.declared.derived:
        scope.findings.error(
            "E221",
            f"`{symbol.name}` is derived and cannot be set",
            node.span,
            help="change what it follows from",
        )
        return False
    if symbol.static:
        scope.findings.error(
            "E220",
            f"`{symbol.name}` is static and never changes",
            node.span,
            help="remove this effect, or the mark `[static]`",
        )
        return False
    return True


def _amount(node: syntax.ShiftNode, symbol: Symbol, scope: Scope) -> int | None:
    if not is_integer(symbol):
        help = "it is a predicate" if symbol.is_predicate else f"its values are {shown_values(symbol)}"
        scope.findings.error("E225", f"`{symbol.name}` has no integers to count with", node.span, help=help)
        return None
    if not node.amount.is_whole or node.amount.value == 0:
        message = "an integer changes by a whole number above 0"
        scope.findings.error("E225", message, node.amount.span, help=without_point(node.amount))
        return None
    amount = int(node.amount.value)
    return amount if node.rises else -amount


def _forall(node: syntax.ForAllNode, scope: Scope) -> ForAll:
    variables, inner = bind_variables(
        node.groups, "forall", "?m - type: condition => effect", node.span, scope
    )
    condition = check_literals(node.condition.parts if node.condition is not None else (), inner)
    checked = (_assignment(item, inner) for item in node.effects)
    effects = tuple(effect for effect in checked if effect is not None)
    if len(effects) == len(node.effects):
        warn_unused_variables(node.groups, condition, scope, (t for e in effects for t in e.terms))
    return ForAll(variables, condition, effects)
