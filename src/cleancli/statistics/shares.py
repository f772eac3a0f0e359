"""Shares of tries that were successes, with their intervals."""

from __future__ import annotations

from math import nan, sqrt

from cleancli.array_types import Floats
from cleancli.statistics.bootstrap import FEWEST, Estimate

NORMAL = 1.959963984540054
"""The standard normal distribution's quantile for a two-sided interval of 95 %."""


def share_of(values: Floats) -> Estimate:
    """The share of all tries, from the shares of runs, (n,). Each run counts as one try: those of one run go
    on from each other, and tell no more than one if they hang together wholly."""
    count, share = len(values), float(values.mean()) if len(values) else nan
    if count < FEWEST:
        return Estimate(share, count=count)
    return Estimate(share, *wilson(share * count, count), count)


def wilson(successes: float, number: int) -> tuple[float, float]:
    """The score interval of a share, after so many tries of which some were successes (Wilson, JASA 1927);
    anything is possible where nothing was tried."""
    if not number:
        return 0.0, 1.0
    share, z = successes / number, NORMAL
    centre = (share + z * z / (2 * number)) / (1 + z * z / number)
    half = z / (1 + z * z / number) * sqrt(share * (1 - share) / number + z * z / (4 * number * number))
    return max(centre - half, 0.0), min(centre + half, 1.0)
