"""What a rule means in one complete state, straight from the definitions; no grounding of anything else.

The planner grounds whole problems and never comes here. The learner does: it asks about one action in one
observed state at a time.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence

from cleancli.language.model import (
    Assign,
    Condition,
    Domain,
    Equality,
    Fact,
    ForAll,
    Literal,
    Object,
    Outcome,
    Rule,
    State,
    Symbol,
    Term,
    Value,
    Variable,
)

Binding = Mapping[Variable, str]
"""Names of the objects that variables stand for."""

Key = tuple[str, tuple[str, ...]]
"""A symbol for some objects, in canonical order: what has a value in a state."""


def values_of(state: State) -> dict[Key, Value]:
    """The state as a lookup; a predicate that is missing is false."""
    return {(fact.symbol, fact.objects): fact.value for fact in state}


class StateView:
    """A domain's symbols over one complete state, for asking what holds."""

    def __init__(self, domain: Domain, objects: Sequence[Object], state: State) -> None:
        self._domain = domain
        self._symbols: dict[str, Symbol] = {symbol.name: symbol for symbol in domain.symbols}
        self._objects = (*domain.constants, *objects)
        self._values = values_of(state)

    def key(self, symbol: str, terms: Sequence[Term], binding: Binding) -> Key:
        """The symbol for the objects that `terms` stand for."""
        names = tuple(_name(term, binding) for term in terms)
        return symbol, self._symbols[symbol].canonical(names)

    def value(self, key: Key) -> Value | None:
        """The value now; None for a function that the state gives no value."""
        default = False if self._symbols[key[0]].is_predicate else None
        return self._values.get(key, default)

    def holds(self, condition: Condition, binding: Binding) -> bool:
        """Whether every literal and equality of a fully bound condition holds."""
        return all(self._holds(part, binding) for part in condition)

    def _holds(self, part: Literal | Equality, binding: Binding) -> bool:
        match part:
            case Equality(left, right, equal):
                return (_name(left, binding) == _name(right, binding)) is equal
            case Literal(symbol, terms, values):
                return self.value(self.key(symbol, terms, binding)) in values

    def covering_rule(self, action: str, arguments: Sequence[str]) -> int | None:
        """Index of the one rule that covers these arguments here (rules exclude each other, §3.3.2)."""
        for index, rule in enumerate(self._domain.rules):
            if rule.action == action and self.holds(rule.condition, bind(rule, arguments)):
                return index
        return None

    def changes(self, outcome: Outcome, binding: Binding) -> dict[Key, Value]:
        """What the outcome sets when its rule is applied in this state."""
        changes: dict[Key, Value] = {}
        for effect in outcome.effects:
            match effect:
                case Assign(symbol, terms, value):
                    changes[self.key(symbol, terms, binding)] = value
                case ForAll(variables, condition, assigns):
                    for inner in self._extensions(variables, binding):
                        if self.holds(condition, inner):
                            changes |= {self.key(a.symbol, a.terms, inner): a.value for a in assigns}
        return changes

    def _extensions(self, variables: Sequence[Variable], binding: Binding) -> Iterator[Binding]:
        candidates = [
            [o.name for o in self._objects if self._domain.is_a(o.type, variable.type)]
            for variable in variables
        ]
        for names in itertools.product(*candidates):
            yield {**binding, **dict(zip(variables, names, strict=True))}


def bind(rule: Rule, arguments: Sequence[str]) -> Binding:
    """The rule's variables, in the action's order, as the arguments."""
    return dict(zip(rule.variables, arguments, strict=True))


def changeable_symbols(domain: Domain) -> frozenset[str]:
    """Names of the symbols that some outcome of some rule sets; the others stay as they were observed."""
    changed: set[str] = set()
    for rule in domain.rules:
        for outcome in rule.outcomes:
            for effect in outcome.effects:
                assigns = effect.effects if isinstance(effect, ForAll) else (effect,)
                changed.update(assign.symbol for assign in assigns)
    return frozenset(changed)


def canonical_state(domain: Domain, facts: Sequence[Fact]) -> State:
    """The facts with symmetric symbols in canonical order and false predicates left out."""
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    return frozenset(
        Fact(fact.symbol, symbols[fact.symbol].canonical(fact.objects), fact.value)
        for fact in facts
        if fact.value is not False
    )


def _name(term: Term, binding: Binding) -> str:
    return binding[term] if isinstance(term, Variable) else term.name
