"""Comparisons by pairs: differences, who fails, the signed-rank test and Holm's correction."""

from __future__ import annotations

from itertools import permutations, product
from math import isnan

import numpy as np
import pytest
from scipy.stats import rankdata, wilcoxon

from cleancli.array_types import Floats
from cleancli.statistics.paired import MOST_EXACT, counted, holm, paired, signed_rank


def by_all_signs(differences: Floats) -> float:
    """The share of the ways to give signs to the ranks that lean as far, each of them tried."""
    kept = differences[differences != 0]
    ranks = rankdata(np.abs(kept))
    lean = abs((np.sign(kept) * ranks).sum())
    leans = [abs(np.dot(signs, ranks)) for signs in product((-1, 1), repeat=len(kept))]
    return float(np.mean([each >= lean - 1e-9 for each in leans]))


def test_figures_of_a_comparison_by_hand() -> None:
    found = paired(np.array([1.0, 2.0, 3.0, 6.0]), np.array([2.0, 4.0, 3.0, 5.0]))
    assert found.pairs == 4
    assert found.ratio.value == pytest.approx(6 / 7)
    assert found.effect == pytest.approx(-0.5 / np.std([-1, -2, 0, 1], ddof=1))
    assert found.lesser == (2 + 0.5) / 4


def test_a_run_that_failed_is_never_a_fast_one() -> None:
    """It gave up after two seconds, where the other took ten."""
    first, second = counted(
        np.array([[9.0, 2.0, 8.0], [10.0, 10.0, 12.0]]), np.array([[True, False, True], [True, True, True]])
    )
    found = paired(first, second)
    assert found.lesser == pytest.approx(2 / 3)
    assert found.ratio.value == pytest.approx((9 + 2 * 12 + 8) / 32)
    assert first[1] == pytest.approx(2 * 12)
    assert counted(np.zeros(2), np.array([False, True]))[0] > 0, "also where nothing took any time"


def test_who_always_fails_loses_every_pair_and_two_who_fail_are_equal() -> None:
    values, nobody = np.array([[3.0, 4.0, 5.0], [6.0, 7.0, 8.0]]), np.zeros(3, bool)
    losing = paired(*counted(values, np.stack([nobody, ~nobody])))
    assert losing.lesser == 0.0
    assert losing.ratio.value > 1
    both = paired(*counted(values, np.stack([nobody, nobody])))
    assert both.lesser == 0.5
    assert both.ratio.value == 1.0
    assert isnan(both.effect)


def test_without_pairs_nothing_is_told() -> None:
    found = paired(np.array([]), np.array([]))
    assert found.pairs == 0
    assert all(map(isnan, (found.ratio.value, found.effect, found.lesser)))


@pytest.mark.parametrize("seed", range(12))
def test_signed_rank_counts_all_signs(seed: int) -> None:
    """With differences of 0 and with equal ones."""
    rng = np.random.default_rng(seed)
    differences = rng.integers(-6, 9, rng.integers(2, 12)).astype(float)
    assert signed_rank(differences) == pytest.approx(by_all_signs(differences))


@pytest.mark.parametrize("count", [5, 20, 50, MOST_EXACT])
def test_signed_rank_is_that_of_scipy(count: int) -> None:
    differences = np.random.default_rng(count).normal(0.3, 1.0, count)
    assert signed_rank(differences) == pytest.approx(wilcoxon(differences, method="exact").pvalue, rel=1e-6)


def test_the_normal_distribution_takes_over_where_it_is_as_good() -> None:
    differences = np.random.default_rng(1).normal(0.1, 1.0, MOST_EXACT + 100)
    exact = wilcoxon(differences, method="exact").pvalue
    assert signed_rank(differences) == pytest.approx(exact, rel=0.02)


def test_signed_rank_of_nothing_and_of_equal_pairs_says_nothing() -> None:
    assert signed_rank(np.array([])) == 1.0
    assert signed_rank(np.zeros(7)) == 1.0


def test_chance_alone_seldom_makes_p_small() -> None:
    rng = np.random.default_rng(2)
    found = np.array([signed_rank(each) for each in rng.normal(0, 1, (2000, 12))])
    assert np.mean(found <= 0.05) == pytest.approx(0.05, abs=0.012)


def stepwise(chances: tuple[float, ...]) -> list[float]:
    """Holm's procedure as he tells it: each is adjusted to the least level at which it is rejected, and that
    is so if each with a smaller p is rejected too, at the level over as many as are left."""
    levels = np.linspace(0, 1, 2001)[1:]
    found = []
    for chance in chances:
        smaller = sorted(each for each in chances if each <= chance)
        rejected = [
            all(each <= level / (len(chances) - place) + 1e-12 for place, each in enumerate(smaller))
            for level in levels
        ]
        found.append(float(levels[rejected.index(True)]) if True in rejected else 1.0)
    return found


def test_holm_rejects_step_by_step() -> None:
    for chances in permutations((0.001, 0.0125, 0.02, 0.4)):
        assert holm(np.array(chances)) == pytest.approx(stepwise(chances), abs=5.1e-4)
    assert list(holm(np.array([]))) == []
    assert list(holm(np.array([0.3]))) == [0.3]


def test_few_families_without_any_difference_have_one_that_stands() -> None:
    rng = np.random.default_rng(7)
    families = rng.uniform(size=(4000, 6))
    assert np.mean([holm(each).min() < 0.05 for each in families]) == pytest.approx(0.05, abs=0.011)
