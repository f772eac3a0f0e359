"""Means, shares and their intervals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.task import GroundAction
from cleancli.simulation.episode import Episode, Reason
from cleancli.simulation.summary import Estimate, mean_of, share_of, summarized
from cleancli.statistics.shares import wilson


def test_the_interval_of_a_mean_is_students() -> None:
    values = [1.0, 2.0, 4.0, 4.5]
    low, high = stats.t.interval(0.95, 3, np.mean(values), stats.sem(values))
    found = mean_of(values)
    assert (found.mean, found.low, found.high) == pytest.approx((2.875, low, high))
    assert mean_of([3.0]) == Estimate(3.0, None, None)


@pytest.mark.parametrize(("successes", "number"), [(0, 10), (7, 10), (10, 10), (1, 1), (95, 100)])
def test_the_interval_of_a_share_is_wilsons(successes: int, number: int) -> None:
    interval = stats.binomtest(successes, number).proportion_ci(0.95, "wilson")
    found = share_of(successes, number)
    assert (found.low, found.high) == pytest.approx((interval.low, interval.high))
    assert wilson(successes, number) == (found.low, found.high)
    assert wilson(0, 0) == (0.0, 1.0), "where nothing was tried"


def _episode(number: int, discounted: float, success: bool | None, seconds: float | None) -> Episode:
    done = (GroundAction("push", ("a",), None),) * number
    return Episode(number, Reason.LIMIT, success, discounted, 2.0, done, 3.0 * number, seconds, (0.1, 0.3))


def test_a_summary_says_what_it_lacks() -> None:
    first = [_episode(n, float(n), None, 4.0) for n in range(3)]
    second = [_episode(n, n + 0.5, n > 0, None if n else 1.0) for n in range(3)]
    mine, other = summarized("one", first, None), summarized("two", second, first)
    assert (mine.gain, mine.success, mine.seconds) == (None, None, Estimate(4.0, 4.0, 4.0))
    assert (other.gain, other.seconds) == (Estimate(0.5, 0.5, 0.5), None)
    assert other.success is not None
    assert other.success.mean == pytest.approx(2 / 3)
    assert mine.actions.mean == 1
    assert mine.cost.mean == 3
    assert mine.reasons == {Reason.LIMIT: 3}
    assert (mine.planning_median, mine.planning_95) == pytest.approx((0.2, 0.3))
