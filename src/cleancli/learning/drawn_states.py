"""States drawn at random, and an action in each: where rules are compared if no experience is given.

Nothing is known of which states are possible, so what is drawn is all that the vocabulary allows. Rules cover
few of such states, and so most are changed towards what some rule of the action asks for.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from cleancli.compiler.fluents import Fluent, names_of
from cleancli.language.model import (
    Domain,
    Equality,
    Literal,
    Object,
    Quantified,
    Reference,
    Rule,
    Symbol,
    Value,
    Variable,
)
from cleancli.learning.experience import Transition

MOST_OF_A_TYPE = 4
"""Objects of each type, at most; chosen."""
LIKELY = (0.1, 0.3, 0.5)
"""How likely a predicate is to hold of objects, one of these in a state; chosen."""
TOWARDS = 0.75
"""The share of states that are changed towards a rule; chosen."""
MOST_DRAWN = 1000
"""Lists of objects that a symbol is drawn a value for, in a state; of a symbol of many parameters there may
be more. Chosen."""


def drawn_states(domains: Sequence[Domain], rng: np.random.Generator) -> Iterator[Transition]:
    """States and actions without end, as transitions in which nothing happens; none without actions. The
    domains have one vocabulary."""
    vocabulary, types = domains[0], domains[0].types
    while vocabulary.actions:
        objects = _objects(vocabulary, rng)
        everything = (*vocabulary.constants, *objects)
        action = vocabulary.actions[int(rng.integers(len(vocabulary.actions)))]
        of_types = {t.name: [o.name for o in everything if vocabulary.is_a(o.type, t.name)] for t in types}
        drawn = _Drawn(vocabulary, of_types, {}, rng)
        arguments = drawn.names(action.parameters)
        drawn.fill()
        rules = [rule for domain in domains for rule in domain.rules if rule.action == action.name]
        if rules and rng.random() < TOWARDS:
            drawn.fit(rules[int(rng.integers(len(rules)))], arguments)
        before = {key: value for key, value in drawn.values.items() if value is not False}
        yield Transition(action.name, arguments, objects, before, before)


def _objects(domain: Domain, rng: np.random.Generator) -> tuple[Object, ...]:
    """Some objects of each type, with its name and a number."""
    taken = {constant.name for constant in domain.constants}
    found = []
    for each in domain.types:
        free = (name for number in itertools.count(1) if (name := f"{each.name}{number}") not in taken)
        number = int(rng.integers(1, MOST_OF_A_TYPE + 1))
        found += [Object(name, each.name) for name in itertools.islice(free, number)]
    return tuple(found)


_Binding = Mapping[Variable, str]
_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class _Drawn:
    """A state that is drawn: the names of its objects by their types, and the values of its fluents, those of
    predicates that do not hold left out or False."""

    domain: Domain
    of_types: Mapping[str, Sequence[str]]
    values: dict[Fluent, Value]
    rng: np.random.Generator

    def names(self, variables: Sequence[Variable]) -> tuple[str, ...]:
        """An object for each variable."""
        return tuple(self._one_of(self.of_types[each.type]) for each in variables)

    def fill(self) -> None:
        """Give all fluents values."""
        for symbol in self.domain.symbols:
            likely = LIKELY[int(self.rng.integers(len(LIKELY)))]
            lists = self._lists(symbol)
            if symbol.is_predicate:
                true = np.flatnonzero(self.rng.random(len(lists)) < likely)
                self.values.update({(symbol.name, symbol.canonical(lists[each])): True for each in true})
            else:
                codes = self.rng.integers(len(symbol.values), size=len(lists)).tolist()
                for names, code in zip(lists, codes, strict=True):
                    self.values[symbol.name, symbol.canonical(names)] = symbol.values[code]

    def _lists(self, symbol: Symbol) -> list[tuple[str, ...]]:
        among = [self.of_types[parameter.type] for parameter in symbol.parameters]
        if math.prod(map(len, among)) <= MOST_DRAWN:
            return list(itertools.product(*among))
        return [self.names(symbol.parameters) for _ in range(MOST_DRAWN)]

    def _one_of(self, values: Sequence[_Item]) -> _Item:
        return values[int(self.rng.integers(len(values)))]

    def fit(self, rule: Rule, arguments: tuple[str, ...]) -> None:
        """Change the state towards one in which a rule covers these arguments. That is tried and not reached
        in all: one part of its condition may undo another."""
        binding = dict(zip(rule.variables, arguments, strict=True))
        for part in rule.condition:
            self._make(part, binding)
        for reference in rule.references:
            binding |= self._refer(reference, binding)
        for part in rule.condition:
            self._make(part, binding)

    def _refer(self, reference: Reference, binding: _Binding) -> _Binding:
        """The objects that a reference names, as all others that were as it says no longer are."""
        own = dict(zip(reference.variables, self.names(reference.variables), strict=True))
        for part in reference.condition:
            self._make(part, {**binding, **own})
        for names in self._bindings(reference.variables):
            if names != own:
                self._break(reference.condition, {**binding, **names}, own)
        return own

    def _bindings(self, variables: Sequence[Variable]) -> Iterator[_Binding]:
        for names in itertools.product(*(self.of_types[each.type] for each in variables)):
            yield dict(zip(variables, names, strict=True))

    def _make(self, part: Literal | Equality | Quantified, binding: _Binding) -> None:
        """Let a part of a condition hold, as far as that is in the values of symbols."""
        match part:
            case Quantified(True, variables, condition):
                inner = {**binding, **dict(zip(variables, self.names(variables), strict=True))}
                for each in condition:
                    self._make(each, inner)
            case Quantified(False, variables, condition):
                for names in self._bindings(variables):
                    self._break(condition, {**binding, **names})
            case Literal(symbol, terms, values):
                self._set(symbol, names_of(terms, binding), values)

    def _set(self, name: str, names: tuple[str, ...], wanted: frozenset[Value]) -> None:
        symbol = next((each for each in self.domain.symbols if each.name == name), None)
        if symbol is not None:
            key = name, symbol.canonical(names)
            if self.values.get(key, False) not in wanted:
                self.values[key] = self._one_of([value for value in symbol.values if value in wanted])
            return
        derived = next(each for each in self.domain.derived if each.name == name)
        if derived.closure is not None:
            self._set(derived.closure, names, wanted)
        elif True in wanted:
            for part in derived.condition:
                self._make(part, dict(zip(derived.parameters, names, strict=True)))

    def _break(
        self, condition: Sequence[Literal | Equality], binding: _Binding, spared: _Binding | None = None
    ) -> None:
        """Let one literal of a conjunction that holds not hold; rather one that says nothing of what is
        `spared`."""
        literals = [part for part in condition if isinstance(part, Literal)]
        if not literals or not all(self._holds(part, binding) for part in condition):
            return
        kept = set((spared or {}).values())
        apart = [each for each in literals if not kept & set(names_of(each.terms, binding))]
        literal = (apart or literals)[int(self.rng.integers(len(apart or literals)))]
        symbol = next((each for each in self.domain.symbols if each.name == literal.symbol), None)
        values = (False, True) if symbol is None else symbol.values
        self._set(literal.symbol, names_of(literal.terms, binding), frozenset(values) - literal.values)

    def _holds(self, part: Literal | Equality, binding: _Binding) -> bool:
        """Whether a part holds; what follows from others is taken to."""
        if isinstance(part, Equality):
            left, right = names_of((part.left, part.right), binding)
            return (left == right) == part.equal
        symbol = next((each for each in self.domain.symbols if each.name == part.symbol), None)
        if symbol is None:
            return True
        key = part.symbol, symbol.canonical(names_of(part.terms, binding))
        return self.values.get(key, False) in part.values
