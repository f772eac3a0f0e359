"""When a mean is known well enough that runs may stop.

Runs go on block by block, a block being a run of each of the ways to clean, until Student's interval of each
mean reaches no further than a share of it (Chow and Robbins 1965; of a share, Nadas 1969). Whether to stop
depends on the values, so the interval holds the mean a little less often than it says; FEWEST_BLOCKS keeps
that small (docs/statistics.md).
"""

from __future__ import annotations

from math import sqrt

from scipy.special import stdtrit

from cleancli.array_types import Floats
from cleancli.statistics.bootstrap import MISSED

FEWEST_BLOCKS = 10
"""Chosen: with fewer, runs that happen to be alike stop a study too soon."""


def enough(values: Floats, share: float) -> bool:
    """Whether the interval of the mean of finite values, (n,), reaches at most a share of it to each side."""
    if len(values) < FEWEST_BLOCKS:
        return False
    reach = -stdtrit(len(values) - 1, MISSED / 2) * values.std(ddof=1) / sqrt(len(values))
    return bool(reach <= share * abs(values.mean()))
