"""What became of the comparisons of a study."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cleancli.array_types import Bools, Floats, Longs
from cleancli.results.cells import estimated, measured, runs_of, varied
from cleancli.statistics.bootstrap import Estimate, mean_of
from cleancli.statistics.paired import Paired, by_run, counted, holm, paired, signed_rank
from cleancli.statistics.verdict import Bounds, Verdict, more_needed, verdict
from cleancli.study.model import Comparison, Value
from cleancli.study.row import MEASURES, Row, axes_of, chosen
from cleancli.study.schema import SIDES


@dataclass(frozen=True, slots=True)
class Sides:
    """What both sides of a comparison come to. `paired` counts all runs; `first`, `second`: means of what
    ended clean; `difference`: of the first less the second where both did; `failed`: how many episodes did
    not."""

    paired: Paired
    first: Estimate
    second: Estimate
    difference: Estimate
    failed: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Judged:
    """A comparison with its verdict.

    `estimate` is what is claimed to lie within `bounds`: the ratio of the first to the second; where all of
    the second is 0, the mean of the first, which is claimed to be beside 0; of a measure that may be
    negative, how much the first is more than the second times the factor, beside 0; or, where it is compared
    with a limit, the mean of the first; there `sides` is None. `failed`: how many of the first's episodes
    did not end clean. `chance`: the p value of the signed-rank test against the bounds, `adjusted`
    that among all comparisons of the study (Holm). `more`: how many more runs would decide it; None where
    that can't be told, or nothing is left to decide. `idle` and `never`: the sides that carried out no action
    in any episode, and those of which none ended clean although the measure is of the way there.
    """

    comparison: Comparison
    estimate: Estimate
    bounds: Bounds
    sides: Sides | None
    failed: int
    chance: float
    adjusted: float
    verdict: Verdict
    more: int | None
    idle: tuple[str, ...]
    never: tuple[str, ...]

    @property
    def unmeasured(self) -> bool:
        """Whether no episode ended clean, so that nothing is left but what failures count as."""
        return _unmeasured(self.sides, self.never)


def judged(comparisons: Sequence[Comparison], rows: Sequence[Row]) -> tuple[Judged, ...]:
    """The verdicts on all comparisons of a study, in order."""
    found = [
        _against_second(each, rows) if each.limit is None else _against_limit(each, each.limit, rows)
        for each in comparisons
    ]
    adjusted = holm(np.array([each.chance for each in found])).tolist()
    return tuple(replace(each, adjusted=chance) for each, chance in zip(found, adjusted, strict=True))


def _against_second(comparison: Comparison, rows: Sequence[Row]) -> Judged:
    """By the ratio to the second, which is claimed to be the factor, or on one side of it."""
    factor, margin = comparison.factor, comparison.margin
    bounds = _bounds(comparison.expect, factor, margin)
    found = _matched(comparison, rows)
    signed = MEASURES[comparison.measure].signed
    first, second, sides = _sides(found, comparison.measure)
    chance = max(signed_rank(first - end * second) for end in bounds.ends)
    told = {
        side: (found.actions[of], found.clean[of])
        for side, of in zip(SIDES, (~found.is_second, found.is_second), strict=True)
    }
    if signed:
        share = margin * abs(float(second.mean())) if len(second) else margin
        bounds = _bounds(comparison.expect, 0.0, share)
        return _judged(comparison, bounds, mean_of(first - factor * second), chance, told, sides)
    ratio = sides.paired.ratio
    if len(second) and first.any() and not second.any():
        ratio, bounds = estimated(first, comparison.measure), _bounds(comparison.expect, 0.0, 0.0)
    return _judged(comparison, bounds, ratio, chance, told, sides)


def _against_limit(comparison: Comparison, limit: float, rows: Sequence[Row]) -> Judged:
    """By the mean of the first."""
    bounds = _bounds(comparison.expect, limit, comparison.margin * limit)
    own = tuple(chosen(rows, comparison.where, comparison.first))
    values, clean = measured(own, comparison.measure)
    means = by_run(runs_of(own), counted(values, clean))
    chance = max(signed_rank(means - end) for end in bounds.ends)
    return _judged(
        comparison,
        bounds,
        estimated(means, comparison.measure),
        chance,
        {"first": (_actions(own), clean)},
        None,
    )


def _judged(
    comparison: Comparison,
    bounds: Bounds,
    estimate: Estimate,
    chance: float,
    told: Mapping[str, tuple[Longs, Bools]],
    sides: Sides | None,
) -> Judged:
    """`told`: of each side the actions of its episodes, and which of these ended clean."""
    idle = tuple(side for side, (actions, _) in told.items() if len(actions) and not actions.any())
    never = tuple(side for side, (_, clean) in told.items() if len(clean) and not clean.any())
    failed = int((~told["first"][1]).sum())
    if _unmeasured(sides, never):
        found, more, chance = Verdict.UNDECIDED, None, 1.0
    else:
        found = verdict(estimate, bounds)
        more = more_needed(estimate, bounds) if found is Verdict.UNDECIDED else None
    return Judged(comparison, estimate, bounds, sides, failed, chance, chance, found, more, idle, never)


def _unmeasured(sides: Sides | None, never: Sequence[str]) -> bool:
    return len(never) == (1 if sides is None else len(SIDES))


def _actions(rows: Iterable[Row]) -> Longs:
    return np.array([row.actions for row in rows], dtype=np.int64)


def _bounds(expect: str, at: float, margin: float) -> Bounds:
    match expect:
        case "less":
            return Bounds(high=at)
        case "more":
            return Bounds(low=at)
        case "equal":
            return Bounds(at - margin, at + margin)
    raise ValueError(expect)


@dataclass(frozen=True, slots=True)
class _Matched:
    """Rows that have their like on the other side, (n,) each. Those of one of `places` share their run and
    all axes but those that tell the sides apart. `values` of what did not end clean are what it counts as,
    beside all that has these axes, in whichever run."""

    runs: Longs
    places: Longs
    is_second: Bools
    values: Floats
    clean: Bools
    actions: Longs


def _matched(comparison: Comparison, rows: Sequence[Row]) -> _Matched:
    """The rows of a comparison. What tells its sides apart is not in common, nor are axes of which they share
    no value."""
    first, second = (list(chosen(rows, comparison.where, s)) for s in (comparison.first, comparison.second))
    both = [*first, *second]
    apart = {*comparison.first, *comparison.second}
    shared = [
        axis
        for axis in varied(both)
        if axis not in apart and not _of_axis(first, axis).isdisjoint(_of_axis(second, axis))
    ]
    common = [tuple(axes_of(row).get(axis) for axis in shared) for row in both]
    groups, places = _numbered(common), _numbered(zip(runs_of(both).tolist(), common, strict=True))
    is_second = np.arange(len(both)) >= len(first)
    values, clean = measured(both, comparison.measure)
    kept = np.isin(places, np.intersect1d(places[is_second], places[~is_second]))
    for group in np.unique(groups):
        own = kept & (groups == group)
        values[own] = counted(values[own], clean[own])
    actions = _actions(both)[kept]
    return _Matched(runs_of(both)[kept], places[kept], is_second[kept], values[kept], clean[kept], actions)


def _of_axis(rows: Iterable[Row], axis: str) -> set[Value | None]:
    return {axes_of(row).get(axis) for row in rows}


def _numbered(values: Iterable[Hashable]) -> Longs:
    """A number for each, the same for equal ones."""
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(value, len(numbers)) for value in values], dtype=np.int64)


def _sides(found: _Matched, measure: str) -> tuple[Floats, Floats, Sides]:
    """The measure of both sides, run by run, and what they come to."""

    def runs(of: Bools) -> Floats:
        return by_run(found.runs[of], found.values[of])

    first, second, clean = ~found.is_second, found.is_second, found.clean
    both_clean = ~np.isin(found.places, found.places[~clean])
    own, others = runs(first), runs(second)
    sides = Sides(
        paired(own, others, signed=MEASURES[measure].signed),
        estimated(runs(first & clean), measure),
        estimated(runs(second & clean), measure),
        mean_of(runs(first & both_clean) - runs(second & both_clean)),
        (int((first & ~clean).sum()), int((second & ~clean).sum())),
    )
    return own, others, sides
