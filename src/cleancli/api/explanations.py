"""Why an action does what it does in a problem's initial state, or after other actions, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from cleancli.api.inputs import GivenDomain, GivenProblem, LoadedProblem, load_problem
from cleancli.api.plain import fields_of
from cleancli.api.seen import seen
from cleancli.api.tables import TextTable, preformatted, shown
from cleancli.compiler.explain import Attempt, Bound, Explanation, Failure, OutcomeHere, UnclearReference
from cleancli.compiler.explain import explain as explained
from cleancli.compiler.fluents import values_of
from cleancli.language.calls import Call, read_action, read_actions
from cleancli.language.load import located_in
from cleancli.language.model import (
    Domain,
    Equality,
    Fact,
    Literal,
    OutcomeKind,
    Price,
    Problem,
    Quantified,
    Symbol,
    Value,
)
from cleancli.language.printing.printer import (
    print_condition,
    print_fraction,
    print_payments,
    symbols_of,
)


@dataclass(frozen=True, slots=True)
class ExplainedOutcome:
    """A possible result: `kind` is "change", "nothing" or "noise"."""

    probability: float
    kind: str
    effects: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FailingLiteral:
    """A part of a condition that does not hold, and what holds instead."""

    literal: str
    instead: str


@dataclass(frozen=True, slots=True)
class OtherRule:
    """A rule of the action that does not apply: what of its condition fails, or which reference is
    unclear."""

    rule: str
    binding: Mapping[str, str]
    failing: tuple[FailingLiteral, ...]
    unclear: str | None


@dataclass(frozen=True, slots=True)
class DoneBefore:
    """An action before the one that is explained, the `effects` that it is taken to have had, and by which
    `rule`; None: by none that covers it."""

    action: str
    effects: tuple[str, ...]
    rule: str | None


@dataclass(frozen=True, slots=True)
class ExplanationResult:
    """What an action would do, and by which `rule`; None: by none, and the default rule says what happens.
    `after` are the actions before it, with the result that each is taken to have had."""

    action: str
    arguments: tuple[str, ...]
    after: tuple[DoneBefore, ...]
    rule: str | None
    outcomes: tuple[ExplainedOutcome, ...]
    other_rules: tuple[OtherRule, ...]
    text: str

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli explain --json` prints."""
        return fields_of(self, ("text",))

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        rows = tuple((f"{o.probability:g}", ", ".join(o.effects) or o.kind) for o in self.outcomes)
        called = _called(self.action, self.arguments)
        rule = "no rule covers it" if self.rule is None else f"rule {self.rule}"
        table = TextTable(("probability", "what happens"), rows, (1,)).html()
        return f"<div><p>{shown(called)}: {shown(rule)}</p>{table}{preformatted(self.text)}</div>"


def explain(
    domain: GivenDomain, problem: GivenProblem, action: str, *, after: str | Sequence[str] = ()
) -> ExplanationResult:
    """What an action like "join2(a1, a3)" would do in the initial state, and by which rule; if no rule covers
    it, what each of its rules lacks. `after` are actions that are done before, a text or a list: each has the
    likeliest of its results that change something. Raises Refused."""
    text = after if isinstance(after, str) else " ".join(after)
    return explanation(load_problem(problem, domain), action, text)


def explanation(given: LoadedProblem, action: str, after: str = "") -> ExplanationResult:
    """The same for a loaded problem; for a scene, the state is that of one look at its table."""
    looked, _ = seen(given, None, {})
    domain, problem = looked.domain, looked.problem
    name, arguments = read_action(action, domain, problem)
    before = list[DoneBefore]()
    with located_in(*given.sources):
        for call in read_actions(after, domain, problem):
            done, problem = _done(domain, problem, call)
            before.append(done)
        found = explained(domain, problem, name, arguments)
    return _result(domain, problem, found, before)


def _done(domain: Domain, problem: Problem, call: Call) -> tuple[DoneBefore, Problem]:
    """An action with the likeliest of its results that change something, and the problem after it."""
    found = explained(domain, problem, *call)
    outcomes = found.default if found.covering is None else found.covering.outcomes
    likely = max((o for o in outcomes if o.changes), key=lambda o: o.probability, default=None)
    changes = () if likely is None else likely.changes
    values = values_of(problem.state) | {
        (change.fact.symbol, change.fact.objects): change.fact.value for change in changes
    }
    state = frozenset(Fact(*fluent, value) for fluent, value in values.items() if value is not False)
    effects = tuple(effect_text(each.fact.symbol, each.fact.objects, each.fact.value) for each in changes)
    rule = None if found.covering is None else found.covering.name
    return DoneBefore(_called(*call), effects, rule), replace(problem, state=state)


def _called(action: str, arguments: Sequence[str]) -> str:
    return f"{action}({', '.join(arguments)})"


def _result(
    domain: Domain, problem: Problem, found: Explanation, before: Sequence[DoneBefore]
) -> ExplanationResult:
    symbols, covering = symbols_of(domain), found.covering
    outcomes = found.default if covering is None else covering.outcomes
    return ExplanationResult(
        found.action,
        tuple(found.arguments),
        tuple(before),
        None if covering is None else covering.name,
        tuple(ExplainedOutcome(float(o.probability), o.kind.value, tuple(_effects(o))) for o in outcomes),
        tuple(_other(attempt, symbols) for attempt in found.attempts),
        "\n".join(_lines(domain, problem, found, before)),
    )


def _other(attempt: Attempt, symbols: Mapping[str, Symbol]) -> OtherRule:
    failing = (FailingLiteral(print_condition((f.part,), symbols), _instead(f)) for f in attempt.failures)
    unclear = None if attempt.unclear is None else _unclear(attempt.unclear, symbols)
    return OtherRule(attempt.name, dict(attempt.binding), tuple(failing), unclear)


def _lines(
    domain: Domain, problem: Problem, found: Explanation, before: Sequence[DoneBefore]
) -> Iterator[str]:
    called = _called(found.action, found.arguments)
    for done in before:
        uncovered = ", since no rule covers it" if done.rule is None else ""
        yield f"after {done.action}: {', '.join(done.effects) or 'nothing has changed'}{uncovered}"
    if found.covering is not None:
        yield f"{called}: covered by rule {found.covering.name}{_binding(found.covering.binding)}"
        yield from (f"  {_outcome(outcome)}" for outcome in found.covering.outcomes)
    else:
        where = "then" if before else f"in the initial state of {problem.name}"
        yield f"{called}: no rule covers it {where}"
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
        yield from (f"    {reason}" for reason in _reasons(failure, symbols))
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
        case Quantified(variables=()):
            return "none of these holds"
        case Quantified(exists=exists):
            return "nothing fits" if exists else f"there is{_or(failure.witnesses)}"


def _reasons(failure: Failure, symbols: Mapping[str, Symbol]) -> Iterator[str]:
    """What a derived predicate lacks that should hold, and below it what that lacks in turn."""
    for reason in failure.because:
        yield f"since {print_condition((reason.part,), symbols)} fails: {_instead(reason)}"
        yield from (f"  {deeper}" for deeper in _reasons(reason, symbols))


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
    changes = [effect_text(c.fact.symbol, c.fact.objects, c.fact.value) for c in outcome.changes]
    return [*changes, *print_payments(Price(outcome.reward), Price(outcome.cost))]


def effect_text(symbol: str, objects: tuple[str, ...], value: Value) -> str:
    """What a fact becomes: `not dirt(a1)`, `level() := 3`."""
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
