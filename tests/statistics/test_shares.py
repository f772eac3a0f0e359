"""Shares of runs have Wilson's interval (docs/statistics.md), in studies and wherever else they are told."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from cleancli.results.cells import cells
from cleancli.results.judged import judged
from cleancli.simulation.summary import share_of as simulated_share
from cleancli.statistics.bootstrap import FEWEST
from cleancli.statistics.shares import share_of
from cleancli.statistics.verdict import Verdict
from cleancli.study.model import Comparison
from support.study_rows import row


@pytest.mark.parametrize(("successes", "number"), [(30, 30), (0, 30), (7, 30), (5, 5), (1, 12)])
def test_it_is_that_of_scipy_and_of_simulate(successes: int, number: int) -> None:
    found = share_of(np.array([1.0] * successes + [0.0] * (number - successes)))
    expected = stats.binomtest(successes, number).proportion_ci(0.95, "wilson")
    assert (found.value, found.count) == (successes / number, number)
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high))
    simulated = simulated_share(successes, number)
    assert (found.low, found.high) == pytest.approx((simulated.low, simulated.high))


def test_too_few_runs_have_none() -> None:
    assert share_of(np.ones(FEWEST)).known
    assert not share_of(np.ones(FEWEST - 1)).known
    assert share_of(np.ones(FEWEST - 1)).value == 1.0
    assert np.isnan(share_of(np.array([])).value)


@pytest.mark.parametrize("share", [0.02, 0.3, 0.9, 0.98])
def test_runs_of_several_episodes_are_missed_no_more_often(share: float) -> None:
    """Of 400 studies of 20 runs, each of 4 episodes that go on from each other or don't, by frequency."""
    rng = np.random.default_rng(3)
    for alike in (True, False):
        missed = 0
        for _ in range(400):
            if alike:
                runs = (rng.random(20) < share).astype(float)
            else:
                runs = (rng.random((20, 4)) < share).mean(axis=1)
            found = share_of(runs)
            missed += not found.low <= share <= found.high
        assert missed / 400 <= 0.05 + 3 * np.sqrt(0.05 * 0.95 / 400) + 0.02


def test_studies_tell_30_of_30_so() -> None:
    """docs/statistics.md: [0.886, 1]."""
    rows = [row({"strategy": "plan-1"}, run, 10.0) for run in range(1, 31)]
    (cell,) = cells(rows, (), "clean")
    assert (cell.mean.low, cell.mean.high) == pytest.approx((0.886, 1.0), abs=0.0005)
    said = Comparison("c", "", "clean", "more", {"strategy": ("plan-1",)}, {}, limit=0.9)
    (found,) = judged([said], rows)
    assert found.verdict is Verdict.UNDECIDED
    assert found.more is not None
    (found,) = judged([Comparison("c", "", "clean", "more", said.first, {}, limit=0.8)], rows)
    assert found.verdict is Verdict.WON
