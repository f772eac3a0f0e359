"""Instances: the rules of a domain for each tuple of objects that the unchangeable facts allow.

Guaranteed by the checker: names, arities and types fit, and every variable is bound. Rules that are plain are
grounded by columns (plain_rules.py), the others, and small ones, one instance after the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cleancli.compiler.column_join import ColumnJoin
from cleancli.compiler.fluents import Binding, Fluent, bind
from cleancli.compiler.ground_formula import ALWAYS, Formula, conjunction, negation
from cleancli.compiler.partial_evaluation import ClosureTooLargeError, Conditions
from cleancli.compiler.plain_rules import PlainGrounding, PlainInstances, Vocabulary, plain_conjunctions
from cleancli.language.diagnostics.diagnostic import Diagnostic, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Assign, Domain, ForAll, Outcome, Reference, Rule, Shift, Value

Changes = Mapping[Fluent, frozenset[Value]]
"""The values that an outcome assigns; more than one value for a key is a conflict (E602)."""


FEW = 12
"""Instances of a rule up to which one after the other is faster than by columns. Measured with
benchmarks/planning.nid: a rule by columns takes as long as ten."""


@dataclass(frozen=True, slots=True)
class StateEffect:
    """An effect of an outcome (its position in the rule) that depends on the state before the action: whether
    it happens (`when`), or, if it shifts a number, what it is after that."""

    outcome: int
    key: Fluent
    effect: Assign | Shift
    when: Formula


@dataclass(frozen=True, slots=True)
class Instance:
    """A rule (its index in the domain) for some objects and one binding of its references, which is all in
    `binding`.

    `changes` has one entry per outcome, of what does not depend on the state; `effects` is the rest. An
    outcome of probability 0 never happens, and so changes nothing.
    """

    rule: int
    objects: tuple[str, ...]
    binding: Binding
    condition: Formula
    changes: tuple[Changes, ...]
    effects: tuple[StateEffect, ...]


_NONE: frozenset[Value] = frozenset()


@dataclass(frozen=True, slots=True)
class Instances:
    """Those of all rules, by rule and objects: plain ones by columns, whose words are of the `vocabulary`,
    and others."""

    plain: tuple[PlainInstances, ...]
    others: tuple[Instance, ...]
    vocabulary: Vocabulary


def instances(domain: Domain, conditions: Conditions, join: ColumnJoin, *, compat: bool = False) -> Instances:
    """Every instance whose condition the unchangeable facts do not rule out.

    With `compat`, a binding of the references need not be the only one that fits. Raises `Refused` (E606)
    where a closure has too many paths.
    """
    grounding = PlainGrounding(conditions.universe, join)
    plain: list[PlainInstances] = []
    others: list[Instance] = []
    for index, rule in enumerate(domain.rules):
        objects = join.bindings(rule.variables, rule.condition)
        cases = plain_conjunctions(rule, conditions.universe) if len(objects) > FEW else None
        if cases is not None:
            plain += grounding.instances(index, rule, cases, objects)
            continue
        for row in objects.tolist():
            try:
                others += instances_of(index, rule, join.named(row), conditions, compat=compat)
            except ClosureTooLargeError as error:
                raise Refused([closure_refused(error, rule.span, f"in rule `{rule.name}`")]) from None
    return Instances(tuple(plain), tuple(others), grounding.vocabulary)


def closure_refused(error: ClosureTooLargeError, span: Span | None, label: str) -> Diagnostic:
    """E606, with the objects that too many paths lie between."""
    return Diagnostic(
        "E606",
        f"there are too many ways in which `{error}` may come to hold",
        span,
        label=label,
        help="a closure over what rules can change is written out path by path: take fewer objects",
    )


def instances_of(
    index: int, rule: Rule, objects: tuple[str, ...], conditions: Conditions, *, compat: bool = False
) -> Iterator[Instance]:
    """Those of a rule for objects that the unchangeable facts allow, one for each binding of its references.
    Raises `ClosureTooLargeError`."""
    binding = bind(rule, objects)
    formula = conditions.remaining(rule.condition, binding)
    if formula is None:
        return
    for bound, whole in _references(rule.references, binding, formula, conditions, compat):
        changes, effects = _divided(rule.outcomes, bound, conditions)
        yield Instance(index, objects, bound, whole, changes, effects)


def _divided(
    outcomes: Sequence[Outcome], binding: Binding, conditions: Conditions
) -> tuple[tuple[Changes, ...], tuple[StateEffect, ...]]:
    """What the outcomes change whatever the state, and their effects that depend on it."""
    changes: list[dict[Fluent, frozenset[Value]]] = [{} for _ in outcomes]
    effects: list[StateEffect] = []
    for position, outcome in enumerate(outcomes):
        for key, effect, when in _effects(outcome, binding, conditions):
            if isinstance(effect, Assign) and when is ALWAYS:
                assigned = changes[position]
                assigned[key] = assigned.get(key, _NONE) | {effect.value}
            else:
                effects.append(StateEffect(position, key, effect, when))
    return tuple(changes), tuple(effects)


def _references(
    references: Sequence[Reference], binding: Binding, formula: Formula, conditions: Conditions, compat: bool
) -> Iterator[tuple[Binding, Formula]]:
    """Every binding of the references, with the condition that it fits, and alone unless `compat`."""
    if not references:
        yield binding, formula
        return
    first, *others = references
    fitting = list(conditions.extensions(first.variables, first.condition, binding))
    for index, (extended, fits) in enumerate(fitting):
        rivals = (rival for place, (_, rival) in enumerate(fitting) if place != index and not compat)
        alone = (negation(rival, conditions.all_values) for rival in rivals)
        whole = conjunction((formula, fits, *alone))
        if whole is not None:
            yield from _references(others, extended, whole, conditions, compat)


def _effects(
    outcome: Outcome, binding: Binding, conditions: Conditions
) -> Iterator[tuple[Fluent, Assign | Shift, Formula]]:
    if outcome.probability == 0:
        return
    for effect in outcome.effects:
        match effect:
            case ForAll(variables, condition, effects):
                for extended, formula in conditions.extensions(variables, condition, binding):
                    for inner in effects:
                        key = conditions.universe.key(inner.symbol, inner.terms, extended)
                        yield key, inner, ALWAYS if formula.always else formula
            case _:
                key = conditions.universe.key(effect.symbol, effect.terms, binding)
                yield key, effect, ALWAYS
