"""Intervals of learned probabilities: how sure the examples make them, also where outcomes share examples."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from scipy.stats import beta, binom

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.learning.evidence import Evidence
from cleancli.learning.intervals import effective_examples, interval, intervals
from cleancli.learning.learn import Lesson, learned_from
from cleancli.learning.match import Fit, Match
from cleancli.learning.method import Method

FIT = Fit()


def most_likely(possible: Any, numbers: Any) -> Any:
    """The probabilities that make so many transitions of each kind the likeliest, by many small steps."""
    found = np.full(possible.shape[1], 1 / possible.shape[1])
    for _ in range(20_000):
        found = numbers @ shares(possible, found) / numbers.sum()
    return found


def shares(possible: Any, probabilities: Any) -> Any:
    joint = possible * probabilities
    return joint / joint.sum(axis=1, keepdims=True)


def by_curvature(possible: Any, numbers: Any, best: Any) -> list[float]:
    """As many examples as make a binomial share as uncertain as the curvature of the log-likelihood makes
    each probability, with second differences in place of formulas."""

    def likelihood(free: Any) -> float:
        everything = np.append(free, 1 - free.sum())
        return float(numbers @ np.log(possible @ everything))

    step, free = 1e-4, best[:-1]
    axes = np.eye(len(free)) * step
    curvature = np.array(
        [
            [
                likelihood(free + a + b)
                - likelihood(free + a - b)
                - likelihood(free - a + b)
                + likelihood(free - a - b)
                for b in axes
            ]
            for a in axes
        ]
    ) / (4 * step**2)
    covariance = np.linalg.inv(-curvature)
    variances = [*np.diag(covariance), covariance.sum()]
    return [p * (1 - p) / variance for p, variance in zip(best, variances, strict=True)]


@pytest.mark.parametrize(
    ("possible", "numbers"),
    [
        ([[1, 0], [0, 1], [1, 1]], [6, 3, 11]),
        ([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [20, 5, 2]),
        ([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]], [20, 5, 2, 30]),
        ([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [0, 1, 1]], [9, 7, 4, 20, 6]),
    ],
)
def test_shared_examples_tell_as_much_as_the_likelihood_curves(possible: Any, numbers: Any) -> None:
    possible, numbers = np.array(possible, float), np.array(numbers, float)
    best = most_likely(possible, numbers)
    found = effective_examples(shares(possible, best), numbers, np.zeros(len(best)))
    assert found == pytest.approx(by_curvature(possible, numbers, best), rel=1e-4)
    assert all(found <= numbers.sum() + 1e-9)


def test_what_can_never_be_told_apart_tells_nothing() -> None:
    found = effective_examples(np.array([[0.6, 0.4]]), np.array([500.0]), np.zeros(2))
    assert found == pytest.approx([0, 0], abs=1e-3)
    low, high = interval(0.6 * found[0], found[0])
    assert low < 0.01
    assert high > 0.99


def test_what_the_text_has_counted_is_told_apart() -> None:
    assert effective_examples(np.zeros((0, 2)), np.zeros(0), np.array([8.0, 2.0])) == pytest.approx([10, 10])


@pytest.mark.parametrize(("seen", "examples"), [(3, 10), (9.5, 12.25), (0.2, 40)])
def test_between_its_ends_an_interval_is_that_of_jeffreys(seen: float, examples: float) -> None:
    expected = beta.ppf([0.025, 0.975], seen + 0.5, examples - seen + 0.5)
    assert interval(seen, examples) == pytest.approx(expected, rel=1e-9)


def test_what_never_or_always_happened_reaches_to_the_end() -> None:
    assert interval(0, 12)[0] == 0
    assert interval(12, 12)[1] == 1
    assert interval(0, 0) == (0, 1)


@pytest.mark.parametrize("examples", [12, 40])
def test_about_95_of_100_intervals_hold_the_probability(examples: int) -> None:
    """Counted over all that can be seen, in the mean over probabilities."""
    found = [interval(seen, examples) for seen in range(examples + 1)]
    chances = np.linspace(0.02, 0.98, 97)
    held = [
        sum(binom.pmf(n, examples, p) for n, (low, high) in enumerate(found) if low <= p <= high)
        for p in chances
    ]
    assert np.mean(held) == pytest.approx(0.95, abs=0.01)
    assert min(held) > 0.85


# ---- of the rules of a domain

TEXT = """domain coins {
  types { coin }
  predicates { heads(?c - coin) lost(?c - coin) }
  derived { shown := count ?c - coin: heads(?c) }
  parameters { slip = 0.2 }
  actions { flip(?c - coin) turn(?c - coin) drop(?c - coin) }
  rule flipped: flip(?c) { when not heads(?c) then slip: lost(?c) 0.3: heads(?c) rest: nothing }
  rule turned: turn(?c) { when not heads(?c) then slip: lost(?c) rest: heads(?c) }
  rule dropped: drop(?c) { when not heads(?c) then 0.5 [fixed]: lost(?c) 0.25: heads(?c) 0.25: nothing }
  reward { decrease(shown) }
}"""
DOMAIN = load_domain(Source("coins.nid", TEXT))


def lesson_of(counts: Mapping[Match, int]) -> Lesson:
    order = tuple(index for index, number in enumerate(counts.values()) for _ in range(number))
    return learned_from(DOMAIN, Evidence(tuple(counts), order), Method())


def only(rule: int, outcome: int, of: int) -> Match:
    return Match(rule, tuple(FIT if number == outcome else None for number in range(of)))


def test_a_shared_parameter_has_the_examples_of_all_its_rules() -> None:
    evidence = {only(0, 0, 3): 4, only(0, 1, 3): 6, only(0, 2, 3): 10, only(1, 0, 2): 2, only(1, 1, 2): 8}
    found = intervals(DOMAIN, evidence, lesson_of(evidence))
    assert found[0][0] == found[1][0] == pytest.approx(interval(6, 30))
    assert found[0][1] == pytest.approx(interval(6, 20))
    assert found[1][1] == pytest.approx(interval(8, 10))


def test_what_is_fixed_has_no_width_and_the_others_share_what_it_leaves() -> None:
    evidence = {only(2, 0, 3): 50, only(2, 1, 3): 3, only(2, 2, 3): 7}
    (found,) = intervals(DOMAIN, evidence, lesson_of(evidence)).values()
    assert found[0] == (0.5, 0.5)
    assert found[1] == pytest.approx(np.multiply(0.5, interval(3, 10)))


def test_what_is_never_told_apart_lies_within_what_must_and_may_be_its() -> None:
    both = Match(0, (None, FIT, FIT))
    evidence = {only(0, 0, 3): 10, only(0, 1, 3): 4, both: 16}
    low, high = intervals(DOMAIN, evidence, lesson_of(evidence))[0][1]
    assert low >= interval(4, 30)[0] - 1e-3, "counts are rounded to hundredths"
    assert high <= interval(20, 30)[1] + 1e-3 < 0.9


def test_examples_narrow_an_interval_and_shared_ones_narrow_it_less() -> None:
    def width(number: int, shared: int) -> float:
        both = Match(0, (None, FIT, FIT))
        evidence = {only(0, 1, 3): number, only(0, 2, 3): number, both: shared}
        low, high = intervals(DOMAIN, evidence, lesson_of(evidence))[0][1]
        return high - low

    assert width(20, 0) < width(10, 20) < width(10, 0) + 1e-9
