"""The page of results and its figures, from rows alone: what was measured, with intervals, and every verdict.

The same rows and studies make the same bytes, in whichever order the rows come.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import isfinite, isnan
from pathlib import Path

from cleancli.files.replace import replace_file
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.diagnostics.plural import plural
from cleancli.results.cells import Cell, cells, telling
from cleancli.results.claims import CLAIMS
from cleancli.results.figures import Figure, figures_of
from cleancli.results.judged import Judged, judged
from cleancli.statistics.bootstrap import FEWEST, Estimate
from cleancli.statistics.verdict import MOST_PAIRS, Bounds, Verdict, together
from cleancli.study.model import Study
from cleancli.study.row import (
    CLEAN,
    CROWDED,
    MEASURES,
    Row,
    Words,
    all_refused,
    axes_of,
    endings,
    is_crowded,
    meaning_of,
    words_for,
)

PAGE = "results.md"
FIGURES = "results"
"""The folder of figures, beside the page."""


@dataclass(frozen=True, slots=True)
class Results:
    """What the rows of a study come to: its parts by name, their figures, and its comparisons."""

    study: Study
    rows: tuple[Row, ...]
    figures: Mapping[str, tuple[Figure, ...]]
    judged: tuple[Judged, ...]


def results_of(study: Study, rows: Iterable[Row]) -> Results:
    """The results of a study; rows of others are left out. Raises ImportError without matplotlib."""
    own = _in_order(study, (row for row in rows if row.study == study.name))
    parts = {name: tuple(found) for name, found in groupby(own, lambda row: row.part)}
    figures = {
        name: figures_of(f"{study.name}_{name}" if name else study.name, found, study.measure)
        for name, found in parts.items()
    }
    return Results(study, own, figures, judged(study.comparisons, own))


def _in_order(study: Study, rows: Iterable[Row]) -> tuple[Row, ...]:
    """By part, by cell as the study lists values, by run and by episode."""
    parts = [part.name for part in study.parts]
    places = {
        (part.name, axis, value): number
        for part in study.parts
        for axis, values in part.axes.items()
        for number, value in enumerate(values)
    }

    def place(row: Row) -> tuple[object, ...]:
        cell = [
            (places.get((row.part, axis, value), len(places)), str(value)) for axis, value in row.axes.items()
        ]
        part = parts.index(row.part) if row.part in parts else len(parts)
        return part, row.part, cell, row.run, row.episode

    return tuple(sorted(rows, key=place))


def write_results(results: Sequence[Results], folder: Path) -> Path:
    """Write the page and its figures, and tell where the page is. Raises OSError."""
    (folder / FIGURES).mkdir(parents=True, exist_ok=True)
    for figure in _figures(results):
        for kind, content in figure.files.items():
            replace_file(folder / FIGURES / f"{figure.name}.{kind}", content)
    replace_file(folder / PAGE, results_page(results))
    return folder / PAGE


def _figures(results: Iterable[Results]) -> Iterator[Figure]:
    for each in results:
        for figures in each.figures.values():
            yield from figures


def results_page(results: Sequence[Results]) -> str:
    """The page as Markdown."""
    return printable("\n\n".join(_blocks(results)) + "\n", keep="\n")


def _blocks(results: Sequence[Results]) -> Iterator[str]:
    """What stands between two empty lines."""
    yield from (_INTRODUCTION, _went_in(results))
    if any(one.comparison.claim for each in results for one in each.judged):
        yield "## The paper's claims"
        yield _table(("claim", "what the paper says", "verdict", "by"), _claims(results))
    for each in results:
        yield f"## {each.study.name}"
        if each.study.about:
            yield each.study.about
        for name, figures in each.figures.items():
            yield from _part(each.study, [row for row in each.rows if row.part == name], name, figures)
        if each.judged:
            yield f"### Comparisons of {each.study.name}"
            yield _table(_COMPARED, map(_compared, each.judged))
            words = words_for(each.rows)
            yield "\n".join(f"- {_verdict(one, words)}" for one in each.judged)


_INTRODUCTION = f"""# Results

Written by `cleancli experiment --report` from the rows of the episodes alone.
How verdicts come about is told in docs/statistics.md of cleancli.

Numbers of this page: `cleancli experiment`.

- Intervals, in brackets, hold a mean or a ratio 95 times in 100; fewer than {FEWEST} runs have none.
- Episodes that did not end clean are in no mean of the way to a clean table, unless its column says so.
  Figures count them behind a ✗.
  In ratios each counts as twice the longest of those that it is compared with. In the symbolic world the same
  holds of episodes that did not finish: the goal does not hold, or something is left of the count.
