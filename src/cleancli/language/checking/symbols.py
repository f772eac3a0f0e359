"""Predicates, functions, actions and shared parameters of a domain, with their marks in brackets.

Guaranteed before: the tree of types.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction

from cleancli.language import syntax
from cleancli.language.checking.declarations import (
    Declarations,
    Once,
    read_variables,
    sections_of,
    without_point,
)
from cleancli.language.checking.notes import is_fixed, mark_of, times_seen
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import NOTHING_PAID, Action, Price, Symbol, Value, Variable

LONGEST_DURATION = 1_000_000
"""Seconds of an action; eleven days. Chosen."""

_SECONDS = {"s": 1, "min": 60}
_INTEGERS = ("int", "integer", "number", "real", "float")
"""What other languages call the values of a function."""
MOST_VALUES = 1000
"""Values of an integer function: each is a column of the planner's belief."""


def read_symbols(
    node: syntax.DomainNode, declared: Declarations, once: Once, findings: Findings
) -> dict[str, Symbol]:
    """The predicates and functions, in this order; derived predicates are read elsewhere."""
    predicates = [p for section in sections_of(node.sections, syntax.Predicates) for p in section.predicates]
    functions = [f for section in sections_of(node.sections, syntax.Functions) for f in section.functions]
    symbols = [
        *(_predicate(predicate, declared, once, findings) for predicate in predicates),
        *(_function(function, declared, once, findings) for function in functions),
    ]
    return {symbol.name: symbol for symbol in symbols if symbol is not None}


def _predicate(
    node: syntax.PredicateNode, declared: Declarations, once: Once, findings: Findings
) -> Symbol | None:
    parameters = read_variables(node.parameters, declared, findings)
    marks = read_marks(node.attributes, ("symmetric", "static"), findings)
    symmetric = "symmetric" in marks and _may_be_symmetric(node, parameters, findings)
    if not once.admits(node.name, "predicate"):
        return None
    return Symbol(node.name.text, parameters, symmetric=symmetric, static="static" in marks)


def _function(
    node: syntax.FunctionNode, declared: Declarations, once: Once, findings: Findings
) -> Symbol | None:
    parameters = read_variables(node.parameters, declared, findings)
    marks = read_marks(node.attributes, ("static",), findings)
    before = findings.errors
    values = _values(node, findings)
    if findings.errors > before:
        findings.unclear.add(("function", node.name.text))
    if not once.admits(node.name, "function"):
        return None
    return Symbol(node.name.text, parameters, values, static="static" in marks)


def read_marks(
    attributes: Iterable[syntax.Attribute], plain: tuple[str, ...], findings: Findings
) -> Mapping[str, syntax.Attribute]:
    """Marks without a value, by name; E213 for unknown ones, for values, and for a mark that stands twice."""
    marks: dict[str, syntax.Attribute] = {}
    for attribute in attributes:
        name = attribute.name.text
        if name not in plain:
            findings.unknown("E213", "mark", name, attribute.name.span, plain)
        elif attribute.value is not None:
            findings.error("E213", f"`{name}` takes no value", attribute.value.span)
        elif name in marks:
            findings.error("E213", f"a second `{name}`", attribute.span)
        else:
            marks[name] = attribute
    return marks


def _may_be_symmetric(
    predicate: syntax.PredicateNode, parameters: tuple[Variable, ...], findings: Findings
) -> bool:
    fits = len(parameters) == 2 and parameters[0].type == parameters[1].type
    if not fits:
        mark = next(a for a in predicate.attributes if a.name.text == "symmetric")
        findings.error(
            "E212",
            f"`{predicate.name.text}` cannot be symmetric",
            mark.span,
            help="a symmetric predicate has two parameters of one type",
        )
    return fits


def _values(function: syntax.FunctionNode, findings: Findings) -> tuple[Value, ...]:
    if isinstance(function.values, syntax.Bounds):
        return _integers(function.values, findings)
    admitted = Once(findings)
    values = tuple(v.text for v in function.values if admitted.admits(v, "value"))
    if len(function.values) < 2:
        help = "a function has at least two values: `low < high`"
        if function.values[0].text in _INTEGERS:
            help = f"integers have a range: `{function.name.text}(...): 0..10`"
        findings.error("E217", f"`{function.name.text}` has one value only", function.span, help=help)
    # Even one that is misnamed has values: without any it would be neither a predicate nor a function.
    return values or (function.values[0].text,)


