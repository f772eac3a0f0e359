"""What a rule means in one complete state, straight from the definitions; no grounding of anything else.

The planner grounds whole problems and never comes here. The learner does: it asks about one action in one
observed state at a time.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from cleancli.compiler.fluents import (
    Binding,
    Fluent,
    bind,
    name_of,
    names_of,
    parameters_of,
    shifted,
    values_of,
)
from cleancli.compiler.objects_by_type import ObjectsByType
from cleancli.language.model import (
    Assign,
    Condition,
    DerivedPredicate,
    Domain,
    Equality,
    ForAll,
    Literal,
    Object,
    Outcome,
    Quantified,
    Rule,
    Shift,
    State,
    Symbol,
    Term,
    Value,
    Variable,
)


class StateView:
    """A domain's symbols over one complete state, for asking what holds."""

    def __init__(self, domain: Domain, objects: Sequence[Object], state: State) -> None:
        self._rules = domain.rules
        self._symbols: dict[str, Symbol] = {symbol.name: symbol for symbol in domain.symbols}
        self._derived = {derived.name: derived for derived in domain.derived}
        everything = (*domain.constants, *objects)
        self._objects = ObjectsByType(domain, everything)
        self._values = values_of(state)

    def key(self, symbol: str, terms: Sequence[Term], binding: Binding) -> Fluent:
        """The symbol for the objects that `terms` stand for."""
        names = names_of(terms, binding)
        return symbol, self._symbols[symbol].canonical(names)

    def value(self, key: Fluent) -> Value | None:
        """The value now; None for a function that the state gives no value."""
        default = False if self._symbols[key[0]].is_predicate else None
        return self._values.get(key, default)

    def actual(self, literal: Literal, binding: Binding) -> Value | None:
        """The value of the literal's symbol, which may be a derived predicate."""
        derived = self._derived.get(literal.symbol)
        if derived is not None:
            return self._follows(derived, names_of(literal.terms, binding))
        return self.value(self.key(literal.symbol, literal.terms, binding))

    def holds(self, condition: Condition, binding: Binding) -> bool:
        """Whether every part of a condition holds, whose own variables are all bound."""
        return all(self._holds(part, binding) for part in condition)

    def _holds(self, part: Literal | Equality | Quantified, binding: Binding) -> bool:
        match part:
            case Equality(left, right, equal):
                return (name_of(left, binding) == name_of(right, binding)) is equal
            case Literal():
                return self.actual(part, binding) in part.values
            case Quantified(exists, variables, condition):
                found = next(self.extensions(variables, condition, binding), None)
                return (found is not None) is exists

    def extensions(
        self, variables: Sequence[Variable], condition: Condition, binding: Binding
    ) -> Iterator[Binding]:
        """Every extension of `binding` by the variables that satisfies the condition, in order of objects."""
        for names in itertools.product(*(self._objects[variable.type] for variable in variables)):
            extended = {**binding, **dict(zip(variables, names, strict=True))}
            if self.holds(condition, extended):
                yield extended

    def _follows(self, derived: DerivedPredicate, objects: tuple[str, ...]) -> bool:
        if derived.closure is None:
            binding = dict(zip(derived.parameters, objects, strict=True))
            return self.holds(derived.condition, binding)
        start, goal = objects
        return goal in self._reached(derived.closure, start)

    def _reached(self, predicate: str, start: str) -> set[str]:
        """The objects that one or more steps of a predicate of two parameters lead to."""
        source, target = parameters_of(predicate, self._symbols, self._derived)
        reached: set[str] = set()
        frontier = [start]
        while frontier:
            one = frontier.pop()
            if one in self._objects[source.type]:
                binding = {source: one}
                step = (Literal(predicate, (source, target), frozenset({True})),)
                steps = {extended[target] for extended in self.extensions((target,), step, binding)}
                frontier += sorted(steps - reached)
                reached |= steps
        return reached

    def covering(self, action: str, arguments: Sequence[str]) -> tuple[int, Binding] | None:
        """Index and binding of the one rule that covers these arguments here (§3.3.2); None for none.

        The binding includes the variables of the rule's deictic references.
        """
        for index, rule in enumerate(self._rules):
            if rule.action == action:
                binding = self._covers(rule, bind(rule, arguments))
                if binding is not None:
                    return index, binding
        return None

    def _covers(self, rule: Rule, binding: Binding) -> Binding | None:
        if not self.holds(rule.condition, binding):
            return None
        for reference in rule.references:
            found = list(
                itertools.islice(self.extensions(reference.variables, reference.condition, binding), 2)
            )
            if len(found) != 1:
                return None
            binding = found[0]
        return binding

    def changes(self, outcome: Outcome, binding: Binding) -> dict[Fluent, Value]:
        """What the outcome sets when its rule is applied in this state; a number without value stays so.

        Shifts of one number add up, and stop at its bounds after that. Raises `ConflictError`.
        """
        changes: dict[Fluent, Value] = {}
        amounts: dict[Fluent, int] = {}
        for effect, bound in self._happening(outcome, binding):
            key = self.key(effect.symbol, effect.terms, bound)
            if isinstance(effect, Shift):
                amounts[key] = amounts.get(key, 0) + effect.amount
            elif changes.setdefault(key, effect.value) != effect.value:
                raise ConflictError(key)
        for key, amount in amounts.items():
            if key in changes:
                raise ConflictError(key)
            if (before := self.value(key)) is not None:
                changes[key] = shifted(self._symbols[key[0]], before, amount)
        return changes

    def _happening(self, outcome: Outcome, binding: Binding) -> Iterator[tuple[Assign | Shift, Binding]]:
        """The outcome's effects, those of a `forall` for each binding that fits."""
        for effect in outcome.effects:
            match effect:
                case ForAll(variables, condition, effects):
                    for inner in self.extensions(variables, condition, binding):
                        yield from ((each, inner) for each in effects)
                case _:
                    yield effect, binding


class ConflictError(ValueError):
    """An outcome gives `key` two values, or sets and shifts it."""

    def __init__(self, key: Fluent) -> None:
        super().__init__(f"{key[0]}({', '.join(key[1])})")
        self.key = key
