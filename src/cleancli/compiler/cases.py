"""Cases: an instance divided by the state until its condition is one conjunction and its effects are known.

Guaranteed by `instances`: conditions hold literals over changeable keys alone. The cases of an instance
exclude each other, and so do those of its references (but for libPRADA's), so the rules of an action still do
(§3.3.2).
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from cleancli.compiler.condition import Conditions, part_text
from cleancli.compiler.evaluate import Key, bind, shifted
from cleancli.compiler.formula import (
    ALWAYS,
    Formula,
    Known,
    Requirement,
    conjunction,
    disjoint,
    negation,
    restricted,
)
from cleancli.compiler.instance import Changes, Instance, StateEffect
from cleancli.language.diagnostics import Diagnostic
from cleancli.language.model import Assign, Domain, Rule, Value

CASE_LIMIT = 1_000
"""Most cases of one instance: a planner visits each of an action's ground rules at every step. Chosen."""


@dataclass(frozen=True, slots=True)
class Case:
    """A rule (its index in the domain) for some objects, where `required` holds; `changes` per outcome."""

    rule: int
    objects: tuple[str, ...]
    required: Requirement
    changes: tuple[Changes, ...]


class TooManyCases(Exception):
    """An instance has more than `CASE_LIMIT` cases."""


def cases_of(instance: Instance, conditions: Conditions, known: Known) -> list[Case]:
    """All cases of an instance, where `known` says what a key can ever be. Raises `TooManyCases`."""
    found = list(itertools.islice(_cases(instance, conditions, known), CASE_LIMIT + 1))
    if len(found) > CASE_LIMIT:
        raise TooManyCases
    return found


def _cases(instance: Instance, conditions: Conditions, known: Known) -> Iterator[Case]:
    effects = _settled(instance, conditions, known) if instance.effects else []
    for required in disjoint(instance.condition, known):
        if not effects:
            yield Case(instance.rule, instance.objects, required, instance.changes)
            continue
        for decided, assigned in _decided(required, effects, conditions, known):
            changes = [dict(change) for change in instance.changes]
            for position, key, value in assigned:
                changes[position][key] = changes[position].get(key, frozenset()) | {value}
            yield Case(instance.rule, instance.objects, decided, tuple(changes))


def _settled(instance: Instance, conditions: Conditions, known: Known) -> list[StateEffect]:
    """The effects; those that would assign what is there anyway, where they don't happen, always happen.

    `forall ?m - area: dirt(?m) => not dirt(?m)` needs no cases then.
    """
    targets = Counter((effect.outcome, effect.key) for effect in instance.effects)
    targets.update((place, key) for place, changes in enumerate(instance.changes) for key in changes)
    found = []
    for effect in instance.effects:
        if isinstance(effect.effect, Assign) and targets[effect.outcome, effect.key] == 1:
            others = conditions.all_values(effect.key) - {effect.effect.value}
            elsewhere = negation(effect.when, conditions.all_values)
            differs = conjunction((instance.condition, elsewhere, Formula({effect.key: others})))
            if differs is None or next(iter(disjoint(differs, known)), None) is None:
                effect = replace(effect, when=ALWAYS)
        found.append(effect)
    return found


_Assigned = tuple[int, Key, Value]
"""An outcome's position, and the value that it gives a key."""


def _decided(
    required: Requirement, effects: Sequence[StateEffect], conditions: Conditions, known: Known
) -> Iterator[tuple[Requirement, tuple[_Assigned, ...]]]:
    """The requirement divided until it says of each effect what it assigns, if anything."""
    if not effects:
        yield required, ()
        return
    first, others = effects[0], effects[1:]
    for answered, value in _answers(required, first, conditions, known):
        assigned = () if value is None else ((first.outcome, first.key, value),)
        for decided, more in _decided(answered, others, conditions, known):
            yield decided, (*assigned, *more)


def _answers(
    required: Requirement, effect: StateEffect, conditions: Conditions, known: Known
) -> Iterator[tuple[Requirement, Value | None]]:
    """Where the effect assigns what; None where it does not happen."""
    for place in _where(required, effect.when, known):
        if isinstance(effect.effect, Assign):
            yield place, effect.effect.value
            continue
        symbol = conditions.universe.symbols[effect.key[0]]
        values = place.get(effect.key) or known(effect.key)
        for before in sorted(values):
            here = place if len(values) == 1 else {**place, effect.key: frozenset({before})}
            yield here, shifted(symbol, before, effect.effect.amount)
    for place in _where(required, negation(effect.when, conditions.all_values), known):
        yield place, None


def _where(required: Requirement, formula: Formula | None, known: Known) -> Iterable[Requirement]:
    """The requirement where the formula holds, in cases that exclude each other."""
    if formula is None:
        return ()
    if formula.always:
        return (required,)
    both = conjunction((Formula(required), formula))
    return () if both is None else disjoint(both, known)


def too_many_cases(domain: Domain, instance: Instance, conditions: Conditions, known: Known) -> Diagnostic:
    """E605, with the part of the rule that has most cases of its own to blame."""
    rule = domain.rules[instance.rule]
    return Diagnostic(
        "E605",
        f"for {rule.action}({', '.join(instance.objects)}), rule `{rule.name}` falls into more than"
        f" {CASE_LIMIT:,} cases, most of them because of {_blame(rule, instance, conditions, known)}",
        rule.span,
        label="each case would become a rule of its own",
        help="ask for less at once, take fewer objects, or leave to the facts what does not change",
    )


def _blame(rule: Rule, instance: Instance, conditions: Conditions, known: Known) -> str:
    cases: Counter[str] = Counter()
    binding = bind(rule, instance.objects)
    for part in rule.condition:
        cases[f"`{part_text(part)}`"] += _number(conditions.formula((part,), binding), known)
    for reference in rule.references[:1]:
        fitting = conditions.extensions(reference.variables, reference.condition, binding)
        text = ", ".join(part_text(part) for part in reference.condition)
        cases[f"the reference `{text}`"] += sum(_number(formula, known) for _, formula in fitting)
    for effect in instance.effects:
        values = 1 if isinstance(effect.effect, Assign) else len(known(effect.key))
        # Effects multiply, so each counts with the power of the cases that it adds to the others.
        cases[f"the effects on `{effect.key[0]}`"] += 2 * _number(effect.when, known) * values
    return cases.most_common(1)[0][0]


def _number(formula: Formula | None, known: Known) -> int:
    if formula is None or (left := restricted(formula, known)) is None:
        return 0
    return sum(1 for _ in itertools.islice(disjoint(left, known), CASE_LIMIT + 1))
