"""Conditions and effects as functions of a state, worked out once for a domain.

A function takes a state and `Names`: the objects that variables stand for, each at its variable's slot. What
a quantifier binds comes after the others.
"""

from __future__ import annotations

import itertools
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from cleancli.compiler.fluents import Fluent, Values, parameters_of, shifted
from cleancli.compiler.objects_by_type import ObjectsByType
from cleancli.language.model import (
    Assign,
    Condition,
    Domain,
    Equality,
    ForAll,
    Literal,
    Outcome,
    Quantified,
    Shift,
    Term,
    Value,
    Variable,
)

Names = tuple[str, ...]
Slots = Mapping[Variable, int]


class LiftedState(NamedTuple):
    """A state by its fluents' values; `found` remembers what satisfied a guard, by the guard's number."""

    values: Values
    objects: ObjectsByType
    found: dict[tuple[int, Names], list[Names]]


Test = Callable[[LiftedState, Names], bool]
Extender = Callable[[LiftedState, Names], Iterator[Names]]
Changes = Callable[[LiftedState, Names], dict[Fluent, Value]]
Key = Callable[[Names], Fluent]
Guard = Callable[[LiftedState, Names], list[Names]]
_Happening = Callable[[LiftedState, Names], Iterable[tuple[Assign | Shift, Fluent]]]


class ConflictError(ValueError):
    """An outcome gives `key` two values, or sets and shifts it."""

    def __init__(self, key: Fluent) -> None:
        super().__init__(f"{key[0]}({', '.join(key[1])})")
        self.key = key


