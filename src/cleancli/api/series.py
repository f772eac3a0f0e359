"""Episodes one after the other, each with its own seed, that carry on what was learned (§6.3)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from cleancli.api.inputs import LoadedProblem
from cleancli.api.learned import LearningResult
from cleancli.api.lessons import knowledge, rule_changes, taught
from cleancli.api.run_inputs import Inputs
from cleancli.api.run_result import RunResult
from cleancli.api.run_session import alone_in
from cleancli.api.runs import OpenedRun, new_run
from cleancli.api.tables import TextTable
from cleancli.execution.believed import lesson_of
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Experience
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.experience import Transition, read_experience
from cleancli.learning.gathered import Origin, whole
from cleancli.planning.plan import BadOption
from cleancli.recording.folder import EXPERIENCE, PAGE
from cleancli.recording.series import begun_series, remove_if_empty
from cleancli.report.series_page import write_series_page

CarryOut = Callable[[OpenedRun], RunResult]


PAGES = 10
"""The page is written anew after each of so many episodes, and then each time that the series has grown by
one in so many. Chosen: each time all episodes are read."""


@dataclass(frozen=True, slots=True)
class Series:
    """A series that is about to begin. `inputs` are those of the first episode. `writes`: what was learned
    goes into the domain's file after each, which `is_writable`, and names the records as being in a folder
    that is `called` so; "": as being where they are."""

    given: LoadedProblem
    inputs: Inputs
    episodes: int
    runs: Path
    video: bool
    is_writable: bool
    writes: bool = False
    include_outside: bool = False
    called: str = ""


@dataclass(frozen=True, slots=True)
class SeriesResult:
    """What a series of episodes came to; `learned` from all of them, None where nothing is learned, and the
    `experience` of each. `folder`: that of the series; None of a single episode."""

    runs: tuple[RunResult, ...]
    learned: LearningResult | None
    folder: Path | None = None
    experience: tuple[Experience, ...] = field(default=(), repr=False)

    @property
    def is_clean(self) -> bool:
        """Whether every episode ended so."""
        return all(run.clean for run in self.runs)

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli execute --episodes N --json` prints."""
        learned = {} if self.learned is None else self.learned.to_dict()
        return {"episodes": [run.to_dict() for run in self.runs], **learned}

    def table(self) -> TextTable:
        """A row for each episode: how it ended, and the seconds that it took by kind (Fig. 10)."""
        kinds = tuple(self.runs[0].seconds)
        heads = ("episode", "clean", "actions", "seconds", *(kind.replace("_", " ") for kind in kinds))
        rows = tuple(
            (
                str(number),
                "yes" if run.clean else "no",
                str(run.actions),
                f"{sum(run.seconds.values()):z.1f}",
                *(f"{run.seconds[kind]:z.1f}" for kind in kinds),
            )
            for number, run in enumerate(self.runs, start=1)
        )
        return TextTable(heads, rows, (1,))

    def __str__(self) -> str:
        return "\n".join(self._parts())

    def _parts(self) -> Iterator[str]:
        if self.folder is not None:
            yield str(self.table())
            yield f"series: {self.folder}/  page: {PAGE}"
        if self.learned is not None:
            yield str(self.learned)

    def _repr_html_(self) -> str:
        learned = "" if self.learned is None else self.learned._repr_html_()
        return f"<div>{self.table().html()}{learned}</div>"


def carried_out(series: Series, carry_out: CarryOut) -> Iterator[SeriesResult]:
    """Carry out the episodes in turn, the seed of each one more than that of the one before, and give after
    each what the series has come to; what was learned is in the domain's file by then, where it is written.
    Several episodes have a folder of their own, with a page about them.

    Raises what `new_run` and carrying an episode out do, and what writing does (`LearningResult.write`).
    """
    if series.writes and series.inputs.options.structure:
        raise BadOption(
            "whole rules are not written while a robot works: learn them from the runs afterwards, with"
            " `cleancli learn --structure DOMAIN RUNS --write`"
        )
    if series.episodes == 1:
        yield from episodes_left(series, SeriesResult((), None), carry_out)
        return
    options = series.inputs.options
    stem = f"{series.given.name}-seed{options.seed}-series"
    folder, header = begun_series(
        series.runs, stem, series.episodes, options.seed, series.video, series.writes
    )
    try:
        with alone_in(folder):
            begun = replace(series, called=header.called)
            yield from episodes_left(begun, SeriesResult((), None, folder), carry_out)
    finally:
        remove_if_empty(folder)


