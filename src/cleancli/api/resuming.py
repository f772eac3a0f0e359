"""What `cleancli execute --resume` goes on from: a run's folder holds all that it takes (docs/runs.md)."""

from __future__ import annotations

import errno
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from cleancli import __version__
from cleancli.api.run_session import LIBRARIES, Inputs, World, open_session, versions
from cleancli.execution.episode_state import EpisodeState
from cleancli.execution.session import Session
from cleancli.execution.setup import MOST, EpisodeOptions, Job
from cleancli.execution.strategies import STRATEGIES
from cleancli.files.untrusted import decoded
from cleancli.language.checking.learned import MOST_FORGETTING
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import kind_of, load_problem
from cleancli.language.model import Object, Problem
from cleancli.learning.estimate import ESTIMATORS
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.experience import Transition
from cleancli.learning.method import MATCHES, Method
from cleancli.learning.optimism import OPTIMISM
from cleancli.planning.plan import BadOption
from cleancli.planning.registry import PLANNERS
from cleancli.recording import checkpoint
from cleancli.recording.checkpoint import Saved
from cleancli.recording.fitting import check_fits
from cleancli.recording.folder import RUN, checkpoints, read_text, refuse_other_names
from cleancli.recording.journal import Count, Seconds, Started
from cleancli.report.run import LARGEST_HEADER, Header, InputFile, Run, read_run
from cleancli.report.texts import copy_of, domain_of, text_of
from cleancli.scene.check import load_scene


class _Options(msgspec.Struct):
    """What run.json tells of how a run began, as far as going on takes it."""

    strategy: str
    planner: str | None
    samples: Annotated[int, Meta(ge=1, le=MOST)]
    objective: Literal["reward", "time"]
    job: Job
    known: Count
    max_actions: Count
    max_seconds: Seconds
    estimator: str | None = None
    m: Annotated[float, Meta(ge=0, le=MOST)] = 0.0
    match: str = MATCHES[0]
    forgetting: Annotated[float, Meta(ge=0, le=MOST_FORGETTING)] = 0.0
    optimism: str = OPTIMISM[0]
    structure: bool = False
    taught: bool = False


class _Begun(msgspec.Struct):
    """The same, where it stands."""

    options: _Options


@dataclass(frozen=True, slots=True)
class Unfinished:
    """A run to go on with. `header` is its run.json; `video`: whether it was filmed; `begun`: how many
    actions were begun."""

    inputs: Inputs
    header: Mapping[str, Any]
    video: bool
    begun: int


Note = Callable[[str], None]
"""Told what a person may want to know and need not act upon."""


def _untold(_: str) -> None:
    """Tell nobody."""


def unfinished(
    folder: Path,
    evidence: Evidence = NO_EVIDENCE,
    experience: tuple[Transition, ...] = (),
    note: Note = _untold,
) -> Unfinished:
    """Read a run that has not ended; nothing is changed. Raises Refused, OSError, and BadOption for one that
    has ended."""
    run = read_run(folder)
    if run.header.episode is not None:
        raise BadOption(f"{folder} has ended: {run.header.episode.reason}; start a new run instead")
    refuse_other_names(folder)
    inputs = replace(inputs_of_run(run), evidence=evidence, experience=experience)
    raw = msgspec.json.decode(read_text(folder, RUN, LARGEST_HEADER).text, type=dict[str, Any])
    for difference in _other_versions(run.header):
        note(difference)
    return Unfinished(
        inputs,
        {name: value for name, value in raw.items() if name not in ("episode", "truth")},
        (folder / "video.mp4").exists(),
        sum(isinstance(record, Started) for record in run.records),
    )


def inputs_of_run(run: Run) -> Inputs:
    """What went into a run, read anew from its folder. Raises Refused, OSError, and BadOption where another
    version has begun it."""
    began = run.header.versions.get("cleancli")
    if began != __version__:
        raise BadOption(f"{run.folder} began with cleancli {began}, and this is {__version__}: use that one")
    source = read_text(run.folder, RUN, LARGEST_HEADER)
    options = _options(run.header, decoded(source, _Begun, "E705", "record of a run").options, source)
    return _inputs(run, options, Job(run.header.options["job"]))