class Lifted:
    """What a domain's conditions and effects mean in a state."""

    def __init__(self, domain: Domain) -> None:
        self._symbols = {symbol.name: symbol for symbol in domain.symbols}
        self._derived = {derived.name: derived for derived in domain.derived}
        self._definitions: dict[str, Test] = {}
        self._guards: dict[tuple[object, ...], int] = {}

    # ---- conditions

    def test(self, condition: Condition, slots: Slots) -> Test:
        """Whether every part of a condition holds."""
        tests = [self._part(part, slots) for part in condition]
        if len(tests) == 1:
            return tests[0]

        def test(state: LiftedState, names: Names) -> bool:
            # Twice as fast as all() of a generator, and asked millions of times.
            for each in tests:  # noqa: SIM110
                if not each(state, names):
                    return False
            return True

        return test

    def extender(self, variables: Sequence[Variable], condition: Condition, slots: Slots) -> Extender:
        """All that variables may stand for so that a condition holds, in the order of objects."""
        types = [variable.type for variable in variables]
        test = self.test(condition, further(slots, variables))

        def extended(state: LiftedState, names: Names) -> Iterator[Names]:
            for more in itertools.product(*[state.objects[each] for each in types]):
                everything = names + more
                if test(state, everything):
                    yield everything

        return extended

    def _part(self, part: Literal | Equality | Quantified, slots: Slots) -> Test:
        match part:
            case Literal():
                return self._literal(part, slots)
            case Equality(left, right, equal):
                both = _reader((left, right), slots)

                def alike(_: LiftedState, names: Names) -> bool:
                    one, other = both(names)
                    return (one == other) is equal

                return alike
            case Quantified(exists, variables, condition):
                extended = self.extender(variables, condition, slots)
                return lambda state, names: (next(extended(state, names), None) is not None) is exists

    def _literal(self, literal: Literal, slots: Slots) -> Test:
        values = literal.values
        if literal.symbol in self._derived:
            follows, read = self.follows(literal.symbol), _reader(literal.terms, slots)
            return lambda state, names: follows(state, read(names)) in values
        key, missing = self.key(literal.symbol, literal.terms, slots), self.missing(literal.symbol)
        match literal.terms:
            case [Variable() as only]:  # The same in fewer calls, as most literals are of one variable.
                symbol, slot = literal.symbol, slots[only]
                return lambda state, names: state.values.get((symbol, (names[slot],)), missing) in values
        return lambda state, names: state.values.get(key(names), missing) in values

    def is_derived(self, symbol: str) -> bool:
        """Whether it is a derived predicate, and so has no value in a state."""
        return symbol in self._derived

    def missing(self, symbol: str) -> Value | None:
        """The value of what a state does not list: false, or none of a function."""
        return False if self._symbols[symbol].is_predicate else None

    def fluent(self, symbol: str, names: Names) -> Fluent:
        """A symbol for some objects, in canonical order."""
        return symbol, self._symbols[symbol].canonical(names)

    def key(self, symbol: str, terms: Sequence[Term], slots: Slots) -> Key:
        """The symbol for the objects that terms stand for."""
        read = _reader(terms, slots)
        if self._symbols[symbol].symmetric:
            return lambda names: (symbol, tuple(sorted(read(names))))
        return lambda names: (symbol, read(names))

    def follows(self, derived: str) -> Test:
        """Whether a derived predicate holds for the objects that `names` are."""
        if derived not in self._definitions:
            self._definitions[derived] = self._definition(derived)
        return self._definitions[derived]

    def _definition(self, name: str) -> Test:
        derived = self._derived[name]
        if derived.closure is None:
            return self.test(derived.condition, further({}, derived.parameters))
        source, target = parameters_of(derived.closure, self._symbols, self._derived)
        step = (Literal(derived.closure, (source, target), frozenset({True})),)
        steps = self.extender((target,), step, {source: 0})

        def reaches(state: LiftedState, names: Names) -> bool:
            start, goal = names
            return goal in _reached(state, start, source.type, steps)

        return reaches

    # ---- effects

    def changes(self, outcome: Outcome, slots: Slots) -> Changes:
        """What an outcome sets; a number without value stays so.

        Shifts of one number add up, and stop at its bounds after that. Raises `ConflictError`.
        """
        happening = [self._happening(effect, slots) for effect in outcome.effects]

        def changed(state: LiftedState, names: Names) -> dict[Fluent, Value]:
            changes: dict[Fluent, Value] = {}
            amounts: dict[Fluent, int] = {}
            for effects in happening:
                for effect, key in effects(state, names):
                    if isinstance(effect, Shift):
                        amounts[key] = amounts.get(key, 0) + effect.amount
                    elif changes.setdefault(key, effect.value) != effect.value:
                        raise ConflictError(key)
            for key, amount in amounts.items():
                if key in changes:
                    raise ConflictError(key)
                if (before := state.values.get(key, self.missing(key[0]))) is not None:
                    changes[key] = shifted(self._symbols[key[0]], before, amount)
            return changes

        return changed

    def _happening(self, effect: Assign | Shift | ForAll, slots: Slots) -> _Happening:
        """An effect with what it is on, those of a `forall` for each binding that fits."""
        if not isinstance(effect, ForAll):
            key = self.key(effect.symbol, effect.terms, slots)
            return lambda _, names: [(effect, key(names))]
        inner = further(slots, effect.variables)
        keys = [(each, self.key(each.symbol, each.terms, inner)) for each in effect.effects]
        satisfying = self.guard(effect, slots)
        return lambda state, names: [
            (each, key(extended)) for extended in satisfying(state, names) for each, key in keys
        ]

    def guard(self, effect: ForAll, slots: Slots) -> Guard:
        """What satisfies the condition of a `forall`, found once for all outcomes that have the same one."""
        same = (effect.variables, effect.condition, tuple(slots.items()))
        number = self._guards.setdefault(same, len(self._guards))
        extended = self.extender(effect.variables, effect.condition, slots)

        def satisfying(state: LiftedState, names: Names) -> list[Names]:
            known = (number, names)
            if known not in state.found:
                state.found[known] = list(extended(state, names))
            return state.found[known]

        return satisfying


def further(slots: Slots, variables: Sequence[Variable]) -> dict[Variable, int]:
    """The slots with those of more variables after them."""
    free = max(slots.values(), default=-1) + 1
    return {**slots, **{variable: free + index for index, variable in enumerate(variables)}}


def _reader(terms: Sequence[Term], slots: Slots) -> Callable[[Names], Names]:
    """The objects that terms stand for."""
    constants = tuple(term.name for term in terms if not isinstance(term, Variable))
    if len(constants) == len(terms):
        return lambda _: constants
    # Constants are read as names after all others, from the end.
    after = itertools.count(-len(constants))
    first, *others = [slots[term] if isinstance(term, Variable) else next(after) for term in terms]
    if not others:
        return lambda names: (names[first],)
    read = operator.itemgetter(first, *others)
    return (lambda names: read(names + constants)) if constants else read


def _reached(state: LiftedState, start: str, type_name: str, steps: Extender) -> set[str]:
    """The objects that one or more steps lead to."""
    reached: set[str] = set()
    frontier = [start]
    while frontier:
        one = frontier.pop()
        if one in state.objects.names(type_name):
            found = {target for _, target in steps(state, (one,))}
            frontier += sorted(found - reached)
            reached |= found
    return reached
