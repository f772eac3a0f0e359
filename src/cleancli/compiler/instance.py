"""Instances: the rules of a domain for each tuple of objects that the unchangeable facts allow.

Guaranteed by the checker: names, arities and types fit, and every variable is bound.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from cleancli.compiler.evaluate import Binding, Key
from cleancli.compiler.join import Universe
from cleancli.language.diagnostics import Diagnostic
from cleancli.language.model import (
    Assign,
    Condition,
    Domain,
    ForAll,
    Literal,
    Outcome,
    Rule,
    Value,
)

Requirement = Mapping[Key, frozenset[Value]]
"""The values that a condition allows to each key it speaks of; no set is empty."""

Changes = Mapping[Key, frozenset[Value]]
"""The values that an outcome assigns; more than one value for a key is a conflict (E602)."""


@dataclass(frozen=True, slots=True)
class Instance:
    """A rule (its index in the domain) for some objects, with one `changes` per outcome.

    An outcome of probability 0 never happens, and so changes nothing.
    """

    rule: int
    objects: tuple[str, ...]
    required: Requirement
    changes: tuple[Changes, ...]


def instances(domain: Domain, universe: Universe) -> tuple[Instance, ...]:
    """Every instance whose condition the unchangeable facts do not rule out, by rule and objects."""
    found = []
    for index, rule in enumerate(domain.rules):
        for binding in universe.extensions(rule.variables, rule.condition, {}):
            required = requirement(rule.condition, binding, universe)
            if required is not None:
                changes = tuple(_changes(outcome, binding, universe) for outcome in rule.outcomes)
                objects = tuple(binding[variable] for variable in rule.variables)
                found.append(Instance(index, objects, required, changes))
    return tuple(sorted(found, key=lambda instance: (instance.rule, instance.objects)))


def requirement(condition: Condition, binding: Binding, universe: Universe) -> Requirement | None:
    """What the condition's changeable literals ask for; None where two of them contradict each other."""
    required: dict[Key, frozenset[Value]] = {}
    for part in condition:
        if isinstance(part, Literal) and not universe.is_static(part):
            key = universe.key(part.symbol, part.terms, binding)
            required[key] = required.get(key, part.values) & part.values
    return required if all(required.values()) else None


def changeable_forall(domain: Domain, universe: Universe) -> Iterator[Diagnostic]:
    """E601 for each `forall` whose condition a rule can change: its effects would depend on the state."""
    for rule, outcome in [(r, o) for r in domain.rules for o in r.outcomes]:
        conditions = (effect.condition for effect in outcome.effects if isinstance(effect, ForAll))
        for part in (part for condition in conditions for part in condition):
            if isinstance(part, Literal) and not universe.is_static(part):
                yield Diagnostic(
                    "E601",
                    f"the condition of a forall must stay as it is, but rules can change `{part.symbol}`",
                    outcome.probability_span or rule.span,
                    label=f"in this outcome of rule `{rule.name}`",
                    help=f"leave `{part.symbol}` out where that does no harm, or write one rule per case",
                )


def conflicting_effects(domain: Domain, found: Iterable[Instance]) -> Iterator[Diagnostic]:
    """E602 for each outcome that gives one key two values, shown by the first such instance."""
    reported = set()
    for instance in found:
        rule = domain.rules[instance.rule]
        for position, changes in enumerate(instance.changes):
            conflicts = sorted(key for key, values in changes.items() if len(values) > 1)
            if conflicts and (instance.rule, position) not in reported:
                reported.add((instance.rule, position))
                yield _conflict(rule, rule.outcomes[position], instance.objects, conflicts[0])


def _conflict(rule: Rule, outcome: Outcome, objects: tuple[str, ...], key: Key) -> Diagnostic:
    action = f"{rule.action}({', '.join(objects)})"
    return Diagnostic(
        "E602",
        f"for {action}, one outcome gives {key[0]}({', '.join(key[1])}) two values",
        outcome.probability_span or rule.span,
        label=f"in this outcome of rule `{rule.name}`",
        help="parameters may stand for the same object; if they must not, ask for it: `?a != ?b`",
    )


def _changes(outcome: Outcome, binding: Binding, universe: Universe) -> Changes:
    values: dict[Key, set[Value]] = defaultdict(set)
    if outcome.probability > 0:
        for assign, extended in _assigns(outcome, binding, universe):
            values[universe.key(assign.symbol, assign.terms, extended)].add(assign.value)
    return {key: frozenset(assigned) for key, assigned in values.items()}


def _assigns(outcome: Outcome, binding: Binding, universe: Universe) -> Iterator[tuple[Assign, Binding]]:
    for effect in outcome.effects:
        match effect:
            case Assign():
                yield effect, binding
            case ForAll(variables, condition, effects):
                for extended in universe.extensions(variables, condition, binding):
                    yield from ((assign, extended) for assign in effects)
