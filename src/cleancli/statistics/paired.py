"""Two ways to clean, compared run by run: the runs of a pair have one seed.

A run that did not end clean is never a fast one: it counts as twice the longest of all, as in penalized
averages of run times (Hutter et al. 2009). So it loses its pair to one that did, and two of them are equal.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import erfc, nan, sqrt

import numpy as np

from cleancli.array_types import Bools, Floats, Longs
from cleancli.statistics.bootstrap import Estimate, ratio_of

MOST_EXACT = 200
"""Pairs of which the test's distribution is enumerated. Chosen: the normal one is as good for more."""

PENALTY = 2.0
"""How many of the longest runs one that did not end clean counts as. Chosen, as in competitions of solvers:
after it, all has yet to be done."""


@dataclass(frozen=True, slots=True)
class Paired:
    """What pairs come to. `ratio`: of the mean of the first to that of the second. `effect`: their mean
    difference in standard deviations of differences (Cohen 1988, d_z); no number where all differ alike.
    `lesser`: the share of pairs of which the first is less, where a tie is half a pair; no number without."""

    pairs: int
    ratio: Estimate
    effect: float
    lesser: float


def by_run(runs: Longs, values: Floats) -> Floats:
    """The mean of the values of each run, in the order of the runs' numbers; (n,) each."""
    _, which = np.unique(runs, return_inverse=True)
    return np.bincount(which, values) / np.bincount(which)


def counted(values: Floats, clean: Bools) -> Floats:
    """What is measured of runs, (n,), with what those count as that did not end clean: more than every other,
    also where all are 0."""
    return np.where(clean, values, np.nextafter(PENALTY * values.max(initial=0.0), np.inf))


def paired(first: Floats, second: Floats, *, signed: bool = False) -> Paired:
    """The figures of pairs, (n,) each; of values that may be negative, `signed`, there is no ratio."""
    more = first - second
    spread = more.std(ddof=1) if len(more) > 1 else 0.0
    return Paired(
        pairs=len(more),
        ratio=Estimate(nan, count=len(second)) if signed else ratio_of(first, second),
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
