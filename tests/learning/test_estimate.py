"""Equations 4 and 5 against figures worked out by hand."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom

from cleancli.learning.estimate import ESTIMATORS, decreasing_m_estimate, examples_needed, m_estimate


def weight_of_prior(estimator: str, examples: int) -> float:
    """The share of the prior in an estimate: what it is when nothing was seen and the prior is 1."""
    return ESTIMATORS[estimator](0, examples, 1.0, 10.0)


@pytest.mark.parametrize(
    ("examples", "decreasing", "plain"),
    [(1, 0.91, 0.91), (4, 0.56, 0.71), (12, 0.19, 0.45), (50, 0.03, 0.17)],
)
def test_weight_of_the_prior_fades_faster(examples: int, decreasing: float, plain: float) -> None:
    assert weight_of_prior("decreasing-m", examples) == pytest.approx(decreasing, abs=0.006)
    assert weight_of_prior("m", examples) == pytest.approx(plain, abs=0.006)


def test_equations_as_written() -> None:
    p, n, m, p0 = 3, 4, 10.0, 0.3
    assert m_estimate(p, p + n, p0, m) == pytest.approx((p + m * p0) / (p + n + m))
    shrunk = m / math.sqrt(p + n)
    assert decreasing_m_estimate(p, p + n, p0, m) == pytest.approx((p + shrunk * p0) / (p + n + shrunk))


def test_without_examples_the_prior_stays() -> None:
    assert decreasing_m_estimate(0, 0, 0.37) == 0.37
    assert m_estimate(0, 0, 0.37) == pytest.approx(0.37)


@given(st.lists(st.integers(0, 40), min_size=1, max_size=6), st.sampled_from(sorted(ESTIMATORS)))
def test_estimates_of_a_rule_sum_to_one(seen: list[int], estimator: str) -> None:
    prior = 1 / len(seen)
    total = sum(ESTIMATORS[estimator](count, sum(seen), prior, 10.0) for count in seen)
    assert total == pytest.approx(1)


@pytest.mark.parametrize(("epsilon", "delta"), [(0.1, 0.05), (0.2, 0.1), (0.3, 0.01)])
def test_so_many_examples_are_enough(epsilon: float, delta: float) -> None:
    """Eq. 6: as few as its bound asks for, and estimates of any p are as good as it says."""
    needed = examples_needed(epsilon, delta)
    assert 2 * math.exp(-2 * needed * epsilon**2) <= delta
    assert 2 * math.exp(-2 * (needed - 1) * epsilon**2) > delta
    for p in (0.1, 0.5, 0.8):
        below = binom.cdf(math.ceil(needed * (p - epsilon)) - 1, needed, p)
        above = binom.sf(math.floor(needed * (p + epsilon)), needed, p)
        assert below + above <= delta
