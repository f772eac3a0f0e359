"""The check of effects: what an outcome may set, and what it must not."""

from __future__ import annotations

from collections.abc import Mapping

from cleancli.language import syntax
from cleancli.language.checking.conditions import (
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
from cleancli.language.checking.declarations import without_point
from cleancli.language.checking.literals import canonical, leaders
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import Assign, Condition, Equality, ForAll, Shift, Symbol, Term

_Place = tuple[str, tuple[Term, ...]]
_Done = dict[_Place, Assign | Shift]

_ONE_VALUE = "an outcome gives each fact one value"
_WHERE_IT_FITS = "where an object fits, both would: write one rule with `exists` and one with `not exists`"
_WHERE_IT_HOLDS = "where its condition holds, both would: write an `if` with the opposite for the other"


def check_effects(
    node: syntax.Effects, scope: Scope, condition: Condition = ()
) -> tuple[Assign | Shift | ForAll, ...]:
    """The effects of one outcome that are right, where the rule's condition holds.

    Shifts of one number add up. What is the same for any objects is refused: a second assignment, or a shift
    beside one (E308); where only some objects are one, grounding decides.
    """
    same = leaders([part for part in condition if isinstance(part, Equality)])
    effects: list[Assign | Shift | ForAll] = []
    done: _Done = {}
    inner: list[tuple[syntax.ForAllNode | syntax.IfNode, ForAll]] = []
    for item in changing(node):
        if isinstance(item, syntax.ForAllNode | syntax.IfNode):
            effect = _forall(item, scope) if isinstance(item, syntax.ForAllNode) else _if(item, scope)
            inner.append((item, effect))
            effects.append(effect)
            way_out = "put all its effects in parentheses, `forall ?m - type: p(?m) => (q(?m), r(?m))`"
            scope = scope.behind(item.groups if isinstance(item, syntax.ForAllNode) else (), way_out)
        elif (assigned := _assignment(item, scope)) is not None:
            effects.append(assigned)
            _refuse_second(assigned, done, same, item.span, scope)
    for item, effect in inner:
        _refuse_inner(item, effect, done, same, scope)
    return tuple(effects)


def changing(node: syntax.Effects) -> tuple[syntax.Assignment | syntax.ForAllNode | syntax.IfNode, ...]:
    """The effects that change something, in their order; the others only pay."""
    return tuple(item for item in node.effects if not isinstance(item, syntax.PayNode))


def _refuse_inner(
    node: syntax.ForAllNode | syntax.IfNode,
    effect: ForAll,
    outer: _Done,
    same: Mapping[Term, Term],
    scope: Scope,
) -> None:
    """E308 for what a `forall` or `if` changes twice, or otherwise than the outcome does beside it."""
    if len(effect.effects) < len(node.effects):
        return  # it has other mistakes
    own: _Done = {}
    same = {term: leader for term, leader in same.items() if term not in effect.variables}
    for item, each in zip(node.effects, effect.effects, strict=True):
        beside = outer.get(_place(each, same, scope))
        bound = any(term in effect.variables for term in each.terms)
        if beside is not None and not bound and beside != each and not _both_shift(beside, each):
            help = _WHERE_IT_FITS if effect.variables else _WHERE_IT_HOLDS
            _refuse(each, "in two ways", item.span, scope, help)
        else:
            _refuse_second(each, own, same, item.span, scope)


def _refuse_second(
    effect: Assign | Shift, done: _Done, same: Mapping[Term, Term], span: Span, scope: Scope
) -> None:
    place = _place(effect, same, scope)
    before = done.setdefault(place, effect)
    if before is not effect and not _both_shift(before, effect):
        equal = isinstance(before, Assign) and isinstance(effect, Assign) and before.value == effect.value
        _refuse(effect, "a second time" if equal else "in two ways", span, scope)


def _refuse(effect: Assign | Shift, how: str, span: Span, scope: Scope, help: str = _ONE_VALUE) -> None:
    message = f"this outcome changes `{effect.symbol}` {how}"
    scope.findings.error("E308", message, span, help=help)


def _place(effect: Assign | Shift, same: Mapping[Term, Term], scope: Scope) -> _Place:
    terms = tuple([same.get(term, term) for term in effect.terms]) if same else effect.terms
    return effect.symbol, canonical(scope.declared.symbols[effect.symbol], terms)


def _both_shift(one: Assign | Shift, other: Assign | Shift) -> bool:
    return isinstance(one, Shift) and isinstance(other, Shift)


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


def _if(node: syntax.IfNode, scope: Scope) -> ForAll:
    """An effect with a condition is one on every binding of no variables that satisfies it."""
    condition = check_literals(node.condition.parts, scope)
    checked = (_assignment(item, scope) for item in node.effects)
    return ForAll((), condition, tuple(effect for effect in checked if effect is not None))
