"""Relaxed reachability: the values that each fluent can ever take, and the instances that can ever apply.

Guaranteed by `instances`: conditions hold literals over changeable keys alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from cleancli.compiler.fluents import Fluent, shifted
from cleancli.compiler.ground_formula import can_hold
from cleancli.compiler.instances import Instance, Instances, StateEffect
from cleancli.compiler.plain_rules import PlainInstances
from cleancli.compiler.ragged import distinct
from cleancli.compiler.static_join import Universe
from cleancli.language.model import Assign, Shift, Value

_MOST_AMOUNTS = 200
"""Sums of shifts that are told apart; beyond it a number may become anything. Chosen."""


class Reach:
    """The least fixpoint in which a value once possible stays so, and an instance applies once it can.

    Every state that actions can reach is inside it, so what it leaves out changes no plan's value.
    """

    def __init__(self, candidates: Instances, universe: Universe) -> None:
        self._universe = universe
        self.vocabulary = candidates.vocabulary
        self._possible: dict[Fluent, frozenset[Value]] = {}
        self._applying = [np.zeros(len(plain.objects), dtype=np.bool_) for plain in candidates.plain]
        self.instances: list[Instance] = []
        waiting: Sequence[Instance] = candidates.others
        while True:
            grown = self._apply_plain(candidates.plain)
            applicable: list[Instance] = []
            still_waiting: list[Instance] = []
            for instance in waiting:
                (applicable if can_hold(instance.condition, self.known) else still_waiting).append(instance)
            waiting = still_waiting
            self.instances += applicable
            for instance in applicable:
                grown |= self._apply(instance)
            for instance in self.instances:
                grown |= bool(instance.effects) and self._apply_effects(instance)
            if not grown:
                break
        self.instances.sort(key=lambda instance: (instance.rule, instance.objects))
        self.plain = tuple(map(PlainInstances.only, candidates.plain, self._applying))

    def known(self, key: Fluent) -> frozenset[Value]:
        """The values that a key can ever have."""
        return self._possible.get(key) or frozenset({self._universe.initial(key)})

    @property
    def changing(self) -> Mapping[Fluent, frozenset[Value]]:
        """The keys that can ever have more than one value, with their values."""
        return {key: values for key, values in self._possible.items() if len(values) > 1}

    def _apply_plain(self, blocks: Sequence[PlainInstances]) -> bool:
        """Adds what those of the plain instances do that can apply now; whether that is anything new."""
        can_be = [bool(values & self.known(key)) for key, values in self.vocabulary.literals.entries]
        possible = np.array([*can_be, True])  # the last is for `NOTHING`
        grown = False
        for plain, applying in zip(blocks, self._applying, strict=True):
            new = possible[plain.literals].all(axis=1) & ~applying
            if not new.any():
                continue
            applying |= new
            for rows, assigned in plain.assigned:
                for number in distinct(assigned[new[rows]]).tolist():
                    key, value = self.vocabulary.assignments.entries[number]
                    grown |= self._add(key, frozenset({value}))
        return grown

    def _apply(self, instance: Instance) -> bool:
        """Adds what the instance always does; whether that is anything new."""
        grown = False
        for changes in instance.changes:
            for key, values in changes.items():
                grown |= self._add(key, values)
        return grown

    def _apply_effects(self, instance: Instance) -> bool:
        """Adds what the instance may do in some state; whether that is anything new."""
        grown = False
        shifts: dict[tuple[int, Fluent], list[StateEffect]] = {}
        for effect in instance.effects:
            if can_hold(effect.when, self.known):
                if isinstance(effect.effect, Assign):
                    grown |= self._add(effect.key, frozenset({effect.effect.value}))
                else:
                    shifts.setdefault((effect.outcome, effect.key), []).append(effect)
        for (_, key), effects in shifts.items():
            grown |= self._add(key, self._shifted(key, effects, instance))
        return grown

    def _shifted(self, key: Fluent, effects: Sequence[StateEffect], instance: Instance) -> frozenset[Value]:
        """What the number may be after those of the shifts that happen."""
        symbol = self._universe.symbols[key[0]]
        amounts = {0}
        for effect in effects:
            assert isinstance(effect.effect, Shift)
            more = {amount + effect.effect.amount for amount in amounts}
            amounts = more if effect.when.always else amounts | more
            if len(amounts) > _MOST_AMOUNTS:
                return frozenset(symbol.values)
        before = self.known(key) & instance.condition.required.get(key, frozenset(symbol.values))
        return frozenset(shifted(symbol, value, amount) for value in before for amount in amounts)

    def _add(self, key: Fluent, values: frozenset[Value]) -> bool:
        before = self.known(key)
        self._possible[key] = before | values
        return not values <= before
