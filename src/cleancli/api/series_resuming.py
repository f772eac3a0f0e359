"""A series that was cut short goes on: the episode under way, and those that are left (docs/runs.md)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from cleancli.api.inputs import LoadedDomain, LoadedProblem
from cleancli.api.learned import LearningResult
from cleancli.api.provenance import inputs_of_run
from cleancli.api.resuming import Note
from cleancli.api.run_inputs import Inputs
from cleancli.api.run_result import ended_result
from cleancli.api.run_session import alone_in
from cleancli.api.runs import resumed_run
from cleancli.api.series import (
    CarryOut,
    Series,
    SeriesResult,
    ended,
    episodes_left,
    evidence_after,
    experience_after,
    with_lesson,
    with_run,
    write,
)
from cleancli.files.exchange import remove_leftovers
from cleancli.language.load import read_source
from cleancli.planning.plan import BadOption
from cleancli.recording.checkpoint import tidy
from cleancli.recording.folder import refused
from cleancli.recording.series import is_series, to_go_on_from
from cleancli.report.series import Series as Begun
from cleancli.report.series import read_series


def resumed(folder: Path, note: Note, carry_out: CarryOut) -> Iterator[SeriesResult]:
    """Go on with a run that was cut short, or with a series, also if one of its runs is named; gives what it
    has come to after each episode. Raises what `resumed_run` and `carried_out` do, and BadOption for a series
    that has ended."""
    folder = to_go_on_from(folder)
    if not is_series(folder):
        with resumed_run(folder, note) as opened:
            yield SeriesResult((carry_out(opened),), None)
        return
    with alone_in(folder):
        begun = read_series(folder)
        for each in (folder, *(run.folder for run in begun.runs)):
            tidy(each)
        series, so_far = _opened(begun)
        rest = begun.runs[len(so_far.runs) :]
        if not rest and len(so_far.runs) >= series.episodes:
            raise BadOption(f"{folder} has ended; start a new series instead")
        for run in rest:
            experience = experience_after(series.inputs, so_far.runs)
            with resumed_run(run.folder, note, evidence_after(so_far.runs), experience) as again:
                result = carry_out(again)
            so_far = ended(series, so_far, result)
            yield so_far
        yield from episodes_left(series, so_far, carry_out)


def _opened(begun: Begun) -> tuple[Series, SeriesResult]:
    """The series, and what its episodes have come to that have ended, with what they teach, which is written
    where it is to be. Raises Refused, BadOption, OSError."""
    _check_runs(begun)
    header, inputs = begun.header, inputs_of_run(begun.runs[0])
    is_writable = Path(inputs.sources[0].path).is_file()
    if header.writes and not is_writable:
        path = inputs.sources[0].path
        raise BadOption(f"the series writes into {path}, which is not here: go on where it was begun")
    series = Series(
        _given(inputs),
        inputs,
        header.episodes,
        begun.folder,
        header.video,
        is_writable,
        header.writes,
        include_outside=True,
        called=header.called,
    )
    before = so_far = SeriesResult((), None, begun.folder)
    for run in begun.runs:
        if run.header.episode is not None:
            before, so_far = so_far, with_run(series, so_far, ended_result(run, inputs))
    so_far = with_lesson(series, so_far)
    if series.writes and so_far.learned is not None:
        # A kill may have come after the last lesson was written, so that nothing is left to write.
        for change in so_far.learned.changes:
            remove_leftovers(Path(change.path).resolve().parent)
        write(so_far, _as_it_stands(so_far.learned, with_lesson(series, before).learned))
    return series, so_far


def _check_runs(begun: Begun) -> None:
    """Raises Refused (E705) for runs that are not the episodes of the series in turn."""
    first = begun.runs[0].header
    for number, run in enumerate(begun.runs):
        alike = run.header.files == first.files and run.header.options == first.options
        if number >= begun.header.episodes or run.header.seed != begun.header.seed + number or not alike:
            raise refused(run.folder, f"it is not episode {number + 1} of its series")
        if run.header.episode is None and run is not begun.runs[-1]:
            raise refused(run.folder, "it has not ended, and episodes after it have begun")


def _given(inputs: Inputs) -> LoadedProblem:
    """What the runs were given, from their copies."""
    domain = LoadedDomain(inputs.domain.name, inputs.domain, inputs.sources[:-1])
    return LoadedProblem(inputs.given.name, inputs.given, domain, inputs.sources[-1])


def _as_it_stands(learned: LearningResult, before: LearningResult | None) -> LearningResult:
    """What was written last: what was learned or, in files that a kill came before, what was learned before.
    Raises Refused, OSError."""
    was = [change.before for change in learned.changes]
    if before is not None:
        was = [change.after for change in before.changes]
    stands = tuple(
        change if read_source(Path(change.path)).text == change.after else replace(change, after=text)
        for change, text in zip(learned.changes, was, strict=True)
    )
    return replace(learned, changes=stands)