def episodes_left(series: Series, so_far: SeriesResult, carry_out: CarryOut) -> Iterator[SeriesResult]:
    """Carry out those that are left, as `carried_out` does."""
    where = series.runs if so_far.folder is None else so_far.folder
    while len(so_far.runs) < series.episodes:
        with new_run(_next(series, so_far.runs), where, series.video) as run:
            result = carry_out(run)
        so_far = ended(series, so_far, result)
        yield so_far


def _next(series: Series, done: Sequence[RunResult]) -> Inputs:
    """What goes into the next episode."""
    inputs = series.inputs
    options = replace(inputs.options, seed=inputs.options.seed + len(done))
    return replace(
        inputs,
        options=options,
        evidence=evidence_after(done),
        experience=experience_after(inputs, done),
    )


def evidence_after(done: Sequence[RunResult]) -> Evidence:
    """What the episodes have seen."""
    return done[-1].evidence if done else NO_EVIDENCE


def experience_after(inputs: Inputs, done: Sequence[RunResult]) -> tuple[Transition, ...]:
    """The transitions of the episodes, where whole rules are learned. Raises Refused, OSError."""
    if not inputs.options.structure:
        return ()
    files = (run.folder / EXPERIENCE for run in done)
    return tuple(each for file in files for each in read_experience(file, inputs.domain))


def ended(series: Series, before: SeriesResult, result: RunResult) -> SeriesResult:
    """The series with one more episode: what it teaches is written where it is to be, and the page as well.
    Raises Refused, OSError."""
    after = with_lesson(series, with_run(series, before, result))
    if series.writes and after.learned is not None:
        write(after, before.learned)
    number = len(after.runs)
    if after.folder is not None and (number % (number // PAGES + 1) == 0 or number == series.episodes):
        write_series_page(after.folder)
    return after


def write(done: SeriesResult, last: LearningResult | None) -> None:
    """Put what a series has learned into the domain's file, where it stands as it was written `last`. Raises
    Refused that says what becomes of the episodes, OSError."""
    assert done.learned is not None
    domain, records = done.learned.changes[0].path, done.folder or done.runs[-1].folder
    try:
        done.learned.write(last)
    except Refused as refused:
        help = (
            f"nothing was written; to count these episodes as well: cleancli learn {domain} {records} --add"
        )
        told = [replace(found, help=f"{help} --write") for found in refused.diagnostics]
        raise Refused(told, refused.sources) from None


def with_run(series: Series, before: SeriesResult, result: RunResult) -> SeriesResult:
    """The series with one more episode."""
    experience = (*before.experience, *_experience(series, result.folder))
    return SeriesResult((*before.runs, result), None, before.folder, experience)


def with_lesson(series: Series, done: SeriesResult) -> SeriesResult:
    """The series with what it teaches, beside what the domain's text has counted. Raises Refused."""
    method, domain = series.inputs.options.learning, series.given.domain
    if method is None or series.inputs.options.structure or not done.runs:
        return done
    noted = () if domain.model.learned is None else domain.model.learned.experience
    known = {each.sha256 for each in noted}
    rests_on = knowledge(method, (*noted, *(each for each in done.experience if each.sha256 not in known)))
    evidence = done.runs[-1].evidence
    lesson = lesson_of(domain.model, evidence, method)
    origins = [Origin(each.name, 1, each.transitions) for each in done.experience]
    changes = rule_changes(domain.model, lesson, evidence, origins)
    learned = taught(domain, lesson, rests_on, changes, (), series.is_writable, series.include_outside)
    return replace(done, learned=learned)


def _experience(series: Series, folder: Path) -> Iterator[Experience]:
    """That of a run, if it has any."""
    transitions, sha256 = whole(folder / EXPERIENCE)
    if transitions:
        called = Path(series.called) / folder.name if series.called else folder
        yield Experience(str(called), sha256, transitions)
