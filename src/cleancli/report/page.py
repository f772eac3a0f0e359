"""A run as one page of HTML that needs nothing else: no network, pictures inside.

Everything that a file of the user says is escaped by the templates. One script of our own may run, that which
has the hash that the page names; the page is whole without it.
"""

from __future__ import annotations

import base64
import functools
import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path

import jinja2

from cleancli.files.replace import replace_file
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.diagnostics.plural import plural
from cleancli.recording.folder import PAGE
from cleancli.recording.journal import Planned
from cleancli.report.account import colour_of, name_of, row_of, taken
from cleancli.report.pictures import data_uri
from cleancli.report.plots import marks
from cleancli.report.run import Run, read_run
from cleancli.report.steps import NOISE, Step, call, chance_text, facts_text, likeliest, step_text, steps_of
from cleancli.report.timeline import Count, Stretch, in_order, timeline
from cleancli.report.videos import embedded
from cleancli.statistics.bootstrap import Estimate

CURVE_HEIGHT = 100.0


@dataclass(frozen=True, slots=True)
class Bar:
    """A kind of time: its name, the number of its colour, its seconds, and its share of the axis, 0..1."""

    name: str
    colour: int
    seconds: float
    share: float


@dataclass(frozen=True, slots=True)
class Possible:
    """An outcome as a step shows it."""

    probability: float
    text: str
    likeliest: bool
    happened: bool


@dataclass(frozen=True, slots=True)
class StepView:
    """A step with its picture and texts. `changed`: the facts whose symbols rules set, `changed_too`: all
    others. `surprise` is empty where the likeliest outcome came."""

    step: Step
    picture: str | None
    outcomes: tuple[Possible, ...]
    changed: str
    changed_too: str
    surprise: str
    spent: tuple[Bar, ...]


@dataclass(frozen=True, slots=True)
class Segment:
    """A stretch of time on the axis: where it begins and how long it is, in percent."""

    colour: int
    left: float
    width: float
    title: str
    number: int


def write_page(folder: Path) -> Run:
    """Write the page of the run into its folder; what `execute` does at its end. Raises as `read_run`."""
    run = read_run(folder)
    replace_file(folder / PAGE, printable(run_page(run), keep="\n\t"))
    return run


def run_page(run: Run) -> str:
    """The page of one run, as far as the run has come."""
    steps = steps_of(run.records)
    row, first = row_of(run), data_uri(run.picture(0))
    spent = taken(run.spent(), row.symbolic)
    sections = len(steps) + (first is not None)
    script = _script() if sections > 1 else ""
    stretches, counts = timeline(run.records)
    axis = max((s.start + s.seconds for s in stretches), default=0.0)
    return (
        templates()
        .get_template("run.html")
        .render(
            run=run,
            row=row,
            verdict=_verdict(run),
            figures=list(_figures(run, steps)),
            account=bars(spent),
            total=run.total(),
            segments=[_segment(stretch, axis, steps) for stretch in stretches],
            ticks=marks(axis),
            curve=_curve(counts, axis),
            most_areas=max((count.areas for count in counts), default=0),
            first=first,
            sections=sections,
            script=script,
            script_hash=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
            videos=embedded(run.folder, run.videos),
            steps=[_view(step, run, _settable(steps), row.symbolic) for step in steps],
            kinds=[(name_of(kind), colour_of(kind)) for kind in in_order(spent)],
            options=tuple(told_options(run.header.options, row.symbolic)),
        )
    )


def _script() -> str:
    """What shows one step at a time."""
    return templates().get_template("steps.js").render()


def bars(seconds: Mapping[str, float], whole: float | None = None) -> tuple[Bar, ...]:
    """The kinds of time with their share of the `whole`, which is their sum unless it is given."""
    whole = sum(seconds.values()) if whole is None else whole
    return tuple(
        Bar(name_of(kind), colour_of(kind), spent, spent / whole if whole else 0.0)
        for kind, spent in in_order(seconds).items()
    )


@functools.cache
def templates() -> jinja2.Environment:
    """Those of all pages."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("cleancli.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["plural"] = plural
    environment.filters["seconds"] = seconds_text
    environment.filters["interval"] = interval_text
    environment.filters["call"] = lambda step: call(step.action, step.arguments)
    environment.filters["step_text"] = step_text
    environment.filters["measure"] = _measure
    environment.filters["named"] = _named
    environment.filters["said"] = _said
    return environment


_NAMES = {"facts": "facts that hold", "goal": "the goal holds"}
"""What is called otherwise in run.json than on a page."""

_OF_LEARNING = ("estimator", "m", "match", "forgetting")


def _named(name: str) -> str:
    """A key of run.json in words."""
    return _NAMES.get(name, name.replace("_", " "))


def _said(value: object) -> str:
    """A value of run.json in words; points in metres."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return "; ".join(f"{x:z.3f}, {y:z.3f} m" for x, y in value) or "nowhere"
    return str(value)