def _integers(bounds: syntax.Bounds, findings: Findings) -> tuple[int, ...]:
    low, high = bounds.low, bounds.high
    help = without_point(low, high) or "write for example `0..10`"
    if not (low.is_whole and high.is_whole):
        findings.error("E224", "the bounds of a range are whole numbers", bounds.span, help=help)
    elif low.value >= high.value:
        findings.error("E224", "a range rises from its first bound to its second", bounds.span, help=help)
    elif high.value - low.value >= MOST_VALUES:
        findings.error("E224", f"a range has at most {MOST_VALUES} values", bounds.span)
    else:
        return tuple(range(int(low.value), int(high.value) + 1))
    return (0, 1)


def read_actions(node: syntax.DomainNode, declared: Declarations, findings: Findings) -> dict[str, Action]:
    """The actions with what they take of time and reward."""
    once = Once(findings)
    actions = {}
    for section in sections_of(node.sections, syntax.Actions):
        for item in section.actions:
            action = _action(item, declared, findings)
            if once.admits(item.name, "action"):
                actions[action.name] = action
    return actions


def _action(node: syntax.ActionNode, declared: Declarations, findings: Findings) -> Action:
    parameters = read_variables(node.parameters, declared, findings)
    stated = _stated(node.attributes, findings)
    cost, duration = stated.get("cost"), stated.get("duration")
    price = NOTHING_PAID if cost is None else Price(_cost(cost, findings))
    action = Action(node.name.text, parameters, cost=price)
    return action if duration is None else _timed(action, duration, findings)


def _stated(attributes: Iterable[syntax.Attribute], findings: Findings) -> Mapping[str, syntax.Attribute]:
    """What is said of an action, by name; E213 for unknown names, and for one that stands twice."""
    stated: dict[str, syntax.Attribute] = {}
    for attribute in attributes:
        name = attribute.name.text
        if name not in ("duration", "cost"):
            findings.unknown("E213", "mark", name, attribute.name.span, ["cost", "duration"])
        elif name in stated:
            findings.error("E213", f"a second {name}", attribute.span)
        else:
            stated[name] = attribute
    return stated


def _timed(action: Action, attribute: syntax.Attribute, findings: Findings) -> Action:
    """The action with its duration, and with what the learner noted of that."""
    span, value, marks = attribute.span, attribute.value, attribute.marks
    prior = mark_of(syntax.QuantityPrior, marks, findings)
    return replace(
        action,
        duration=_seconds(value, span, "duration = 9 s", findings),
        duration_prior=None if prior is None else _seconds(prior.quantity, prior.span, "prior 9 s", findings),
        duration_seen=times_seen(marks, findings),
        duration_fixed=is_fixed(marks, findings),
        duration_span=None if value is None else value.span,
        noted_span=None if value is None else replace(value.span, end=span.end),
    )


def _seconds(
    value: syntax.Quantity | syntax.Price | None, whole: Span, example: str, findings: Findings
) -> float | None:
    """A duration in seconds; None, with E213 reported, for what is none. `whole`: what it stands in."""
    if not isinstance(value, syntax.Quantity) or value.unit not in _SECONDS:
        message = "a duration is a number of seconds or minutes"
        findings.error("E213", message, whole, help=f"write for example `{example}`")
        return None
    if value.value <= 0:
        findings.error("E213", "a duration must be above 0 s", value.span)
        return None
    seconds = value.value * _SECONDS[value.unit]
    if seconds > LONGEST_DURATION:
        findings.error("E213", f"a duration is at most {LONGEST_DURATION} s", value.span)
        return None
    return float(seconds)


def _cost(attribute: syntax.Attribute, findings: Findings) -> Fraction:
    value = attribute.value
    if attribute.marks:
        first, last = attribute.marks[0].span, attribute.marks[-1].span
        help = "remove them: of what stands here only a duration is learned"
        findings.error("E311", "a cost has no marks", replace(first, end=last.end), help=help)
    if isinstance(value, syntax.Price):  # its other parts are checked where symbols are known (`costs`)
        amount = value.amount
        if amount is not None and amount.denominator_is_zero:
            findings.error("E302", "division by zero", amount.span)
        return Fraction(0) if amount is None else amount.value
    if value is None or value.unit is not None or value.value < 0:
        findings.error(
            "E213",
            "a cost is a number without unit, 0 or more",
            attribute.span,
            help="write for example `cost = 2`; the reward says what it takes away: `- cost`",
        )
        return Fraction(0)
    return value.value
