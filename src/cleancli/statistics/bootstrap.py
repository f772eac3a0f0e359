"""Means of runs, and ratios of means, with intervals from resampling: nothing is assumed of how runs spread.

Percentile intervals (Efron 1979), expanded (Hesterberg 2015): of few values the plain ones are too narrow, so
their two percentiles are moved outwards, by as much as makes the interval of normal values that of Student's
t. Draws are seeded: the same values have the same interval each time.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, nan, sqrt

import numpy as np
from scipy.special import ndtr, stdtrit

from cleancli.array_types import Floats

MISSED = 0.05
"""Chance that an interval does not hold what it is of."""

FEWEST = 5
"""Values that have an interval. Chosen: of fewer, no resampled mean lies as far out as the interval ends."""

RESAMPLES = 10_000
"""Chosen: of five values, about ten resampled means lie outside of either end."""

_SEED = 1979
_AT_ONCE = 1 << 20
"""Drawn values held at a time."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """What `count` values say that something is, and the interval that holds it, 95 times in 100; from minus
    to plus infinity where the values are too few to tell. Of no values, `value` is no number."""

    value: float
    low: float = -inf
    high: float = inf
    count: int = 0

    @property
    def known(self) -> bool:
        """Whether there is an interval."""
        return self.low > -inf


def mean_of(values: Floats) -> Estimate:
    """The mean of finite values, (n,)."""
    if not len(values):
        return Estimate(nan)
    return _estimate(values.mean(), resampled(values[:, None])[:, 0], len(values))


def ratio_of(first: Floats, second: Floats) -> Estimate:
    """The mean of the first over the mean of the second, (n,) each, paired: a pair is drawn as one.

    Values are finite and not negative. No number where all of the second are 0.
    """
    if not second.any():
        return Estimate(nan, count=len(second))
    means = resampled(np.column_stack([first, second]))
    means = means[means[:, 1] > 0]
    return _estimate(first.mean() / second.mean(), means[:, 0] / means[:, 1], len(second))


def resampled(values: Floats) -> Floats:
    """Means of as many rows as there are, drawn with replacement: from (n, k) values, (RESAMPLES, k)."""
    return np.concatenate(list(_portions(values)))


def _portions(values: Floats) -> Iterator[Floats]:
    rng = np.random.default_rng(_SEED)
    many = max(1, _AT_ONCE // len(values))
    for start in range(0, RESAMPLES, many):
        rows = rng.integers(len(values), size=(min(many, RESAMPLES - start), len(values)))
        yield values[rows].mean(axis=1)


def _estimate(value: float, draws: Floats, count: int) -> Estimate:
    """Between the two percentiles that an interval of so many values ends at."""
    if count < FEWEST:
        return Estimate(float(value), count=count)
    outside = ndtr(sqrt(count / (count - 1)) * stdtrit(count - 1, MISSED / 2))
    low, high = np.quantile(draws, (outside, 1 - outside))
    return Estimate(float(value), float(low), float(high), count)
