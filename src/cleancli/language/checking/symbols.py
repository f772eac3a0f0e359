"""Predicates, functions, actions and shared parameters of a domain, with their marks in brackets.

Guaranteed before: the tree of types.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from cleancli.language import syntax
from cleancli.language.checking.declarations import (
    Declarations,
    Once,
    read_variables,
    sections_of,
    without_point,
)
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Action, Symbol, Value, Variable

LONGEST_DURATION = 1_000_000
"""Seconds of an action; eleven days. Chosen."""

_SECONDS = {"s": 1, "min": 60}
_INTEGERS = ("int", "integer", "number", "real", "float")
"""What other languages call the values of a function."""
_MOST_VALUES = 1000
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
    elif high.value - low.value >= _MOST_VALUES:
        findings.error("E224", f"a range has at most {_MOST_VALUES} values", bounds.span)
    else:
        return tuple(range(int(low.value), int(high.value) + 1))
    return (0, 1)


def read_actions(node: syntax.DomainNode, declared: Declarations, findings: Findings) -> dict[str, Action]:
    """The actions with what they take of time and reward."""
    once = Once(findings)
    actions = {}
    for section in sections_of(node.sections, syntax.Actions):
        for action in section.actions:
            parameters = read_variables(action.parameters, declared, findings)
            duration, cost = _duration_and_cost(action, findings)
            if once.admits(action.name, "action"):
                actions[action.name.text] = Action(action.name.text, parameters, duration, cost)
    return actions


def _duration_and_cost(action: syntax.ActionNode, findings: Findings) -> tuple[float | None, Fraction]:
    duration: float | None = None
    cost: Fraction | None = None
    for attribute in action.attributes:
        name = attribute.name.text
        if name not in ("duration", "cost"):
            findings.unknown("E213", "mark", name, attribute.name.span, ["cost", "duration"])
        elif (name == "duration" and duration is not None) or (name == "cost" and cost is not None):
            findings.error("E213", f"a second {name}", attribute.span)
        elif name == "duration":
            duration = _duration(attribute, findings)
        else:
            cost = _cost(attribute, findings)
    return duration, cost or Fraction(0)


def _duration(attribute: syntax.Attribute, findings: Findings) -> float | None:
    value = attribute.value
    if value is None or value.unit not in _SECONDS:
        findings.error(
            "E213",
            "a duration is a number of seconds or minutes",
            attribute.span,
            help="write for example `duration = 9 s`",
        )
        return None
    if value.value <= 0:
        findings.error("E213", "a duration must be above 0 s", value.span)
        return None
    seconds = value.value * _SECONDS[value.unit]
    if seconds > LONGEST_DURATION:
        findings.error("E213", f"a duration is at most {LONGEST_DURATION} s", value.span)
        return None
    return float(seconds)


def _cost(attribute: syntax.Attribute, findings: Findings) -> Fraction | None:
    value = attribute.value
    if value is None or value.unit is not None or value.value < 0:
        findings.error(
            "E213",
            "a cost is a number without unit, 0 or more",
            attribute.span,
            help="write for example `cost = 2`; the reward says what it takes away: `- cost`",
        )
        return None
    return value.value
