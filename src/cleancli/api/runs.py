"""A run from its beginning, or from where it was cut short, to its end, with all that its folder keeps."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cleancli.api.provenance import copied_into, header_of
from cleancli.api.resuming import Note, reopened, unfinished
from cleancli.api.run_inputs import Inputs
from cleancli.api.run_result import RunResult, hopeless, is_dead_end, short_horizon, told_in_the_end
from cleancli.api.run_session import alone_in, interruptions, none_left_where_refused, open_session
from cleancli.execution.episode_state import EpisodeState, Situation
from cleancli.execution.events import Checkpoint, Ended, Event, Looked
from cleancli.execution.loop import clean
from cleancli.execution.session import Session
from cleancli.execution.setup import EpisodeSetup
from cleancli.execution.teaching import Teacher, of_rules
from cleancli.language.load import located_in
from cleancli.language.model import Problem
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.experience import Transition, read_experience
from cleancli.planning.plan import BadOption
from cleancli.planning.refusal import planning_refused
from cleancli.recording.begun import begun_folder, named
from cleancli.recording.checkpoint import cut_back, tidy
from cleancli.recording.folder import EXPERIENCE, RUN
from cleancli.recording.journal import Interrupted, Resumed
from cleancli.recording.journal_writer import Entries
from cleancli.recording.run_folder import Recorder, write_run
from cleancli.recording.series import to_go_on_from
from cleancli.world.errors import RobotError


class RunStopped(KeyboardInterrupt):
    """Ctrl-C has ended a run in good order; the message says how to go on with what is in the `folder`."""

    def __init__(self, message: str, folder: Path) -> None:
        super().__init__(message)
        self.folder = folder

    def __reduce__(self) -> tuple[type[RunStopped], tuple[str, Path]]:
        """Exceptions are pickled by their message alone."""
        return RunStopped, (str(self), self.folder)


@dataclass(frozen=True, slots=True)
class OpenedRun:
    """A run that is about to begin, or to go on: then it was `resumed` from the state `saved` last, or from
    its beginning. `header` is its run.json as far as it is known."""

    inputs: Inputs
    session: Session
    folder: Path
    header: Mapping[str, object]
    video: bool
    resumed: Resumed | None = None
    saved: EpisodeState | None = None


@contextmanager
def new_run(inputs: Inputs, runs: Path, video: bool) -> Iterator[OpenedRun]:
    """A run that begins, in a new folder in `runs`; a folder that would tell nothing is removed. Raises
    Refused, BadOption, OSError."""
    options = inputs.options
    with closing(open_session(inputs)) as session, begun_folder(runs) as begun:
        header = header_of(options, session.setup.job, copied_into(inputs, begun))
        write_run(begun, header)
        folder = named(begun, f"{inputs.given.name}-seed{options.seed}")
        with none_left_where_refused(folder):
            yield OpenedRun(inputs, session, folder, header, video)


def _with_own_experience(setup: EpisodeSetup, folder: Path) -> EpisodeSetup:
    """What an episode that goes on needs, with what it has seen itself so far. Raises Refused, OSError."""
    own = read_experience(folder / EXPERIENCE, setup.domain)
    return replace(setup, experience=(*setup.experience, *own))


@contextmanager
def resumed_run(
    folder: Path,
    note: Note,
    evidence: Evidence = NO_EVIDENCE,
    experience: tuple[Transition, ...] = (),
) -> Iterator[OpenedRun]:
    """A run that was cut short, from its last checkpoint on; `evidence` and `experience` are what runs before
    it have seen.
    Raises Refused, BadOption, OSError."""
    with alone_in(folder):
        tidy(folder)
        begun = unfinished(folder, evidence, experience, note)
        saved, session = reopened(folder, begun, note)
        with closing(session):
            dropped = cut_back(folder, saved)
            if begun.inputs.options.structure:
                session = replace(session, setup=_with_own_experience(session.setup, folder))
            episode = None if saved is None else saved.episode
            resumed = Resumed(0 if episode is None else episode.actions, dropped)
            yield OpenedRun(begun.inputs, session, folder, begun.header, begun.video, resumed, episode)


def carry_out(run: OpenedRun, follow: Callable[[Event], object], person: Teacher | None = None) -> RunResult:
    """The loop to its end, recorded and followed; a `person` is asked where no file teaches.

    Raises RunStopped on Ctrl-C, TERM and HUP, Refused for what cannot be planned, and OSError with a note
    where the record cannot be written; in each case the run can go on from its folder.
    """
    inputs, cell, event, situation = run.inputs, run.session.cell, None, None
    teacher, evidence = _teacher(inputs, person), inputs.evidence
    entries = Entries(inputs.domain, lambda: cell.clock, None if run.saved is None else run.saved.spent)
    with (
        located_in(*inputs.sources),
        planning_refused(inputs.sources),
        Recorder(
            run.folder, run.header, run.session.picture, run.video, entries, run.session.save, run.resumed
        ) as recorder,
        _stopping(run, recorder),
        interruptions() as pressed,
    ):
        for event in clean(run.session.setup, cell, run.saved, teacher):
            recorder.write(event)
            follow(event)
            if isinstance(event, Looked):
                situation = event.situation
            elif isinstance(event, Checkpoint):
                evidence = event.state.evidence
            if pressed:
                raise KeyboardInterrupt
    assert isinstance(event, Ended), "an episode's last event closes it"
    truth = run.session.truth()
    recorder.finish(truth)
    return _result(run, event, truth, situation, evidence)


@contextmanager
def _stopping(run: OpenedRun, recorder: Recorder) -> Iterator[None]:
    """Stop the robot, whatever ends its run too soon, and say how to go on."""
    again = to_go_on_from(run.folder)
    try:
        yield
    except KeyboardInterrupt:
        _stop(run.session)
        recorder.note(Interrupted(run.session.cell.clock))
        how = "stopped" if isinstance(run.inputs.given, Problem) else "stopped with the tool up"
        on = f"go on with: cleancli execute --resume {again}"
        if run.inputs.robot is not None:
            on = "a run with a robot of your own is begun anew"
        raise RunStopped(f"{how}; {on}", again) from None
    except OSError as error:
        _stop(run.session)
        error.add_note(f"go on later with `cleancli execute --resume {again}`")
        raise
    except BaseException:  # a mistake of this program, or of a driver: the robot must not go on with it
        _stop(run.session)
        raise


def _stop(session: Session) -> None:
    """End a motion with the tool raised. A driver that cannot be reached stops its robot by itself."""
    with suppress(RobotError):
        session.stop()


def _teacher(inputs: Inputs, person: Teacher | None) -> Teacher | None:
    """Raises BadOption where a person is to be asked, and nobody can."""
    if not inputs.options.is_taught:
        return None
    if inputs.teacher is not None:
        return of_rules(inputs.teacher.model, inputs.options.samples)
    if person is None:
        raise BadOption("a person is asked by `cleancli execute` alone: name a file of rules as the teacher")
    return person


def _result(
    run: OpenedRun,
    ended: Ended,
    truth: Mapping[str, object],
    situation: Situation | None,
    evidence: Evidence,
) -> RunResult:
    record: dict[str, Any] = json.loads((run.folder / RUN).read_text(encoding="utf-8"))
    return RunResult(
        run.folder,
        ended.clean,
        ended.reason,
        ended.actions,
        ended.spent.by_kind(),
        dict(truth),
        told_in_the_end(run.inputs, situation),
        run.video and run.session.picture is not None,
        record,
        evidence,
        short_horizon(run.inputs, ended.clean, ended.reason),
        hopeless(run.inputs, ended.clean),
        is_dead_end(run.inputs, ended.clean, situation),
    )