def told_options(options: Mapping[str, object], symbolic: bool) -> Iterator[tuple[str, object]]:
    """Those that meant something: none of learning where nothing was learned, and no job without a table."""
    idle = _OF_LEARNING if options.get("estimator") is None else ()
    for name, value in options.items():
        if value is not None and name not in idle and not (symbolic and name == "job"):
            yield name, value


def seconds_text(seconds: float) -> str:
    """With as many digits as are of use."""
    return f"{seconds:z.2f} s" if seconds < 10 else f"{seconds:z.1f} s"


def interval_text(estimate: Estimate, digits: int = 1) -> str:
    """A mean with its interval in brackets, where it has one; a dash where there is no mean."""
    if isnan(estimate.value):
        return "-"
    value = f"{estimate.value:z.{digits}f}"
    return f"{value} [{estimate.low:z.{digits}f}, {estimate.high:z.{digits}f}]" if estimate.known else value


def _measure(plan: Planned) -> str:
    """What a plan was found to be worth, how, and by whom; of a strategy that does not plan, nothing."""
    if not plan.measure:
        return "of a strategy that looks no further"
    coverage = "" if plan.coverage is None else f", coverage {plan.coverage:z.2g}"
    return f"value {plan.value:z.2f} ({plan.measure}{coverage}), by {plan.planner}"


def _verdict(run: Run) -> tuple[str, str]:
    """In a word, which is also its class, and in a sentence."""
    episode = run.header.episode
    if episode is None:
        return "cut short", "the run has not ended: it was stopped or killed, or still goes on"
    return row_of(run).verdict, episode.reason


def _figures(run: Run, steps: Sequence[Step]) -> Iterator[tuple[str, str]]:
    row = row_of(run)
    yield "in all" if row.clean is not None else "so far", f"{row.total:z.1f} s"
    yield "actions", str(row.actions)
    if row.goal is not None:
        yield "the goal holds", "yes" if row.goal else "no"
    if steps:
        expected = sum(not _surprise(step, likeliest(step.expected)) for step in steps)
        yield "went as was likeliest", f"{expected} of {len(steps)}"
    if row.areas is not None:
        yield "dirty areas seen at last", str(row.areas)
    if None not in (row.particles, row.left) and (row.particles or row.ink_left is None):
        yield "particles truly left", f"{row.left} of {row.particles}"
    if row.ink_left is not None:
        yield "ink truly left", f"{row.ink_left:z.1%}"
    if row.on_floor:
        yield "particles on the floor", str(row.on_floor)


def _segment(stretch: Stretch, axis: float, steps: Sequence[Step]) -> Segment:
    calls = {step.number: step.call for step in steps}
    what = f"{stretch.number}. {calls[stretch.number]}: " if stretch.number in calls else ""
    title = f"{what}{name_of(stretch.kind)}, {seconds_text(stretch.seconds)} from {stretch.start:z.1f} s on"
    left, width = 100 * stretch.start / axis, 100 * stretch.seconds / axis
    return Segment(colour_of(stretch.kind), left, width, title, stretch.number)


def _curve(counts: Iterable[Count], axis: float) -> str:
    """The number of areas over time, as the points of a line in a box 1000 wide and 100 high."""
    known = list(counts)
    most = max((count.areas for count in known), default=0)
    if not known or not axis or not most:
        return ""
    points: list[tuple[float, float]] = []
    for count in known:
        x, y = 1000 * count.start / axis, CURVE_HEIGHT * (1 - count.areas / most)
        if points:
            points.append((x, points[-1][1]))
        points.append((x, y))
    points.append((1000.0, points[-1][1]))
    return " ".join(f"{x:z.1f},{y:z.1f}" for x, y in points)


def _settable(steps: Iterable[Step]) -> frozenset[str]:
    """The symbols that some outcome would set."""
    outcomes = (outcome for step in steps for outcome in step.expected.outcomes)
    return frozenset(effect.symbol for outcome in outcomes for effect in outcome.effects)


def _view(step: Step, run: Run, settable: frozenset[str], symbolic: bool) -> StepView:
    best = likeliest(step.expected)
    outcomes = tuple(
        Possible(outcome.probability, chance_text(outcome), number == best, number == step.outcome)
        for number, outcome in enumerate(step.expected.outcomes)
    )
    return StepView(
        step,
        data_uri(run.picture(step.number)),
        outcomes,
        facts_text([fact for fact in step.changed if fact.symbol in settable]),
        facts_text([fact for fact in step.changed if fact.symbol not in settable]),
        _surprise(step, best),
        bars(taken(step.seconds, symbolic)),
    )


def _surprise(step: Step, best: int | None) -> str:
    if not step.finished:
        return "the run was cut short here"
    if step.failure:
        return f"failed: {step.failure}"
    if not step.expected.outcomes:
        return "no rule says what to expect"
    if step.outcome is None or step.expected.outcomes[step.outcome].kind == NOISE:
        return "none of the modelled outcomes"
    return "" if step.outcome == best else "not the likeliest outcome"
