"""The grounded task: a finite, factored decision process in plain tuples.

Guaranteed by `ground`: everything is sorted; a variable is a symbol's value for some objects that at least
one outcome can change (all others were decided when grounding); rules of one action exclude each other, so at
most one covers a state (§3.3.2); an action is listed only if some rule of it can change something.
"""

from __future__ import annotations

from dataclasses import dataclass

from cleancli.language.model import OutcomeKind, Value


@dataclass(frozen=True, slots=True, order=True)
class StateVariable:
    """A symbol for some objects, with its values in declared order."""

    symbol: str
    objects: tuple[str, ...]
    values: tuple[Value, ...]


GroundCondition = tuple[tuple[int, frozenset[int]], ...]
"""Pairs (variable index, indices of the values it may have), sorted by variable, one pair a variable."""

Assignment = tuple[int, ...]
"""A state of the task: for each variable the index of its value."""


@dataclass(frozen=True, slots=True, order=True)
class GroundAction:
    """An action for some objects; `duration` in seconds, None where the domain does not say."""

    name: str
    objects: tuple[str, ...]
    duration: float | None

    def __str__(self) -> str:
        return f"{self.name}({', '.join(self.objects)})"


@dataclass(frozen=True, slots=True)
class GroundOutcome:
    """`effects` are pairs (variable, value index), sorted; empty for noise and for nothing."""

    probability: float
    kind: OutcomeKind
    effects: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class GroundRule:
    """A rule for the objects of `action` (an index). `rule` is the rule's index in the domain; outcomes keep
    the domain's order."""

    rule: int
    action: int
    condition: GroundCondition
    outcomes: tuple[GroundOutcome, ...]


@dataclass(frozen=True, slots=True)
class Task:
    """A grounded problem. The reward of a step is the decrease of the number of `counted` conditions that
    hold (eq. 2); `counted_always` of them hold in every state and were left out."""

    variables: tuple[StateVariable, ...]
    initial: Assignment
    actions: tuple[GroundAction, ...]
    rules: tuple[GroundRule, ...]
    counted: tuple[GroundCondition, ...]
    counted_always: int
    horizon: int
    discount: float