def reopened(folder: Path, begun: Unfinished, note: Note = _untold) -> tuple[Saved | None, Session]:
    """The last checkpoint from which the run can go on, which is told if it is not the newest, and the place
    as it was then; the place as in the beginning, where the run came to no checkpoint.

    Raises Refused (E706) where none of them fits.
    """
    failed: list[Diagnostic] = []
    for path in reversed(checkpoints(folder)):
        try:
            saved = checkpoint.read(folder, path)
            try:
                check_fits(saved.episode, begun.inputs.domain, _objects(begun.inputs))
                session = open_session(begun.inputs, saved.world)
            except ValueError as error:
                raise checkpoint.refused(path, str(error)) from None
        except Refused as refusal:
            if any(found.code != "E706" for found in refusal.diagnostics):
                raise
            failed += refusal.diagnostics
            continue
        for found in failed:
            note(f"{found.message}; going on from the one before")
        return saved, session
    if failed:
        raise Refused(failed)
    if begun.begun:
        message = f"`{folder}` has no checkpoint, though it had begun {plural(begun.begun, 'action')}"
        raise Refused([Diagnostic("E706", message, None, help="start a new run")])
    return None, open_session(begun.inputs)


def last_checkpoint(folder: Path, inputs: Inputs) -> EpisodeState:
    """What was known at the end of a run that has ended. Raises Refused (E706) where that is not there, or
    does not fit the run."""
    paths = checkpoints(folder)
    if not paths:
        message = f"`{folder}` has no checkpoint of its end"
        raise Refused([Diagnostic("E706", message, None, help="start a new series")])
    saved = checkpoint.read(folder, paths[-1]).episode
    try:
        check_fits(saved, inputs.domain, _objects(inputs))
    except ValueError as error:
        raise checkpoint.refused(paths[-1], str(error)) from None
    return saved


def _objects(inputs: Inputs) -> tuple[Object, ...] | None:
    """Those of a problem; a table has none of its own."""
    return inputs.given.objects if isinstance(inputs.given, Problem) else None


def _inputs(run: Run, options: EpisodeOptions, job: Job) -> Inputs:
    """The texts that went in, read anew from their copies. Raises Refused, OSError."""
    sources = tuple(text_of(run, file) for file in run.header.files)
    if not sources:
        help = "only runs of this version and later ones can be gone on with"
        raise Refused(
            [Diagnostic("E705", f"`{run.folder}` does not hold the files that went in", None, help=help)]
        )
    domain, last = domain_of(sources), sources[-1]
    if kind_of(last) == "scene":
        return Inputs(domain, load_scene(last, lambda _: _calibration(run)), sources, options, job)
    problem = load_problem(last, domain)
    world, teacher = _rules(run, run.header.world), _rules(run, run.header.teacher)
    return Inputs(domain, problem, sources, options, job, world=world, teacher=teacher)


def _rules(run: Run, files: Sequence[InputFile]) -> World | None:
    """Those that these copies hold, if there are any."""
    texts = tuple(text_of(run, file) for file in files)
    return World(domain_of(texts), texts) if texts else None


def _calibration(run: Run) -> bytes:
    """The calibration that went in; OSError where none did."""
    if run.header.calibration is None:
        raise OSError(errno.ENOENT, "the run holds no copy of it", str(run.folder))
    return copy_of(run, run.header.calibration)


def _options(header: Header, given: _Options, source: Source) -> EpisodeOptions:
    """Raises Refused (E705) for a strategy, a planner or a way of learning that there is not."""
    for name, chosen, known in (
        ("strategy", given.strategy, STRATEGIES),
        ("planner", given.planner, PLANNERS),
        ("estimator", given.estimator, ESTIMATORS),
        ("match", given.match, MATCHES),
        ("optimism", given.optimism, OPTIMISM),
    ):
        if chosen is not None and chosen not in known:
            message = f"`{source.path}` tells of a {name} that there is not: {chosen!r}"
            raise Refused([Diagnostic("E705", message, None, help=f"known are {', '.join(known)}")])
    return EpisodeOptions(
        given.strategy,
        given.planner,
        given.samples,
        given.max_actions,
        given.max_seconds,
        header.seed,
        given.objective == "time",
        given.known,
        None if given.estimator is None else _method(given.estimator, given),
        given.optimism,
        given.structure,
        given.taught,
    )


def _method(estimator: str, given: _Options) -> Method:
    return Method(estimator, given.m, given.match, given.forgetting)


def _other_versions(header: Header) -> Iterator[str]:
    """Says which libraries differ from those the run began with: it may go on differently then."""
    found = versions()
    for name in LIBRARIES:
        old, now = header.versions.get(name), found.get(name)
        if old != now:
            here = f"this is {now}" if now else "which is not installed here"
            began = f"with {name} {old}" if old else f"without {name}"
            yield f"the run began {began}, {here}"
