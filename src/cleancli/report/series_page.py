"""A series as one page of HTML: what each episode took, and how the rules changed by actions (Fig. 10)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from cleancli.files.replace import replace_file
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.recording.folder import PAGE
from cleancli.report.account import RunRow, colour_of, name_of, row_of, taken
from cleancli.report.page import Bar, bars, seconds_text, templates, told_options
from cleancli.report.plots import Marks, Step, band, line, marks, numbered, stairs, thinned
from cleancli.report.rules import RuleCourse, actions_of, courses
from cleancli.report.series import Series, read_series
from cleancli.report.timeline import in_order

UPWARDS = 4
"""Marks at most beside a low plot."""

COLOURS = 6
"""Of outcomes; of a rule with more, those that follow have the first ones again."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A number for each episode: what it is, its line, and the marks of the axis that goes up to the most."""

    name: str
    points: str
    marks: Marks
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class EpisodeView:
    """An episode as the page shows it; `bars` are shares of the longest one's seconds."""

    number: int
    row: RunRow
    bars: tuple[Bar, ...]


@dataclass(frozen=True, slots=True)
class OutcomeView:
    """An outcome's line and band, with the same in figures. `interval` is None where no record says it."""

    text: str
    colour: int
    line: str
    band: str
    prior: float
    probability: float
    seen: float
    interval: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class RuleView:
    """A rule: its outcomes, how many examples it has, from where on it is known, in words, and where that is
    on the axis in percent; None where that is nowhere on it."""

    name: str
    outcomes: tuple[OutcomeView, ...]
    examples: float
    known: str
    known_at: float | None


def write_series_page(folder: Path) -> Series:
    """Write the page of a series into its folder, as far as it has come. Raises as `read_series` and
    `courses`."""
    series = read_series(folder)
    replace_file(folder / PAGE, printable(series_page(series), keep="\n\t"))
    return series


def series_page(series: Series) -> str:
    """The page of a series, as far as it has come; raises as `courses`."""
    rows = [row_of(run) for run in series.runs]
    first, ends = series.runs[0], actions_of(series.runs)
    end = float(ends[-1])
    longest = max(row.total for row in rows)
    kinds = in_order(
        {kind: 0.0 for row in rows for kind, spent in taken(row.seconds, row.symbolic).items() if spent}
    )
    return (
        templates()
        .get_template("series.html")
        .render(
            series=series,
            problem=first.problem,
            verdict=_verdict(series, rows),
            figures=list(_figures(series, rows)),
            curves=[
                _curve("seconds", [row.total for row in rows]),
                _curve("actions", [row.actions for row in rows], least=1.0),
            ],
            episodes=[EpisodeView(n, row, bars(row.seconds, longest)) for n, row in enumerate(rows, 1)],
            numbers=numbered(len(rows)),
            heights=marks(longest),
            kinds=[(kind, name_of(kind), colour_of(kind)) for kind in kinds],
            rules=[_rule(course, end) for course in courses(series.runs)] if end else [],
            action_marks=marks(end, least=1.0),
            ends=[100 * each / end for each in ends[:-1]] if end else [],
            header=first.header,
            options=tuple(told_options(first.header.options, any(row.symbolic for row in rows))),
        )
    )


def _verdict(series: Series, rows: Sequence[RunRow]) -> tuple[str, str]:
    """In a word, which is also its class, and in a sentence."""
    over = sum(row.clean is not None for row in rows)
    clean = sum(bool(row.clean) for row in rows)
    asked = series.header.episodes
    if over < asked:
        return "cut short", f"{over} of {asked} episodes are over: it was stopped or killed, or still goes on"
    word = "done" if any(row.symbolic for row in rows) else "clean"
    if clean == over:
        return word, f"{clean} of {over} episodes ended so"
    return f"not {word}", f"{clean} of {over} episodes ended {word}"


def _figures(series: Series, rows: Sequence[RunRow]) -> Iterator[tuple[str, str]]:
    yield "episodes", f"{len(rows)} of {series.header.episodes}"
    half = max(1, len(rows) // 2)
    goals = [row.goal for row in rows if row.goal is not None]
    if goals:
        yield "the goal held in", f"{sum(goals)} of {len(goals)}"
    yield "actions in all", str(sum(row.actions for row in rows))
    yield "seconds in all", seconds_text(sum(row.total for row in rows))
    if len(rows) > 1:
        first, last = (fmean(row.total for row in part) for part in (rows[:half], rows[-half:]))
        yield f"an episode, of the first {half}", seconds_text(first)
        yield f"an episode, of the last {half}", seconds_text(last)


def _curve(name: str, values: Sequence[float], least: float = 0.0) -> Curve:
    top = max(values)
    return Curve(name, line(values, top), marks(top, UPWARDS, least), tuple(values))


def _rule(course: RuleCourse, end: float) -> RuleView:
    outcomes = tuple(_outcome(course, number, end) for number in range(len(course.outcomes)))
    at = course.known_from
    if at is None:
        known = "not known yet"
    else:
        known = f"known after action {at}" if at else "known from the beginning"
    return RuleView(course.name, outcomes, sum(course.last.seen), known, 100 * at / end if at else None)


def _outcome(course: RuleCourse, number: int, end: float) -> OutcomeView:
    """Before the first point the text's probability holds, of which nothing says how sure it is."""
    stated = course.stated[number]
    steps = [Step(0.0, stated, stated, stated)]
    for point in course.points:
        value = point.probabilities[number]
        low, high = point.intervals[number] if point.intervals else (value, value)
        steps.append(Step(point.action, value, low, high))
    kept = thinned([step for step in steps if step.start <= end], end)
    last = course.last
    return OutcomeView(
        course.outcomes[number],
        number % COLOURS,
        stairs(kept, end),
        band(kept, end),
        course.priors[number],
        last.probabilities[number],
        last.seen[number],
        last.intervals[number] if last.intervals else None,
    )
