"""What became of the comparisons of a study."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from cleancli.results.cells import axes_of, by_run, measured, varied
from cleancli.statistics.bootstrap import Estimate, mean_of
from cleancli.statistics.paired import Paired, Pairs, counted, holm, paired, signed_rank
from cleancli.statistics.verdict import Bounds, Verdict, more_needed, verdict
from cleancli.study.model import Comparison, Value
from cleancli.study.row import Row, chosen

_Place = tuple[int, frozenset[tuple[str, Value]]]
"""The run of a row, and what it has in common with those that it is compared with."""


@dataclass(frozen=True, slots=True)
class Judged:
    """A comparison with its verdict.

    `estimate` is what is claimed to lie within `bounds`: the ratio of the first to the second, or, where it
    is compared with a limit, the mean of the first; there `pairs` is None. `failed`: how many of the first's
    runs did not end clean. `chance`: the p value of the signed-rank test against the bounds, `adjusted` that
    among all comparisons of the study (Holm). `more`: how many more runs would decide it; None where that
    can't be told, or nothing is left to decide.
    """

    comparison: Comparison
    estimate: Estimate
    bounds: Bounds
    pairs: Paired | None
    failed: int
    chance: float
    adjusted: float
    verdict: Verdict
    more: int | None


def judged(comparisons: Sequence[Comparison], rows: Sequence[Row]) -> tuple[Judged, ...]:
    """The verdicts on all comparisons of a study, in order."""
    found = [_judged(comparison, rows) for comparison in comparisons]
    adjusted = holm(np.array([each.chance for each in found])).tolist()
    return tuple(replace(each, adjusted=chance) for each, chance in zip(found, adjusted, strict=True))


def bounds_of(comparison: Comparison) -> Bounds:
    """Between what the ratio to the second, or the mean where there is a limit, is claimed to lie."""
    at = comparison.factor if comparison.limit is None else comparison.limit
    match comparison.expect:
        case "less":
            return Bounds(high=at)
        case "more":
            return Bounds(low=at)
        case "equal":
            reach = comparison.margin * (1.0 if comparison.limit is None else at)
            return Bounds(at - reach, at + reach)
    raise ValueError(comparison.expect)


def _judged(comparison: Comparison, rows: Sequence[Row]) -> Judged:
    bounds = bounds_of(comparison)
    figures: Paired | None = None
    if comparison.limit is None:
        pairs = pairs_of(comparison, rows)
        figures = paired(pairs)
        estimate, failed = figures.ratio, figures.first_failed
        differences = [pairs.first - end * pairs.second for end in bounds.ends]
    else:
        own = tuple(chosen(rows, comparison.where, comparison.first))
        values, clean = measured(own, comparison.measure)
        means, ended = by_run(own, counted(values, clean), clean)
        estimate, failed = mean_of(means), int((~ended).sum())
        differences = [means - end for end in bounds.ends]
    found = verdict(estimate, bounds)
    return Judged(
        comparison,
        estimate,
        bounds,
        figures,
        failed,
        chance=max(map(signed_rank, differences)),
        adjusted=1.0,
        verdict=found,
        more=more_needed(estimate, bounds) if found is Verdict.UNDECIDED else None,
    )


def pairs_of(comparison: Comparison, rows: Sequence[Row]) -> Pairs:
    """The measure of both sides, run by run: of rows that have their like on the other side, which differs in
    nothing but in what tells the sides apart. Axes that only one of two parts has tell nothing."""
    sides = [tuple(chosen(rows, comparison.where, side)) for side in (comparison.first, comparison.second)]
    everything, apart = [*sides[0], *sides[1]], {*comparison.first, *comparison.second}
    shared = {
        axis
        for axis in varied(everything)
        if axis not in apart and all(axis in axes_of(row) for row in everything)
    }
    first, second = (_by_place(side, shared) for side in sides)
    both = [place for place in first if place in second]
    own, others = ([row for place in both for row in side[place]] for side in (first, second))
    values, clean = measured([*own, *others], comparison.measure)
    values = counted(values, clean)
    first_values, first_clean = by_run(own, values[: len(own)], clean[: len(own)])
    second_values, second_clean = by_run(others, values[len(own) :], clean[len(own) :])
    return Pairs(first_values, second_values, first_clean, second_clean)


def _by_place(rows: Iterable[Row], axes: Set[str]) -> dict[_Place, list[Row]]:
    found: dict[_Place, list[Row]] = {}
    for row in rows:
        place = frozenset((axis, value) for axis, value in axes_of(row).items() if axis in axes)
        found.setdefault((row.run, place), []).append(row)
    return found
