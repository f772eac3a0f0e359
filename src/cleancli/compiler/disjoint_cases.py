"""Cases: an instance divided by the state until its condition is one conjunction and its effects are known.

Guaranteed by `instances`: conditions hold literals over changeable keys alone. The cases of an instance
exclude each other, and so do those of its references (but for libPRADA's), so the rules of an action still do
(§3.3.2).
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from cleancli.compiler.fluents import Binding, Fluent, bind, shifted
from cleancli.compiler.ground_formula import (
    ALWAYS,
    Formula,
    Known,
    Possible,
    Requirement,
    anything,
    conjunction,
    disjoint,
    negation,
    restricted,
)
from cleancli.compiler.instances import Changes, Instance, StateEffect
from cleancli.compiler.partial_evaluation import Conditions, part_text
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.model import Assign, Domain, Rule, Value

CASE_LIMIT = 1_000
"""Most cases of one instance: a planner visits each of an action's ground rules at every step. Chosen."""


@dataclass(frozen=True, slots=True)
class Case:
    """A rule (its index in the domain) for some objects, where `required` holds; `changes` per outcome, and
    `binding` with the rule's references.

    `conflicts` are the keys that an outcome (its position) gives two values, or sets and shifts (E602).
    """

    rule: int
    objects: tuple[str, ...]
    binding: Binding
    required: Requirement
    changes: tuple[Changes, ...]
    conflicts: tuple[tuple[int, Fluent], ...] = ()


class TooManyCases(Exception):
    """An instance has more than `CASE_LIMIT` cases."""


def cases_of(
    instance: Instance, conditions: Conditions, known: Known, possible: Possible = anything
) -> list[Case]:
    """All cases of an instance that are possible, where `known` says what a key can ever be. Raises
    `TooManyCases`."""
    found = list(itertools.islice(_cases(instance, conditions, known, possible), CASE_LIMIT + 1))
    if len(found) > CASE_LIMIT:
        raise TooManyCases
    return found


def _cases(instance: Instance, conditions: Conditions, known: Known, possible: Possible) -> Iterator[Case]:
    effects = _settled(instance, conditions, known) if instance.effects else []
    for required in disjoint(instance.condition, known, possible):
        for decided, happening in _happening(required, effects, conditions, known, possible):
            yield from _with_effects(instance, decided, happening, conditions, known, possible)


def _with_effects(
    instance: Instance,
    required: Requirement,
    happening: Sequence[StateEffect],
    conditions: Conditions,
    known: Known,
    possible: Possible,
) -> Iterator[Case]:
    """The case in which just these effects happen, divided by the numbers that they shift."""
    changes = [dict(change) for change in instance.changes]
    amounts: dict[tuple[int, Fluent], int] = {}
    for each in happening:
        place, key = each.outcome, each.key
        if isinstance(each.effect, Assign):
            changes[place][key] = changes[place].get(key, frozenset()) | {each.effect.value}
        else:
            amounts[place, key] = amounts.get((place, key), 0) + each.effect.amount
    two_values = [(place, key) for place, each in enumerate(changes) for key in each if len(each[key]) > 1]
    both = [(place, key) for place, key in amounts if key in changes[place]]
    shifts = [(place, key, amount) for (place, key), amount in amounts.items() if (place, key) not in both]
    for decided, results in _shifted(required, shifts, conditions, known, possible):
        after = [dict(change) for change in changes]
        for place, key, value in results:
            after[place][key] = frozenset({value})
        yield Case(
            instance.rule, instance.objects, instance.binding, decided, tuple(after), (*two_values, *both)
        )


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


_Set = tuple[int, Fluent, Value]
"""An outcome's position, and the value that it gives a key."""

_Question = TypeVar("_Question")
_Answer = TypeVar("_Answer")


def _happening(
    required: Requirement,
    effects: Sequence[StateEffect],
    conditions: Conditions,
    known: Known,
    possible: Possible,
) -> Iterator[tuple[Requirement, list[StateEffect]]]:
    """The requirement divided until it says which effects happen."""

    def answers(here: Requirement, effect: StateEffect) -> Iterator[tuple[Requirement, StateEffect | None]]:
        yield from ((place, effect) for place in _where(here, effect.when, known, possible))
        opposite = negation(effect.when, conditions.all_values)
        yield from ((place, None) for place in _where(here, opposite, known, possible))

    return _divided(required, effects, answers)


def _shifted(
    required: Requirement,
    shifts: Sequence[tuple[int, Fluent, int]],
    conditions: Conditions,
    known: Known,
    possible: Possible,
) -> Iterator[tuple[Requirement, list[_Set]]]:
    """The requirement divided until it says what each number is after its shift (outcome, key and amount)."""

    def answers(
        here: Requirement, shift: tuple[int, Fluent, int]
    ) -> Iterator[tuple[Requirement, _Set | None]]:
        place, key, amount = shift
        values = here.get(key) or known(key)
        for before in sorted(values):
            after = shifted(conditions.universe.symbols[key[0]], before, amount)
            decided = here if len(values) == 1 else {**here, key: frozenset({before})}
            if possible(decided):
                yield decided, (place, key, after)

    return _divided(required, [shift for shift in shifts if shift[2] != 0], answers)


def _divided(
    required: Requirement,
    questions: Sequence[_Question],
    answers: Callable[[Requirement, _Question], Iterator[tuple[Requirement, _Answer | None]]],
) -> Iterator[tuple[Requirement, list[_Answer]]]:
    """The requirement divided by question after question, with the answers that are not None.

    An instance may have thousands of questions, so this does not recurse.
    """
    open_answers: list[Iterator[tuple[Requirement, _Answer | None]]] = [iter([(required, None)])]
    given: list[_Answer | None] = []
    while open_answers:
        found = next(open_answers[-1], None)
        del given[len(open_answers) - 1 :]
        if found is None:
            open_answers.pop()
            continue
        given.append(found[1])
        if len(open_answers) <= len(questions):
            open_answers.append(answers(found[0], questions[len(open_answers) - 1]))
        else:
            yield found[0], [answer for answer in given if answer is not None]


def _where(
    required: Requirement, formula: Formula | None, known: Known, possible: Possible
) -> Iterable[Requirement]:
    """The requirement where the formula holds, in cases that exclude each other."""
    if formula is None:
        return ()
    if formula.always:
        return (required,)
    both = conjunction((Formula(required), formula))
    return () if both is None else disjoint(both, known, possible)


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
