"""Encodes a problem's changeable fluents as state variables, and their values as indices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cleancli.compiler.fluents import Fluent
from cleancli.compiler.ground_formula import Requirement
from cleancli.compiler.instances import Changes
from cleancli.compiler.static_join import Universe
from cleancli.compiler.task import GroundCondition, GroundLiteral, StateVariable
from cleancli.language.model import Value


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a key went: its variable's index and, per value, the value's index."""

    variable: int
    value: Mapping[Value, int]


class Numbering:
    """Numbers for the keys that can change and for their values, sorted by symbol and objects."""

    def __init__(self, changing: Mapping[Fluent, frozenset[Value]], universe: Universe) -> None:
        keys: Sequence[Fluent] = sorted(changing)
        self.variables = tuple(
            StateVariable(*key, tuple(v for v in universe.symbols[key[0]].values if v in changing[key]))
            for key in keys
        )
        self._places = {
            key: _Place(index, {value: place for place, value in enumerate(variable.values)})
            for index, (key, variable) in enumerate(zip(keys, self.variables, strict=True))
        }
        self.initial = tuple(self._places[key].value[universe.initial(key)] for key in keys)

    def literal(self, key: Fluent, values: frozenset[Value]) -> GroundLiteral:
        """A literal over a key that can change, in numbers."""
        place = self._places[key]
        return place.variable, frozenset([place.value[value] for value in values])

    def assignment(self, key: Fluent, value: Value) -> tuple[int, int]:
        """What an outcome sets, in numbers."""
        place = self._places[key]
        return place.variable, place.value[value]

    def condition(self, required: Requirement) -> GroundCondition:
        """A requirement over keys that can change, in numbers."""
        numbered = [self.literal(key, values) for key, values in required.items()]
        return tuple(sorted(numbered, key=lambda pair: pair[0]))

    def effects(self, changes: Changes) -> tuple[tuple[int, int], ...]:
        """An outcome's changes in numbers."""
        return tuple(sorted([self.assignment(key, value) for key in changes for value in changes[key]]))
