"""Shares of tries that were successes, with their intervals."""

from __future__ import annotations

from math import sqrt

NORMAL = 1.959963984540054
"""The standard normal distribution's quantile for a two-sided interval of 95 %."""


def wilson(successes: int, number: int) -> tuple[float, float]:
    """The score interval of a share, after so many tries of which some were successes (Wilson, JASA 1927);
    anything is possible where nothing was tried."""
    if not number:
        return 0.0, 1.0
    share, z = successes / number, NORMAL
    centre = (share + z * z / (2 * number)) / (1 + z * z / number)
    half = z / (1 + z * z / number) * sqrt(share * (1 - share) / number + z * z / (4 * number * number))
    return max(centre - half, 0.0), min(centre + half, 1.0)
