"""Intervals from resampling: how often they hold the mean, and the draws that they are from."""

from __future__ import annotations

from itertools import product
from math import isnan, sqrt

import numpy as np
import pytest
from scipy.stats import norm, t

from cleancli.array_types import Floats
from cleancli.statistics.bootstrap import FEWEST, Estimate, mean_of, ratio_of, resampled


def by_all_resamples(values: Floats) -> tuple[float, float]:
    """The expanded percentile interval over each of the n^n resamples, by its definition: the level is that
    at which the normal percentile interval, whose spread has n and not n - 1 below it, is Student's."""
    count = len(values)
    means = np.array([np.mean(each) for each in product(values, repeat=count)])
    outside = norm.cdf(-sqrt(count / (count - 1)) * t.ppf(0.975, count - 1))
    return float(np.quantile(means, outside)), float(np.quantile(means, 1 - outside))


@pytest.mark.parametrize("values", [(1.0, 2.0, 4.0, 8.0, 16.0), (10.0, 12.0, 15.0, 11.0, 30.0, 14.0)])
def test_the_interval_is_that_of_all_resamples(values: tuple[float, ...]) -> None:
    found, (low, high) = mean_of(np.array(values)), by_all_resamples(np.array(values))
    assert found.value == pytest.approx(np.mean(values))
    assert found.count == len(values)
    assert found.low == pytest.approx(low, abs=0.01 * np.ptp(values))
    assert found.high == pytest.approx(high, abs=0.03 * np.ptp(values))


@pytest.mark.parametrize(("count", "least"), [(5, 0.88), (8, 0.90), (20, 0.91)])
def test_intervals_hold_the_mean_about_as_often_as_they_say(count: int, least: float) -> None:
    """Of seconds, which are skewed: gamma with a standard deviation of half the mean."""
    rng = np.random.default_rng(3)
    held = [each.low <= 4.0 <= each.high for each in map(mean_of, rng.gamma(4.0, 1.0, (300, count)))]
    assert least < np.mean(held) < 0.985


def test_intervals_of_ratios_hold_them_and_pairs_make_them_narrow() -> None:
    """Pairs share what a seed makes of both."""
    rng = np.random.default_rng(4)
    shared = rng.gamma(9.0, 1.0, (200, 12))
    first, second = 0.5 * shared + 5 + rng.normal(0, 0.5, shared.shape), shared + 10
    found = [ratio_of(a, b) for a, b in zip(first, second, strict=True)]
    assert 0.89 < np.mean([each.low <= 0.5 <= each.high for each in found]) < 0.985
    apart = [ratio_of(a, b[::-1]) for a, b in zip(first[:20], second[:20], strict=True)]
    assert sum(e.high - e.low for e in found[:20]) < 0.6 * sum(e.high - e.low for e in apart)


def test_every_value_is_drawn_as_often_and_rows_stay_together() -> None:
    values = np.arange(50.0)
    means = resampled(np.column_stack([values, 2 * values]))
    assert means[:, 0].mean() == pytest.approx(values.mean(), rel=0.01)
    assert means[:, 0].std() == pytest.approx(values.std() / sqrt(50), rel=0.03)
    assert np.allclose(means[:, 1], 2 * means[:, 0])


def test_many_values_are_drawn_in_portions() -> None:
    means = resampled(np.random.default_rng(5).normal(3.0, 1.0, (2000, 1)))
    assert means.shape == (10_000, 1)
    assert means.std() == pytest.approx(1 / sqrt(2000), rel=0.05)


def test_the_same_values_have_the_same_interval() -> None:
    values = np.random.default_rng(6).gamma(4.0, 1.0, 9)
    assert mean_of(values) == mean_of(values.copy())


def test_few_values_have_a_mean_and_no_interval() -> None:
    few = np.array([1.0, 2.0, 4.0, 5.0])
    assert len(few) == FEWEST - 1
    assert mean_of(few) == Estimate(3.0, count=4)
    assert not mean_of(few).known
    assert ratio_of(few, few * 2) == Estimate(0.5, count=4)


def test_of_nothing_there_is_no_mean_and_over_nothing_no_ratio() -> None:
    assert isnan(mean_of(np.array([])).value)
    assert isnan(ratio_of(np.ones(6), np.zeros(6)).value)
    assert not ratio_of(np.ones(6), np.zeros(6)).known


def test_resamples_over_nothing_are_left_out_of_a_ratio() -> None:
    second = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
    found = ratio_of(np.ones(5), second)
    assert found.value == pytest.approx(5.0)
    assert np.isfinite([found.low, found.high]).all()
