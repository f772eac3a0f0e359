"""Which numbers of a belief literals and conditions are about."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from cleancli.array_types import Bools, Longs
from cleancli.compiler.lowering.rule_columns import RuleColumns
from cleancli.compiler.ragged import spans, starts
from cleancli.compiler.task import GroundLiteral, StateVariable


class Numbers:
    """The numbers of a belief: slots, then sums of slots, then the number 1 (`Tables` says more).

    `first` has each variable's first slot, and how many slots there are; a sum is of slots of one variable,
    and sums ascend by it.
    """

    def __init__(self, variables: Sequence[StateVariable], literals: Iterable[GroundLiteral]) -> None:
        self.first = starts(variable.values for variable in variables).astype(np.int64)
        self.slots = int(self.first[-1])
        several = sorted({(v, tuple(sorted(allowed))) for v, allowed in set(literals) if len(allowed) > 1})
        self.sum_variable = np.array([v for v, _ in several], dtype=np.int64)
        self.sum_start = starts(values for _, values in several).astype(np.int64)
        self.sum_slot = np.array(
            [self.first[v] + value for v, values in several for value in values], dtype=np.int64
        )
        self.one = self.slots + len(several)
        self._sum = {literal: self.slots + index for index, literal in enumerate(several)}

    def of(self, literals: Iterable[GroundLiteral]) -> Longs:
        """The number that is each literal's probability."""
        return np.array([self._of(variable, allowed) for variable, allowed in literals], dtype=np.int64)

    def _of(self, variable: int, allowed: frozenset[int]) -> int:
        if len(allowed) == 1:
            (value,) = allowed
            return int(self.first[variable]) + value
        return self._sum[variable, tuple(sorted(allowed))]

    def possible(self, variable: Longs, given: Longs) -> tuple[Longs, Longs]:
        """The slots among which the value of each variable is not known where a literal is given, by its
        number: which variable each is of, and the slot. There are none where one value alone is left."""
        free, alone = given == self.one, given < self.slots
        place = np.where(free | alone, 0, given - self.slots)
        lengths = np.append(np.diff(self.sum_start), 0)[place]
        count = np.where(alone, 0, np.where(free, np.diff(self.first)[variable], lengths))
        which, entry = spans(np.where(free, self.first[variable], self.slots + self.sum_start[place]), count)
        return which, np.concatenate([np.arange(self.slots), self.sum_slot])[entry]


class Conditions:
    """The conditions of rules as numbers that they multiply, those of an action that all its rules multiply
    (its guard) apart from the others.

    The guard holds what is known wherever one of the rules applies. (Where rules are independent, nothing is:
    the probability that one applies may be more than that of what all ask for.)
    """

    def __init__(self, columns: RuleColumns, numbers: Numbers, actions: int, independent: bool) -> None:
        self._variables = len(numbers.first)
        self._one = numbers.one
        number = numbers.of(columns.literals)[columns.literal]
        self._learn(columns, number, independent)
        size = numbers.one + 1
        action = columns.action[columns.literal_rule]
        found, place, times = np.unique(action * size + number, return_inverse=True, return_counts=True)
        everywhere: Bools = times == np.bincount(columns.action, minlength=actions)[found // size]
        everywhere &= not independent
        self.guard_start = np.searchsorted(found[everywhere] // size, np.arange(actions + 1))
        self.guard = found[everywhere] % size
        beside = ~everywhere[place]
        others = np.sort(columns.literal_rule[beside] * size + number[beside])
        self.start = np.searchsorted(others // size, np.arange(len(columns.action) + 1))
        self.entries = others % size

    def _learn(self, columns: RuleColumns, number: Longs, independent: bool) -> None:
        variable = np.array([v for v, _ in columns.literals], dtype=np.int64)[columns.literal]
        keys = columns.literal_rule * self._variables + variable
        order = np.argsort(keys[:0] if independent else keys)
        self._keys, self._given = keys[order], np.append(number[order], self._one)

    def given(self, rule: Longs, variable: Longs) -> Longs:
        """The numbers of the literals that may be taken as known of variables where rules apply; that of 1
        where none may."""
        keys = rule * self._variables + variable
        place = np.searchsorted(self._keys, keys)
        found = np.append(self._keys, -1)[place] == keys
        return self._given[np.where(found, place, len(self._keys))]
