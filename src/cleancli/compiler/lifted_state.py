"""What a rule means in one complete state, straight from the definitions; no grounding of anything else.

The planner grounds whole problems and never comes here. The learner does: it asks about one action in one
observed state at a time.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cleancli.compiler.fluents import Binding, Fluent, Values, names_of, values_of
from cleancli.compiler.lifted import Changes, Extender, Guard, Lifted, LiftedState, Names, Test, further
from cleancli.compiler.objects_by_type import ObjectsByType
from cleancli.language.model import (
    Assign,
    Condition,
    Domain,
    ForAll,
    Literal,
    Object,
    Rule,
    Shift,
    State,
    Value,
    Variable,
)


@dataclass(frozen=True, slots=True)
class LiftedRule:
    """A rule as functions of a state; `variables` are its own and then those of its references.

    What the outcomes set follows from what the variables stand for and from what satisfies the `guards`, the
    conditions of their `forall`s; where one of them `shifts` a number, from the values before as well.
    """

    variables: tuple[Variable, ...]
    condition: Test
    references: tuple[Extender, ...]
    changes: tuple[Changes, ...]
    guards: tuple[Guard, ...]
    shifts: bool

    def covers(self, state: LiftedState, names: Names) -> Names | None:
        """The objects that all variables stand for; None where the rule does not cover these arguments."""
        if not self.condition(state, names):
            return None
        for extended in self.references:
            found = list(itertools.islice(extended(state, names), 2))
            if len(found) != 1:
                return None
            (names,) = found
        return names


class LiftedRules:
    """A domain's rules, each made into functions when it is first asked for."""

    def __init__(self, domain: Domain) -> None:
        self.domain = domain
        self.meaning = Lifted(domain)
        # Of the state before: the next one mostly has the same objects.
        self._objects: tuple[Object, ...] = ()
        self._by_type = ObjectsByType(domain, domain.constants)
        self._lifted: dict[int, LiftedRule] = {}
        self._numbers: dict[str, list[int]] = {}
        for number, rule in enumerate(domain.rules):
            self._numbers.setdefault(rule.action, []).append(number)

    def state(self, objects: tuple[Object, ...], values: Values) -> LiftedState:
        """A state of the domain; the objects are those beside its constants."""
        if objects is not self._objects:
            self._by_type = ObjectsByType(self.domain, (*self.domain.constants, *objects))
            self._objects = objects
        return LiftedState(values, self._by_type, {})

    def covering(self, state: LiftedState, action: str, arguments: Names) -> tuple[int, Names] | None:
        """The one rule that covers these arguments (§3.3.2), and what its variables stand for; or None."""
        for number in self._numbers.get(action, ()):
            names = self[number].covers(state, arguments)
            if names is not None:
                return number, names
        return None

    def __getitem__(self, number: int) -> LiftedRule:
        if number not in self._lifted:
            self._lifted[number] = _lifted(self.meaning, self.domain.rules[number])
        return self._lifted[number]


def _lifted(meaning: Lifted, rule: Rule) -> LiftedRule:
    slots = further({}, rule.variables)
    condition, references = meaning.test(rule.condition, slots), []
    for reference in rule.references:
        references.append(meaning.extender(reference.variables, reference.condition, slots))
        slots = further(slots, reference.variables)
    changes = tuple(meaning.changes(outcome, slots) for outcome in rule.outcomes)
    effects = [effect for outcome in rule.outcomes for effect in outcome.effects]
    foralls = {(each.variables, each.condition): each for each in effects if isinstance(each, ForAll)}
    guards = tuple(meaning.guard(each, slots) for each in foralls.values())
    return LiftedRule(tuple(slots), condition, tuple(references), changes, guards, any(map(_shifts, effects)))


def _shifts(effect: Assign | Shift | ForAll) -> bool:
    return isinstance(effect, Shift) or (isinstance(effect, ForAll) and any(map(_shifts, effect.effects)))


class StateView:
    """A domain's symbols over one complete state, for asking what holds."""

    def __init__(self, domain: Domain, objects: Sequence[Object], state: State) -> None:
        self.rules = LiftedRules(domain)
        self.state = self.rules.state(tuple(objects), values_of(state))

    def value(self, key: Fluent) -> Value | None:
        """The value now; None for a function that the state gives no value."""
        return self.state.values.get(key, self.rules.meaning.missing(key[0]))

    def actual(self, literal: Literal, binding: Binding) -> Value | None:
        """The value of the literal's symbol, which may be a derived predicate."""
        meaning, names = self.rules.meaning, names_of(literal.terms, binding)
        if meaning.is_derived(literal.symbol):
            return meaning.follows(literal.symbol)(self.state, names)
        return self.value(meaning.fluent(literal.symbol, names))

    def holds(self, condition: Condition, binding: Binding) -> bool:
        """Whether every part of a condition holds, whose own variables are all bound."""
        test = self.rules.meaning.test(condition, further({}, tuple(binding)))
        return test(self.state, tuple(binding.values()))

    def extensions(
        self, variables: Sequence[Variable], condition: Condition, binding: Binding
    ) -> Iterator[Binding]:
        """Every extension of `binding` by the variables that satisfies the condition, in order of objects."""
        slots = further({}, tuple(binding))
        extended = self.rules.meaning.extender(variables, condition, slots)
        for names in extended(self.state, tuple(binding.values())):
            yield {**binding, **dict(zip(variables, names[len(slots) :], strict=True))}

    def covering(self, action: str, arguments: Sequence[str]) -> tuple[int, Binding] | None:
        """Index and binding of the one rule that covers these arguments here (§3.3.2); None for none.

        The binding includes the variables of the rule's deictic references.
        """
        found = self.rules.covering(self.state, action, tuple(arguments))
        if found is None:
            return None
        number, names = found
        return number, dict(zip(self.rules[number].variables, names, strict=True))