- *ratio*: of the mean of the first to that of the second, in runs with the same seeds.
  *difference*: where both ended clean. *effect*: the mean difference of runs, in standard deviations.
  *p*: of the signed-rank test of what is expected. *Holm*: the same, among all comparisons of the study."""

_COMPARED = (
    *("comparison", "measure", "pairs", "first", "second", "ratio", "difference"),
    *("the first is", "effect", "p", "Holm", "verdict"),
)


def _went_in(results: Iterable[Results]) -> str:
    """Of how many episodes, with which seeds and versions, and how many had to share a processor."""
    rows = [row for each in results for row in each.rows]
    if not rows:
        return "There are no rows yet."
    seeds = sorted({row.seed for row in rows})
    versions = sorted({f"{name} {version}" for row in rows for name, version in row.versions.items()})
    told = f"seeds {seeds[0]} to {seeds[-1]}" if len(seeds) > 1 else f"seed {seeds[0]}"
    return f"{plural(len(rows), 'episode')}, {told}, with {', '.join(versions)}.{_crowded(rows)}"


def _crowded(rows: Sequence[Row]) -> str:
    """That real time is longer than it need be in some of the episodes."""
    shared = sum(is_crowded(row) for row in rows)
    if not shared:
        return ""
    return (
        f" In {plural(shared, 'episode')} the process had less than {CROWDED:z.0%} of a processor"
        " (`cpu`, `real`): planning and looking, which are real time, took longer than on a free machine."
    )


def _claims(results: Sequence[Results]) -> Iterator[tuple[str, ...]]:
    for number, says in CLAIMS.items():
        by = [
            (f"{each.study.name}: {one.comparison.name}", one.verdict)
            for each in results
            for one in each.judged
            if one.comparison.claim == number
        ]
        found = together([verdict for _, verdict in by])
        told = "; ".join(f"{name} {verdict}" for name, verdict in by)
        yield str(number), says, str(found) if by else "not tested", told


def _part(study: Study, rows: Sequence[Row], name: str, figures: Sequence[Figure]) -> Iterator[str]:
    if name:
        yield f"### {study.name}, {name}"
    yield from (f"![{figure.shows}]({FIGURES}/{figure.name}.svg)" for figure in figures)
    yield _in_common(rows)
    words = words_for(rows)
    if reasons := endings(rows):
        yield f"{words.other.capitalize()}: {reasons}."
    axes = telling(rows)
    measures = dict.fromkeys((study.measure, "actions", *(("left",) if words is CLEAN else ())))
    always = MEASURES[study.measure].always
    columns = [cells(rows, axes, measure, always) for measure in measures]
    meanings = (_heading(measure, words, always) for measure in measures)
    names = [*axes, "runs", f"episodes {words.other}", *meanings]
    yield _table(names, (_cell(same) for same in zip(*columns, strict=True)))


def _heading(measure: str, words: Words, always: bool) -> str:
    """What a column tells; where it counts episodes `always`, also that it does if it usually does not."""
    own = always and not MEASURES[measure].always
    return f"{meaning_of(measure, words)}{f', also where it {words.failed}' if own else ''}"


def _in_common(rows: Sequence[Row]) -> str:
    """The axes that have one value in all rows."""
    told = [axes_of(row).items() for row in rows]
    fixed = [
        f"{axis} {value}"
        for axis, value in told[0]
        if axis != "part" and all((axis, value) in t for t in told)
    ]
    return f"In all: {', '.join(fixed)}."


def _cell(same: Sequence[Cell]) -> tuple[str, ...]:
    """A row of the table of means: one cell by several measures."""
    values = ("" if value is None else str(value) for value in same[0].values)
    dirty = sum(not row.clean for row in same[0].rows)
    refused = all_refused(same[0].rows)
    told = ("refused" if refused else _interval(cell.mean) for cell in same)
    return *values, str(same[0].runs), str(dirty), *told


def _compared(each: Judged) -> tuple[str, ...]:
    named, sides = (each.comparison.name, each.comparison.measure), each.sides
    tests = (_chance(each.chance), _chance(each.adjusted), str(each.verdict))
    if sides is None:
        limit = _number(each.comparison.limit or 0.0)
        return *named, str(each.estimate.count), _interval(each.estimate), limit, "", "", "", "", *tests
    return (
        *named,
        str(sides.paired.pairs),
        _interval(sides.first),
        _interval(sides.second),
        _interval(sides.paired.ratio),
        f"{_interval(sides.difference)} in {sides.difference.count}" if sides.difference.count else "",
        _leaning(each.comparison.expect, sides.paired.lesser),
        _number(sides.paired.effect),
        *tests,
    )


def _leaning(expect: str, lesser: float) -> str:
    """In how many pairs the first is as it is expected to be; where both are to be equal, in how many it is
    less. A tie is half a pair to either side."""
    if isnan(lesser):
        return ""
    return f"more in {1 - lesser:z.0%}" if expect == "more" else f"less in {lesser:z.0%}"


def _verdict(each: Judged, words: Words) -> str:
    """What was expected, the verdict, and why."""
    said = each.comparison
    expected = f" {said.says.rstrip('.')}." if said.says else ""
    claim = "" if said.claim is None else f" (claim {said.claim})"
    return f"**{said.name}**{claim}:{expected} *{each.verdict.capitalize()}*: {reason(each, words)}."


def reason(each: Judged, words: Words = CLEAN) -> str:
    """Why a verdict is as it is, and how many more runs would bring one; before it what the numbers hide: a
    side that did nothing at all or never ended clean."""
    if each.unmeasured:
        nobody = f"no episode {'' if each.sides is None else 'of either side '}{words.ended}"
        return "; ".join((nobody, *(f"the {side} did nothing at all" for side in each.idle)))
    hidden = {side: ["did nothing at all"] for side in each.idle}
    for side in each.never:
        hidden.setdefault(side, []).append(words.never)
    told = (f"the {side} {' and '.join(whats)}" for side, whats in hidden.items())
    return "; ".join((*told, _by_numbers(each, words)))


def _by_numbers(each: Judged, words: Words) -> str:
    within, failed = _within(each.bounds), f"{_no_ratio(each)}{_failures(each, words)}"
    match each.verdict:
        case Verdict.WON:
            return f"all of the interval lies {within}{_by_failures(each, words)}{failed}"
        case Verdict.LOST:
            beyond = _beyond(each.bounds, each.estimate)
            return f"none of the interval lies {within}{beyond}{_by_failures(each, words)}{failed}"
    if not each.estimate.count:
        return "there are no rows to compare"
    if not each.estimate.known and each.estimate.count >= FEWEST:
        return f"both are 0 in every run, and there is no ratio of nothing to nothing{failed}"
    if not each.estimate.known:
        few = plural(each.estimate.count, "run is", "runs are")
        return f"{few} too few; at least {FEWEST} are needed{failed}"
    if each.more is None:
        more = f"the truth is so near to a bound that more than {MOST_PAIRS:,} runs would be needed"
    else:
        more = f"about {plural(each.more, 'more run')} would decide it"
    return f"only a part of the interval lies {within}, and {more}{failed}"


def _by_failures(each: Judged, words: Words) -> str:
    """That a verdict rests on episodes that failed: that each counts as twice the longest is what parts the
    sides, and the difference where both ended clean does not. Nothing of a side that never did, which is said
    before."""
    said, sides = each.comparison, each.sides
    if sides is None or each.never or not any(sides.failed) or said.expect == "equal" or said.factor != 1:
        return ""
    both = sides.difference
    if both.known and (both.high < 0 if sides.paired.ratio.value < 1 else both.low > 0):
        return ""
    told = f"is {_interval(both)}" if both.count else "cannot be told"
    return (
        f", because what {words.failed} counts as twice the longest: where both {words.ended}, the difference"
        f" {told}"
    )


def _within(bounds: Bounds) -> str:
    if not isfinite(bounds.low):
        return f"below {_number(bounds.high)}"
    if not isfinite(bounds.high):
        return f"above {_number(bounds.low)}"
    return f"between {_number(bounds.low)} and {_number(bounds.high)}"


def _no_ratio(each: Judged) -> str:
    """What is judged in place of the ratio: differences where measures may be negative, and the mean of the
    first where the second is 0, since nothing has a ratio to 0."""
    if each.sides is None or not each.estimate.known or not isnan(each.sides.paired.ratio.value):
        return ""
    said = each.comparison
    if MEASURES[said.measure].signed:
        times = "" if said.factor == 1 else f"{_number(said.factor)} times "
        return f", of the first less {times}the second"
    return ", of the mean of the first: the second is 0 in every run"


def _beyond(bounds: Bounds, estimate: Estimate) -> str:
    """On which side of two bounds an interval lies; of one bound there is one side alone."""
    if not (isfinite(bounds.low) and isfinite(bounds.high)):
        return ""
    below = estimate.high < bounds.low
    return f", all of it {f'below {_number(bounds.low)}' if below else f'above {_number(bounds.high)}'}"


def _failures(each: Judged, words: Words) -> str:
    if each.sides is not None and any(each.sides.failed):
        first, second = each.sides.failed
        return f"; {plural(first, 'episode')} of the first and {second} of the second {words.failed}"
    return f"; {plural(each.failed, 'episode')} {words.failed}" if each.failed else ""


def _interval(estimate: Estimate) -> str:
    if not estimate.known:
        return _number(estimate.value)
    return f"{_number(estimate.value)} [{_number(estimate.low)}, {_number(estimate.high)}]"


def _number(value: float) -> str:
    """With three digits; nothing where there is none."""
    if isnan(value):
        return ""
    return f"{value:,.0f}" if abs(value) >= 999.5 else f"{value:z.3g}"


def _chance(value: float) -> str:
    return f"{value:z.2g}" if value >= 0.001 else "< 0.001"


def _table(names: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [names, ["---"] * len(names), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in lines)
