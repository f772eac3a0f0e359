"""Whether runs bear out what a claim says of a ratio or a mean, and how many more would tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import ceil, inf, sqrt

from scipy.special import ndtri, stdtrit

from cleancli.statistics.bootstrap import MISSED, Estimate

POWER = 0.8
"""How likely the pairs that are said to be enough are to decide. Chosen, as is usual (Cohen 1988)."""

MOST_PAIRS = 10_000
"""More than these are not told: the truth is too near to a bound."""


class Verdict(StrEnum):
    """What became of a claim."""

    WON = "won"
    LOST = "lost"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Bounds:
    """Between which numbers a claim says that something lies. Two ends are allowed, a single one is not: what
    is equal is neither less nor more."""

    low: float = -inf
    high: float = inf

    @property
    def ends(self) -> tuple[float, ...]:
        """Those that are finite."""
        return tuple(end for end in (self.low, self.high) if abs(end) < inf)


def verdict(estimate: Estimate, claimed: Bounds) -> Verdict:
    """Won where all of the interval lies within the bounds, lost where none of it does."""
    if len(claimed.ends) > 1:
        won = claimed.low <= estimate.low and estimate.high <= claimed.high
        lost = estimate.high < claimed.low or claimed.high < estimate.low
    else:
        won = claimed.low < estimate.low and estimate.high < claimed.high
        lost = estimate.high <= claimed.low or claimed.high <= estimate.low
    return Verdict.WON if won else Verdict.LOST if lost else Verdict.UNDECIDED


def together(verdicts: Sequence[Verdict]) -> Verdict:
    """Of a claim that several comparisons test: won where all are won (an intersection-union test, Berger
    1982, which needs no correction for their number), lost where one is lost."""
    if Verdict.LOST in verdicts:
        return Verdict.LOST
    return Verdict.WON if verdicts and set(verdicts) == {Verdict.WON} else Verdict.UNDECIDED


def more_needed(estimate: Estimate, claimed: Bounds) -> int | None:
    """How many more pairs, or runs, decide four times in five, if things are as the estimate says.

    None where it has no interval, or where more than MOST_PAIRS would be needed.
    """
    if not estimate.known:
        return None
    needed = max((_needed(estimate, end) for end in _in_the_way(estimate.value, claimed)), default=0.0)
    return max(1, ceil(needed) - estimate.count) if needed <= MOST_PAIRS else None


def _in_the_way(value: float, claimed: Bounds) -> tuple[float, ...]:
    """The ends that the interval must come not to hold: all, or the nearest if the claim looks wrong."""
    if claimed.low <= value <= claimed.high:
        return claimed.ends
    return (claimed.low if value < claimed.low else claimed.high,)


def _needed(estimate: Estimate, end: float) -> float:
    """How many runs set the estimate and an end apart, by the normal distribution, and by what it costs that
    the spread is estimated too (Guenther 1981). The spread is that of the interval on the side of the end."""
    reach = estimate.value - estimate.low if end < estimate.value else estimate.high - estimate.value
    distance = abs(estimate.value - end)
    spread = reach * sqrt(estimate.count) / -stdtrit(estimate.count - 1, MISSED / 2)
    far = -ndtri(MISSED / 2)
    if not distance:
        return inf
    return float(((far + ndtri(POWER)) * spread / distance) ** 2 + far**2 / 2)
