"""What every planner takes and returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cleancli.compiler.task import GroundAction


@dataclass(frozen=True, slots=True)
class Options:
    """`samples`: action sequences to draw (PRADA's n); `seed` of the planner's own random stream."""

    samples: int = 10_000
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Plan:
    """A sequence of actions and its value: expected discounted reward by the planner's own measure, up to the
    horizon, though the sequence may end before it.

    `coverage` is eq. 3's share of the sequences that were sampled; `seconds` per phase of the planner.
    """

    planner: str
    actions: tuple[GroundAction, ...]
    value: float
    samples: int
    horizon: int
    coverage: float
    seconds: Mapping[str, float]
