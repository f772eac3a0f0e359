"""Two ways to clean, compared run by run: the runs of a pair have one seed.

A run that did not end clean is never a fast one: it counts as longer than every other run of the comparison,
so it loses its pair to one that did, and two of them are equal (as worst-rank scores do, Lachin 1999).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import erfc, nan, sqrt

import numpy as np

from cleancli.array_types import Bools, Floats, Longs
from cleancli.statistics.bootstrap import Estimate, mean_of, ratio_of

MOST_EXACT = 200
"""Pairs of which the test's distribution is enumerated. Chosen: the normal one is as good for more."""


@dataclass(frozen=True, slots=True)
class Pairs:
    """A measure of runs, pair by pair, and which of them ended clean, (n,) each. Those that did not have the
    value that they count as (`counted`)."""

    first: Floats
    second: Floats
    first_clean: Bools
    second_clean: Bools


@dataclass(frozen=True, slots=True)
class Paired:
    """What pairs come to. `first`, `second`: means of the runs that ended clean; `first_failed` and
    `second_failed`: how many did not. `difference`: of the first less the second, over pairs of which both
    ended clean. `ratio`: of the mean of the first to that of the second, over all pairs. `effect`: the mean
    difference of all pairs in standard deviations of their differences (Cohen 1988, d_z); no number where all
    differ alike. `lesser`: the share of pairs of which the first is less; a tie is half a pair."""

    pairs: int
    first: Estimate
    second: Estimate
    first_failed: int
    second_failed: int
    difference: Estimate
    ratio: Estimate
    effect: float
    lesser: float


def counted(values: Floats, clean: Bools) -> Floats:
    """Values of all runs of a comparison, with those that did not end clean longer than every other."""
    return np.where(clean, values, np.nextafter(values.max(initial=0.0), np.inf))


def paired(pairs: Pairs) -> Paired:
    """The figures of a comparison; values are not negative."""
    both = pairs.first_clean & pairs.second_clean
    more = pairs.first - pairs.second
    spread = more.std(ddof=1) if len(more) > 1 else 0.0
    return Paired(
        pairs=len(more),
        first=mean_of(pairs.first[pairs.first_clean]),
        second=mean_of(pairs.second[pairs.second_clean]),
        first_failed=int((~pairs.first_clean).sum()),
        second_failed=int((~pairs.second_clean).sum()),
        difference=mean_of(more[both]),
        ratio=ratio_of(pairs.first, pairs.second),
        effect=float(more.mean() / spread) if spread else nan,
        lesser=float(((more < 0) + (more == 0) / 2).mean()) if len(more) else nan,
    )


def signed_rank(differences: Floats) -> float:
    """How likely chance alone makes paired differences, (n,), lean so far to either side: the p value of
    Wilcoxon's signed-rank test (1945).

    Differences of 0 are left out, equal ones share their ranks. Exact up to MOST_EXACT pairs: all signs are
    equally likely, and their sums of ranks are counted. For more the sum is taken for normal.
    """
    differences = differences[differences != 0]
    doubled = _doubled_ranks(np.abs(differences))
    total = int(doubled.sum())
    lean = abs(2 * int(doubled[differences > 0].sum()) - total)
    if not len(doubled):
        return 1.0
    if len(doubled) > MOST_EXACT:
        return erfc(lean / sqrt(2 * float((doubled.astype(float) ** 2).sum())))
    chances = np.zeros(total + 1)
    chances[0] = 1.0
    for rank in doubled:
        chances = (chances + np.concatenate([np.zeros(rank), chances[: total + 1 - rank]])) / 2
    leans = np.abs(2 * np.arange(total + 1) - total)
    return float(min(1.0, chances[leans >= lean].sum()))


def holm(chances: Floats) -> Floats:
    """The p values of the tests of one family, (n,), raised so that chance alone makes any of them less than
    0.05 in at most one of twenty families (Holm 1979)."""
    order = np.argsort(chances, kind="stable")
    raised = np.maximum.accumulate(chances[order] * np.arange(len(chances), 0, -1))
    adjusted = np.empty(len(chances))
    adjusted[order] = np.minimum(raised, 1.0)
    return adjusted


def _doubled_ranks(values: Floats) -> Longs:
    """Twice the ranks from 1 on: those that equal values share end in a half at most."""
    _, which, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    ranks: Longs = (2 * last - counts + 1)[which]
    return ranks
