"""`cleancli explain`: which rule covers an action, and if none does, what each of its rules lacks."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence

import click

from cleancli.cli.completion import actions, domains, problems
from cleancli.cli.echo import echo
from cleancli.cli.observe import open_both
from cleancli.compiler.explain import (
    Attempt,
    Bound,
    Explanation,
    Failure,
    OutcomeHere,
    UnclearReference,
    explain,
)
from cleancli.language.calls import read_action
from cleancli.language.load import located_in
from cleancli.language.model import (
    Domain,
    Equality,
    Literal,
    OutcomeKind,
    Problem,
    Quantified,
    Symbol,
    Value,
)
from cleancli.language.printing.printer import print_condition, print_fraction, symbols_of


@click.command("explain", short_help="Which rule covers an action, and if none does, why.")
@click.argument("domain", shell_complete=domains)
@click.argument("problem", shell_complete=problems)
@click.argument("action", shell_complete=actions)
@click.option("--json", "as_data", is_flag=True, help="Print the explanation as JSON.")
def command(domain: str, problem: str, action: str, as_data: bool) -> None:
    """Say what ACTION, like "join2(a1, a3)", would do in the initial state of PROBLEM, and by which rule.

    If no rule covers it, say of each of its rules which literals fail, and what holds instead. For a scene,
    the state is that of one look at its table.
    """
    sources, model, given = open_both(domain, problem)
    name, arguments = read_action(action, model, given)
    with located_in(*sources):
        found = explain(model, given, name, arguments)
    if as_data:
        click.echo(json.dumps(_as_data(model, found), indent=2))
    else:
        echo("\n".join(_lines(model, given, found)))


def _lines(domain: Domain, problem: Problem, found: Explanation) -> Iterator[str]:
    called = f"{found.action}({', '.join(found.arguments)})"
    if found.covering is not None:
        yield f"{called}: covered by rule {found.covering.name}{_binding(found.covering.binding)}"
        yield from (f"  {_outcome(outcome)}" for outcome in found.covering.outcomes)
    else:
        yield f"{called}: no rule covers it in the initial state of {problem.name}"
        yield "default"
        yield from (f"  {_outcome(outcome)}" for outcome in found.default)
    for attempt in found.attempts:
        yield f"rule {attempt.name} does not apply{_binding(attempt.binding)}"
        yield from _attempt(domain, attempt)


def _attempt(domain: Domain, attempt: Attempt) -> Iterator[str]:
    symbols = symbols_of(domain)
    parts = [print_condition((failure.part,), symbols) for failure in attempt.failures]
    width = max(map(len, parts), default=0)
    for part, failure in zip(parts, attempt.failures, strict=True):
        yield f"  {part:<{width}}  fails: {_instead(failure)}"
        yield from (f"    since {reason}" for reason in _reasons(failure, symbols))
    if attempt.unclear is not None:
        yield f"  {_unclear(attempt.unclear, symbols)}"


def _instead(failure: Failure) -> str:
    """What holds where a part of a condition does not."""
    match failure.part:
        case Equality(equal=equal):
            one, other = failure.objects
            return f"{one} and {other} are different" if equal else f"both are {one}"
        case Literal(symbol):
            return f"{symbol}({', '.join(failure.objects)}) is {_value(failure.actual)}"
        case Quantified(exists=exists):
            return "nothing fits" if exists else f"there is{_or(failure.witnesses)}"


def _reasons(failure: Failure, symbols: Mapping[str, Symbol]) -> Iterator[str]:
    """What a derived predicate lacks that should hold, and what that lacks in turn."""
    for reason in failure.because:
        yield f"{print_condition((reason.part,), symbols)} fails: {_instead(reason)}"
        yield from (f"  since {deeper}" for deeper in _reasons(reason, symbols))


def _unclear(unclear: UnclearReference, symbols: Mapping[str, Symbol]) -> str:
    condition = print_condition(unclear.reference.condition, symbols)
    fitting = f"these fit:{_or(unclear.fitting)}" if unclear.fitting else "nothing fits"
    return f"the reference to {condition} must fit one binding: {fitting}"


def _or(bindings: Sequence[Bound]) -> str:
    return " or".join(_binding(binding) for binding in bindings)


def _outcome(outcome: OutcomeHere) -> str:
    otherwise = "changes nothing here" if outcome.kind is OutcomeKind.CHANGE else outcome.kind.value
    return f"{print_fraction(outcome.probability)}: {', '.join(_effects(outcome)) or otherwise}"


def _effects(outcome: OutcomeHere) -> list[str]:
    return [_effect(c.fact.symbol, c.fact.objects, c.fact.value) for c in outcome.changes]


def _effect(symbol: str, objects: tuple[str, ...], value: Value) -> str:
    applied = f"{symbol}({', '.join(objects)})"
    if isinstance(value, bool):
        return applied if value else f"not {applied}"
    return f"{applied} := {value}"


def _binding(binding: Bound) -> str:
    shown = ", ".join(f"?{variable} = {name}" for variable, name in binding)
    return f" ({shown})" if shown else ""


def _value(value: Value | None) -> str:
    return (
        "without a value" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
    )


def _as_data(domain: Domain, found: Explanation) -> dict[str, object]:
    symbols = symbols_of(domain)
    covering = found.covering
    return {
        "action": found.action,
        "arguments": list(found.arguments),
        "rule": None if covering is None else covering.name,
        "outcomes": [
            {
                "probability": float(outcome.probability),
                "kind": outcome.kind.value,
                "effects": _effects(outcome),
            }
            for outcome in (found.default if covering is None else covering.outcomes)
        ],
        "other_rules": [
            {
                "rule": attempt.name,
                "binding": dict(attempt.binding),
                "failing": [
                    {"literal": print_condition((failure.part,), symbols), "instead": _instead(failure)}
                    for failure in attempt.failures
                ],
                "unclear": None if attempt.unclear is None else _unclear(attempt.unclear, symbols),
            }
            for attempt in found.attempts
        ],
    }
