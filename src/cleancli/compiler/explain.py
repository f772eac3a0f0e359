"""Why an action does what it does in one state: the rule that covers it, or what each of its rules lacks.

Guaranteed by the checker: names, arities and types fit. The caller has checked that the action is declared
and that the arguments are objects of its parameters' types.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.compiler.evaluate import Binding, StateView, bind
from cleancli.language.model import (
    Domain,
    Equality,
    Fact,
    Literal,
    Outcome,
    OutcomeKind,
    Problem,
    Rule,
    Term,
    Value,
    Variable,
)

Bound = tuple[tuple[str, str], ...]
"""Variables, without `?`, with the objects that they stand for."""


@dataclass(frozen=True, slots=True)
class Failure:
    """A part of a condition that does not hold: what its terms stand for, and for a literal the value now."""

    part: Literal | Equality
    objects: tuple[str, ...]
    actual: Value | None = None


@dataclass(frozen=True, slots=True)
class Attempt:
    """A rule of the action that does not cover the state, with all that fails of its condition."""

    rule: int
    name: str
    binding: Bound
    failures: tuple[Failure, ...]


@dataclass(frozen=True, slots=True)
class Change:
    """A fact that an outcome sets, and its value before."""

    fact: Fact
    before: Value | None


@dataclass(frozen=True, slots=True)
class OutcomeHere:
    """An outcome as it would be in the state; `changes` leave out what is so already."""

    probability: Fraction
    kind: OutcomeKind
    changes: tuple[Change, ...]


@dataclass(frozen=True, slots=True)
class Covering:
    """The rule that covers the state, and what may come of it."""

    rule: int
    name: str
    binding: Bound
    outcomes: tuple[OutcomeHere, ...]


@dataclass(frozen=True, slots=True)
class Explanation:
    """`covering` is None where no rule covers the state, and so the `default` outcomes apply; `attempts` are
    the action's rules that do not cover it, in the domain's order."""

    action: str
    arguments: tuple[str, ...]
    covering: Covering | None
    attempts: tuple[Attempt, ...]
    default: tuple[OutcomeHere, ...]


def explain(domain: Domain, problem: Problem, action: str, arguments: Sequence[str]) -> Explanation:
    """What the action would do in the problem's initial state, and why."""
    view = StateView(domain, problem.objects, problem.state)
    covering, attempts = None, []
    for index, rule in enumerate(domain.rules):
        if rule.action != action:
            continue
        binding = bind(rule, arguments)
        failures = tuple(_failures(rule, view, binding))
        if failures:
            attempts.append(Attempt(index, rule.name, _bound(binding), failures))
        else:
            outcomes = tuple(_here(outcome, view, binding) for outcome in rule.outcomes)
            covering = Covering(index, rule.name, _bound(binding), outcomes)
    default = () if covering else tuple(_here(outcome, view, {}) for outcome in domain.default)
    return Explanation(action, tuple(arguments), covering, tuple(attempts), default)


def _failures(rule: Rule, view: StateView, binding: Binding) -> Iterator[Failure]:
    for part in rule.condition:
        if view.holds((part,), binding):
            continue
        match part:
            case Equality(left, right):
                yield Failure(part, _names((left, right), binding))
            case Literal(symbol, terms):
                yield Failure(part, _names(terms, binding), view.value(view.key(symbol, terms, binding)))


def _here(outcome: Outcome, view: StateView, binding: Binding) -> OutcomeHere:
    changes = sorted(view.changes(outcome, binding).items())
    listed = tuple(
        Change(Fact(*key, value), view.value(key)) for key, value in changes if value != view.value(key)
    )
    return OutcomeHere(outcome.probability, outcome.kind, listed)


def _names(terms: Sequence[Term], binding: Binding) -> tuple[str, ...]:
    return tuple(binding[term] if isinstance(term, Variable) else term.name for term in terms)


def _bound(binding: Binding) -> Bound:
    return tuple((variable.name, name) for variable, name in binding.items())
