"""Verdicts on claims, and how many more runs would bring one."""

from __future__ import annotations

from math import inf, nan

import numpy as np
import pytest
from scipy.stats import t

from cleancli.statistics.bootstrap import Estimate, mean_of, ratio_of
from cleancli.statistics.verdict import Bounds, Verdict, more_needed, together, verdict

LESS, EQUAL = Bounds(high=1.0), Bounds(0.9, 1.1)
WON, LOST, UNDECIDED = Verdict.WON, Verdict.LOST, Verdict.UNDECIDED


@pytest.mark.parametrize(
    ("low", "high", "claimed", "expected"),
    [
        (0.4, 0.9, LESS, WON),
        (0.4, 1.0, LESS, UNDECIDED),
        (1.0, 1.0, LESS, LOST),
        (1.0, 1.2, LESS, LOST),
        (0.9, 1.1, EQUAL, WON),
        (0.9, 1.1, LESS, UNDECIDED),
        (1.05, 1.1, LESS, LOST),
        (0.95, 1.05, EQUAL, WON),
        (0.85, 1.05, EQUAL, UNDECIDED),
        (0.5, 0.8, EQUAL, LOST),
        (1.2, 1.8, EQUAL, LOST),
        (0.5, 2.0, EQUAL, UNDECIDED),
        (0.2, 0.4, Bounds(0.5), LOST),
        (0.2, 0.5, Bounds(0.5), LOST),
        (0.5, 0.6, Bounds(0.5), UNDECIDED),
        (0.6, 0.7, Bounds(0.5), WON),
    ],
)
def test_the_interval_decides(low: float, high: float, claimed: Bounds, expected: Verdict) -> None:
    assert verdict(Estimate((low + high) / 2, low, high, 20), claimed) is expected


def test_few_runs_and_none_decide_nothing() -> None:
    for estimate in (Estimate(0.1, count=4), Estimate(nan)):
        assert verdict(estimate, LESS) is UNDECIDED
        assert more_needed(estimate, LESS) is None


def test_a_claim_is_won_where_all_comparisons_are() -> None:
    assert together([WON, WON]) is WON
    assert together([WON, UNDECIDED]) is UNDECIDED
    assert together([UNDECIDED, LOST, WON]) is LOST
    assert together([]) is UNDECIDED


@pytest.mark.parametrize(("mean", "claimed"), [(0.9, LESS), (1.08, LESS), (0.98, EQUAL), (0.8, EQUAL)])
def test_so_many_runs_decide_four_times_in_five(mean: float, claimed: Bounds) -> None:
    """The number told of an estimate that is as the truth is, and then as many runs drawn anew."""
    rng = np.random.default_rng(8)
    truth = rng.normal(0, 0.2, 12)
    pilot = mean_of(mean + (truth - truth.mean()) * 0.2 / truth.std(ddof=1))
    more = more_needed(pilot, claimed)
    assert more is not None
    found = [verdict(mean_of(each), claimed) for each in rng.normal(mean, 0.2, (200, 12 + more))]
    assert 0.70 < np.mean([each is not UNDECIDED for each in found]) < 0.92


def test_so_many_pairs_decide_of_ratios() -> None:
    rng = np.random.default_rng(9)

    def pairs(number: int) -> Estimate:
        second = rng.gamma(9.0, 1.0, number)
        return ratio_of(0.9 * second + rng.normal(0, 1.5, number) + 1, second + 1)

    told = [
        more_needed(Estimate(0.91, 0.91 + e.low - e.value, 0.91 + e.high - e.value, 15), LESS)
        for e in (pairs(15) for _ in range(40))
    ]
    number = 15 + int(np.median([each for each in told if each is not None]))
    decided = [verdict(pairs(number), LESS) is not UNDECIDED for _ in range(200)]
    assert 0.68 < np.mean(decided) < 0.92


def test_the_number_of_runs_is_that_of_the_normal_approximation() -> None:
    """An interval of 0.2 to each side of 0.9, of 10 runs, whose spread is then 0.2 * sqrt(10) / 2.262."""
    spread = 0.2 * 10**0.5 / t.ppf(0.975, 9)
    needed = ((1.95996 + 0.84162) * spread / 0.1) ** 2 + 1.95996**2 / 2
    assert more_needed(Estimate(0.9, 0.7, 1.1, 10), LESS) == np.ceil(needed) - 10 == 54
    assert more_needed(Estimate(0.9, 0.5, 1.1, 10), LESS) == 54, "the side of the bound tells"
    assert more_needed(Estimate(0.9, 0.7, 1.0, 10), LESS) == 8
    assert more_needed(Estimate(0.5, 0.3, 0.6, 100), LESS) == 1, "at least"


def test_of_what_lies_on_a_bound_no_number_is_told() -> None:
    assert more_needed(Estimate(1.0, 0.8, 1.2, 20), LESS) is None
    assert more_needed(Estimate(0.9999, 0.8, 1.2, 20), LESS) is None


def test_more_runs_are_needed_the_nearer_a_bound_is() -> None:
    def needed(value: float) -> int:
        found = more_needed(Estimate(value, value - 0.2, value + 0.2, 10), LESS)
        assert found is not None
        return found

    assert needed(0.95) > needed(0.9) > needed(0.85) >= 1


def test_bounds_know_their_finite_ends() -> None:
    assert Bounds().ends == ()
    assert LESS.ends == (1.0,)
    assert EQUAL.ends == (0.9, 1.1)
    assert Bounds(0.5, inf).ends == (0.5,)
