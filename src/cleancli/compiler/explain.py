"""Why an action would do what it does in a problem's initial state: the rule that covers it, or what each
of its rules lacks.

Guaranteed by the checker: the domain and the problem fit together. Guaranteed by the caller: the action is
declared, and the arguments are objects of its parameters' types.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import repeat

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Binding, Fluent, bind, names_of
from cleancli.compiler.lifted_state import StateView
from cleancli.compiler.prices import comes_to
from cleancli.language.model import (
    Condition,
    Domain,
    Equality,
    Fact,
    Literal,
    Outcome,
    OutcomeKind,
    Problem,
    Quantified,
    Reference,
    Rule,
    Value,
)

Bound = tuple[tuple[str, str], ...]
"""Names of variables, without `?`, and of the objects they stand for, in the order of binding."""


@dataclass(frozen=True, slots=True)
class Failure:
    """A part of a condition that does not hold.

    `objects` are what the part's terms stand for (none for a quantified part), and `actual` is the value of a
    literal's symbol. For a quantified part, `witnesses` are the bindings that satisfy its inner condition:
    none where one is asked for, some where none may exist. `because` says what a derived predicate lacks that
    should hold.
    """

    part: Literal | Equality | Quantified
    objects: tuple[str, ...] = ()
    actual: Value | None = None
    witnesses: tuple[Bound, ...] = ()
    because: tuple[Failure, ...] = ()


@dataclass(frozen=True, slots=True)
class UnclearReference:
    """A deictic reference that not exactly one binding fits, with those that do (§3.3.2)."""

    reference: Reference
    fitting: tuple[Bound, ...]


@dataclass(frozen=True, slots=True)
class Attempt:
    """A rule of the action that does not cover the state: all of its condition's failures, or, where the
    condition holds, the first reference that is unclear."""

    rule: int
    name: str
    binding: Bound
    failures: tuple[Failure, ...]
    unclear: UnclearReference | None = None


@dataclass(frozen=True, slots=True)
class FactChange:
    """A value that an outcome sets, and what it is before; `before` is None where the state has none."""

    fact: Fact
    before: Value | None


@dataclass(frozen=True, slots=True)
class OutcomeHere:
    """An outcome as it would be in this state; `changes` are sorted and leave out what is there already.
    `reward` and `cost` are what those of the `Outcome` come to."""

    probability: Fraction
    kind: OutcomeKind
    changes: tuple[FactChange, ...]
    reward: Fraction
    cost: Fraction


@dataclass(frozen=True, slots=True)
class Covering:
    """The rule that covers the state, with its references bound."""

    rule: int
    name: str
    binding: Bound
    outcomes: tuple[OutcomeHere, ...]


@dataclass(frozen=True, slots=True)
class Explanation:
    """What an action would do; `covering` is None where the default rule says it, by its `default` outcomes.

    `attempts` are the action's other rules, in the domain's order.
    """

    action: str
    arguments: tuple[str, ...]
    covering: Covering | None
    attempts: tuple[Attempt, ...]
    default: tuple[OutcomeHere, ...]


def explain(domain: Domain, problem: Problem, action: str, arguments: Sequence[str]) -> Explanation:
    """Which rule covers the action in the initial state, and why the others do not.

    Raises `Refused` (E602) where one of its outcomes gives something two values there.
    """
    view = StateView(domain, problem.objects, problem.state)
    found = view.covering(action, arguments)
    covering = None
    if found is not None:
        rule = domain.rules[found[0]]
        changes = results(view.rules, view.state, found[0], tuple(found[1].values()))
        outcomes = tuple(map(_outcome_here, repeat(view), rule.outcomes, changes, repeat(found[1])))
        covering = Covering(found[0], rule.name, _bound(found[1]), outcomes)
    attempts = tuple(
        _attempt(domain, view, index, bind(rule, arguments))
        for index, rule in enumerate(domain.rules)
        if rule.action == action and (found is None or index != found[0])
    )
    default = tuple(_outcome_here(view, outcome, {}, {}) for outcome in domain.default)
    return Explanation(action, tuple(arguments), covering, attempts, () if covering else default)


def _outcome_here(
    view: StateView, outcome: Outcome, changes: Mapping[Fluent, Value], binding: Binding
) -> OutcomeHere:
    listed = tuple(
        FactChange(Fact(*key, changes[key]), view.value(key))
        for key in sorted(changes)
        if view.value(key) != changes[key]
    )
    paid = (comes_to(price, binding, view.state.values) for price in (outcome.reward, outcome.cost))
    return OutcomeHere(outcome.probability, outcome.kind, listed, *paid)


def _attempt(domain: Domain, view: StateView, index: int, binding: Binding) -> Attempt:
    rule = domain.rules[index]
    failures = tuple(_failures(domain, view, rule.condition, binding))
    unclear = None if failures else _unclear(view, rule, binding)
    return Attempt(index, rule.name, _bound(binding), failures, unclear)


def _unclear(view: StateView, rule: Rule, binding: Binding) -> UnclearReference | None:
    for reference in rule.references:
        fitting = list(view.extensions(reference.variables, reference.condition, binding))
        if len(fitting) != 1:
            bound = tuple(_bound({v: found[v] for v in reference.variables}) for found in fitting)
            return UnclearReference(reference, bound)
        binding = fitting[0]
    return None


def _failures(domain: Domain, view: StateView, condition: Condition, binding: Binding) -> Iterator[Failure]:
    for part in condition:
        if view.holds((part,), binding):
            continue
        match part:
            case Equality(left, right):
                yield Failure(part, names_of((left, right), binding))
            case Literal(terms=terms):
                because = tuple(_missing(domain, view, part, binding))
                yield Failure(part, names_of(terms, binding), view.actual(part, binding), because=because)
            case Quantified(variables=variables, condition=inner):
                found = view.extensions(variables, inner, binding)
                witnesses = tuple(_bound({v: extended[v] for v in variables}) for extended in found)
                yield Failure(part, witnesses=witnesses)


def _missing(domain: Domain, view: StateView, literal: Literal, binding: Binding) -> Iterator[Failure]:
    """What a derived predicate lacks that should hold; a closure just lacks a path."""
    derived = next((d for d in domain.derived if d.name == literal.symbol), None)
    if derived is not None and True in literal.values:
        inner = dict(zip(derived.parameters, names_of(literal.terms, binding), strict=True))
        yield from _failures(domain, view, derived.condition, inner)


def _bound(binding: Binding) -> Bound:
    return tuple((variable.name, name) for variable, name in binding.items())
