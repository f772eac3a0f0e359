"""What a domain and a problem mean: docs/language.md once more, in slow and obvious Python.

Written from the documents alone, so that a difference between this and the product is a mistake in one of
them or a gap in the documents. Nothing is grounded, simplified or dropped: a condition is asked of a state.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from support.differential.abstract import (
    Action,
    AnyOf,
    Closure,
    Comparison,
    Count,
    Definition,
    Domain,
    Equality,
    Every,
    Exists,
    ForEach,
    Key,
    Literal,
    Outcome,
    Part,
    Price,
    Problem,
    Rule,
    Setting,
    SetTruth,
    SetValue,
    Shift,
    Symbol,
    Value,
    Variable,
)

State = tuple[Value, ...]
Binding = dict[str, str]
Call = tuple[str, tuple[str, ...]]
"""An action and its objects."""
Seen = dict[Key, bool]
"""Derived predicates that were asked for in one state."""


class TwoValues(Exception):
    """One outcome gives a symbol two values for the same objects (E602)."""


class TwoRules(Exception):
    """Two rules of an action cover one state (E603)."""


@dataclass(slots=True)
class Meaning:
    """A domain's and a problem's meaning. A state is a value for each of `keys`."""

    domain: Domain
    problem: Problem
    kinds: dict[str, str | None] = field(init=False)
    symbols: dict[str, Symbol] = field(init=False)
    derived: dict[str, Definition | Closure] = field(init=False)
    counts: dict[str, Count] = field(init=False)
    actions: dict[str, Action] = field(init=False)
    objects: dict[str, str] = field(init=False)
    keys: tuple[Key, ...] = field(init=False)
    place: dict[Key, int] = field(init=False)
    seen: dict[State, Seen] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        domain, problem = self.domain, self.problem
        self.kinds = dict(domain.kinds)
        self.symbols = {symbol.name: symbol for symbol in domain.symbols}
        self.derived = {each.name: each for each in domain.derived}
        self.counts = {count.name: count for count in domain.counts}
        self.actions = {action.name: action for action in domain.actions}
        self.objects = {each.name: each.kind for each in (*domain.constants, *problem.objects)}
        keys = {
            self.key(symbol.name, terms)
            for symbol in domain.symbols
            for terms in itertools.product(*(self.members(kind) for kind in symbol.kinds))
        }
        self.keys = tuple(sorted(keys))
        self.place = {key: index for index, key in enumerate(self.keys)}

    # ---- objects, facts, states

    def members(self, kind: str) -> tuple[str, ...]:
        """The objects of a type and of those below it."""
        return tuple(name for name, own in self.objects.items() if self.below(own, kind))

    def below(self, kind: str | None, top: str) -> bool:
        while kind is not None and kind != top:
            kind = self.kinds[kind]
        return kind == top

    def key(self, symbol: str, terms: tuple[str, ...]) -> Key:
        """near(x, y) and near(y, x) are one fact where `near` is symmetric."""
        return (symbol, tuple(sorted(terms)) if self.symbols[symbol].symmetric else terms)

    def initial(self) -> State:
        facts = {self.key(symbol, terms): value for (symbol, terms), value in self.problem.facts}
        return tuple(facts.get(key, False) for key in self.keys)

    def bindings(self, variables: tuple[Variable, ...], outer: Binding) -> Iterator[Binding]:
        for objects in itertools.product(*(self.members(each.kind) for each in variables)):
            yield outer | {each.name: name for each, name in zip(variables, objects, strict=True)}

    # ---- conditions

    def all_hold(self, parts: Iterable[Part], state: State, binding: Binding) -> bool:
        return all(self.holds(part, state, binding) for part in parts)

    def holds(self, part: Part, state: State, binding: Binding) -> bool:
        if isinstance(part, AnyOf):
            return any(self.literal(each, state, binding) for each in part.literals)
        if isinstance(part, Exists):
            found = any(
                self.all_hold(part.body, state, inner) for inner in self.bindings(part.variables, binding)
            )
            return found == part.holds
        if isinstance(part, Every):
            return all(
                self.literal(part.then, state, inner)
                for inner in self.bindings(part.variables, binding)
                if self.all_hold(part.guard, state, inner)
            )
        return self.literal(part, state, binding)

    def literal(self, literal: Literal, state: State, binding: Binding) -> bool:
        if isinstance(literal, Equality):
            left, right = self.objects_of((literal.left, literal.right), binding)
            return (left == right) == literal.same
        terms = self.objects_of(literal.terms, binding)
        if isinstance(literal, Comparison):
            values = self.symbols[literal.symbol].values
            one = values.index(self.value(literal.symbol, terms, state))
            other = values.index(literal.value)
            return {
                "=": one == other,
                "!=": one != other,
                "<": one < other,
                "<=": one <= other,
                ">": one > other,
                ">=": one >= other,
            }[literal.relation]
        return self.true(literal.symbol, terms, state) == literal.holds

    def objects_of(self, terms: Iterable[str], binding: Binding) -> tuple[str, ...]:
        return tuple(binding[term] if term.startswith("?") else term for term in terms)

    def value(self, symbol: str, terms: tuple[str, ...], state: State) -> Value:
        return state[self.place[self.key(symbol, terms)]]

    def price(self, price: Price, state: State, binding: Binding) -> Fraction:
        """A number, and the values that functions have for the objects, each as often as it counts."""
        total = price.number
        for part in price.parts:
            value = self.value(part.symbol, self.objects_of(part.terms, binding), state)
            assert isinstance(value, int)
            total += part.weight * value
        return total

    def cost(self, call: Call, state: State) -> Fraction:
        """What an action costs on its objects, whatever comes of it."""
        action = self.actions[call[0]]
        binding = {each.name: name for each, name in zip(action.parameters, call[1], strict=True)}
        return Fraction(0) if action.cost is None else self.price(action.cost, state, binding)

    def true(self, name: str, terms: tuple[str, ...], state: State) -> bool:
        if name in self.symbols:
            return self.value(name, terms, state) is True
        seen = self.seen.setdefault(state, {})
        if (name, terms) not in seen:
            seen[name, terms] = self.follows(self.derived[name], terms, state)
        return seen[name, terms]

    def follows(self, derived: Definition | Closure, terms: tuple[str, ...], state: State) -> bool:
        if isinstance(derived, Definition):
            names = (each.name for each in derived.parameters)
            return self.all_hold(derived.condition, state, dict(zip(names, terms, strict=True)))
        return terms[1] in self.reached(derived, terms[0], state)

    def reached(self, closure: Closure, start: str, state: State) -> set[str]:
        """What one or more steps lead to."""
        first, second = (set(self.members(each.kind)) for each in closure.parameters)
        found: set[str] = set()
        waiting = [start]
        while waiting:
            here = waiting.pop()
            if here in first:
                nexts = {there for there in second if self.true(closure.of, (here, there), state)}
                waiting += nexts - found
                found |= nexts
        return found

    def counted(self, name: str, state: State) -> int:
        """How many bindings of the count's variables its condition holds for."""
        count = self.counts[name]
        return sum(
            self.all_hold(count.condition, state, binding) for binding in self.bindings(count.variables, {})
        )

    # ---- rules

    def calls(self) -> tuple[Call, ...]:
        """Every action with all objects that fit, two parameters perhaps standing for one."""
        return tuple(
            (action.name, objects)
            for action in self.domain.actions
            for objects in itertools.product(*(self.members(each.kind) for each in action.parameters))
        )

    def bound(self, rule: Rule, call: Call, state: State) -> Binding | None:
        """The rule's variables where it covers the action in the state: each reference fits exactly once."""
        names = (each.name for each in rule.parameters)
        binding = dict(zip(names, call[1], strict=True))
        if rule.action != call[0] or not self.all_hold(rule.condition, state, binding):
            return None
        for reference in rule.references:
            fitting = [
                inner
                for inner in self.bindings(reference.variables, binding)
                if self.all_hold(reference.body, state, inner)
            ]
            if len(fitting) != 1:
                return None
            binding = fitting[0]
        return binding

    def covering(self, call: Call, state: State) -> tuple[Rule, Binding] | None:
        found = [
            (rule, binding)
            for rule in self.domain.rules
            if rule.action == call[0] and (binding := self.bound(rule, call, state)) is not None
        ]
        if len(found) > 1:
            raise TwoRules(f"{found[0][0].name} and {found[1][0].name} cover {call}")
        return found[0] if found else None

    def changes(self, outcome: Outcome, binding: Binding, state: State) -> dict[Key, Value]:
        """What an outcome sets, and to what. Everything is read from the state before."""
        sets: dict[Key, set[Value]] = {}
        shifts: dict[Key, int] = {}
        for setting, inner in self.settings(outcome, binding, state):
            key = self.key(setting.symbol, self.objects_of(setting.terms, inner))
            if isinstance(setting, Shift):
                shifts[key] = shifts.get(key, 0) + setting.amount
            else:
                value = setting.holds if isinstance(setting, SetTruth) else setting.value
                sets.setdefault(key, set()).add(value)
        for key, values in sets.items():
            if len(values) > 1 or key in shifts:
                raise TwoValues(f"{key} in {outcome.said}")
        changed = {key: value for key, (value,) in sets.items()}
        for key, amount in shifts.items():
            values_of = self.symbols[key[0]].values
            before = state[self.place[key]]
            assert isinstance(before, int)
            changed[key] = min(max(before + amount, values_of[0]), values_of[-1])
        return changed

    def settings(self, outcome: Outcome, binding: Binding, state: State) -> Iterator[tuple[Setting, Binding]]:
        for effect in outcome.effects:
            if isinstance(effect, SetTruth | SetValue | Shift):
                yield effect, binding
            else:
                assert isinstance(effect, ForEach)
                for inner in self.bindings(effect.variables, binding):
                    if self.all_hold(effect.guard, state, inner):
                        yield from ((setting, inner) for setting in effect.settings)

    def after(self, outcome: Outcome, binding: Binding, state: State) -> State:
        changed = self.changes(outcome, binding, state)
        return tuple(changed.get(key, value) for key, value in zip(self.keys, state, strict=True))

    def results(self, call: Call, state: State) -> list[tuple[Fraction, State]]:
        """The state after each outcome, in the rule's order; outcomes of probability 0 don't happen."""
        covering = self.covering(call, state)
        if covering is None:
            return [(Fraction(1), state)]
        rule, binding = covering
        return [
            (outcome.probability, self.after(outcome, binding, state))
            for outcome in rule.outcomes
            if outcome.probability
        ]

    def successors(self, call: Call, state: State) -> dict[State, Fraction]:
        merged: dict[State, Fraction] = {}
        for probability, after in self.results(call, state):
            merged[after] = merged.get(after, Fraction(0)) + probability
        return merged
