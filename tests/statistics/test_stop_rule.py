"""Runs that go on until a mean is known well enough: what stopping does to it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import t

from cleancli.array_types import Floats
from cleancli.statistics.stopping import FEWEST_BLOCKS, enough

SPREAD = 0.3
"""Of seconds, in parts of their mean, which is 1."""


def normal(rng: np.random.Generator) -> Floats:
    return rng.normal(1.0, SPREAD, 200)


def gamma(rng: np.random.Generator) -> Floats:
    return rng.gamma(1 / SPREAD**2, SPREAD**2, 200)


def stopped(values: Floats) -> Floats:
    return values[: next(n for n in range(1, len(values) + 1) if enough(values[:n], 0.1))]


@pytest.mark.parametrize("draw", [normal, gamma])
def test_stopping_leaves_the_mean_and_its_interval_nearly_as_they_are(
    draw: Callable[[np.random.Generator], Floats],
) -> None:
    """As docs/statistics.md says: about 35 blocks, a bias below one percent, and 92 to 95 of 100 intervals
    hold the mean."""
    rng = np.random.default_rng(10)
    found = [stopped(draw(rng)) for _ in range(600)]
    means = np.array([each.mean() for each in found])
    reaches = np.array(
        [t.ppf(0.975, len(each) - 1) * each.std(ddof=1) / np.sqrt(len(each)) for each in found]
    )
    assert abs(means.mean() - 1) < 0.012
    assert 0.90 < np.mean(np.abs(means - 1) <= reaches) < 0.97
    assert (reaches <= 0.1 * means).all()
    assert 32 < np.mean([len(each) for each in found]) < 38


def test_few_blocks_are_never_enough() -> None:
    assert not enough(np.ones(FEWEST_BLOCKS - 1), 0.1)
    assert enough(np.ones(FEWEST_BLOCKS), 0.1)
    assert not enough(np.array([]), 0.5)
