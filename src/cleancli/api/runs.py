"""A run from its beginning, or from where it was cut short, to its end, with all that its folder keeps."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cleancli.api.horizons import first_and_longer, is_hopeless
from cleancli.api.inputs import LoadedDomain, LoadedProblem, refuse_learning_pddl
from cleancli.api.plain import plain
from cleancli.api.plans import HOPELESS, too_few
from cleancli.api.resuming import Note, last_checkpoint, reopened, unfinished
from cleancli.api.run_session import (
    Inputs,
    World,
    alone_in,
    interruptions,
    none_left_where_refused,
    open_session,
    versions,
)
from cleancli.api.symbolic import told_of
from cleancli.api.tables import TextTable, shown
from cleancli.compiler.task import NoDurationError, Objective
from cleancli.execution.episode_state import EpisodeState
from cleancli.execution.events import Checkpoint, Ended, Event, Looked
from cleancli.execution.loop import IDLE, clean
from cleancli.execution.session import Session
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, Job, discounts_time
from cleancli.execution.strategies import STRATEGIES
from cleancli.execution.teaching import Teacher, of_rules
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.diagnostics.plural import plural
from cleancli.language.load import located_in
from cleancli.language.model import Domain, Problem, Unlimited
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.experience import Transition, read_experience
from cleancli.learning.method import KNOWN
from cleancli.planning.plan import BadOption, Options
from cleancli.planning.refusal import planning_refused
from cleancli.recording.begun import begun_folder, named
from cleancli.recording.checkpoint import cut_back, tidy
from cleancli.recording.folder import EXPERIENCE, FILES, PAGE, RUN, read_text
from cleancli.recording.journal import Interrupted, Resumed
from cleancli.recording.journal_writer import Entries
from cleancli.recording.run_folder import Recorder, write_run
from cleancli.recording.series import to_go_on_from
from cleancli.report.run import FORMAT, LARGEST_HEADER, Run
from cleancli.scene.calibration import as_text
from cleancli.scene.model import Scene
from cleancli.world.errors import RobotError
from cleancli.world.robot import Robot

_SHORT = 0.05
"""Seconds that are shown as 0.0."""


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


@dataclass(frozen=True, slots=True)
class RunResult:
    """What a run came to, as docs/python.md lists it. `told`: what holds in the end in the symbolic world.
    `evidence`: what it and the runs before it have seen, to learn from. `short_horizon`: that of the first
    plan and a longer one to try, where the problem states none and no plan was believed to reach its goal.
    `hopeless`: no action of the symbolic world can lead to the goal."""

    folder: Path
    clean: bool
    reason: str
    actions: int
    seconds: Mapping[str, float]
    truth: Mapping[str, object]
    told: str
    video: bool
    record: Mapping[str, object]
    evidence: Evidence = field(default=NO_EVIDENCE, repr=False)
    short_horizon: tuple[int, int] | None = None
    hopeless: bool = False

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli execute --json` prints: the folder's run.json."""
        return {name: plain(value) for name, value in self.record.items()}

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _repr_html_(self) -> str:
        rows = tuple((kind.replace("_", " "), f"{spent:.1f}") for kind, spent in self.seconds.items())
        told = "".join(f"<p>{shown(line)}</p>" for line in self._lines())
        return f"<div>{told}{TextTable(('seconds of', 's'), rows).html()}</div>"

    def _lines(self) -> Iterator[str]:
        """The symbolic world is not called clean, and has no looks that would take time."""
        kinds = {kind: s for kind, s in self.seconds.items() if s >= _SHORT or not self.told}
        done = "done" if self.told else "clean"
        yield (f"{'' if self.clean else 'not '}{done}: {self.reason}, after {plural(self.actions, 'action')}")
        if self.told:
            yield f"in the end: {self.told}"
        if self.hopeless:
            yield HOPELESS
        elif self.short_horizon is not None:
            yield too_few(*self.short_horizon)
        if kinds:
            spent = ", ".join(f"{kind.replace('_', ' ')} {s:.1f}" for kind, s in kinds.items())
            yield f"seconds: {sum(self.seconds.values()):.1f} ({spent})"
        if "particles" in self.truth:
            yield from _left(self.truth)
        yield f"record: {self.folder}/  page: {PAGE}" + ("  video: video.mp4" if self.video else "")


def ended_result(run: Run, inputs: Inputs) -> RunResult:
    """What a run that has ended came to, from its folder. Raises Refused, OSError, and BadOption for one that
    has not ended."""
    folder, ended, given = run.folder, run.header.episode, inputs.given
    if ended is None:
        raise BadOption(f"{folder} has not ended")
    saved = last_checkpoint(folder, inputs)
    record: dict[str, Any] = json.loads(read_text(folder, RUN, LARGEST_HEADER).text)
    told, situation = "", saved.situation
    if isinstance(given, Problem) and situation is not None:
        told = told_of(inputs.domain, given)(situation)
    seconds = {kind: spent for kind, spent in ended.seconds.items() if kind != "total"}
    truth = record.get("truth") or {}
    filmed = bool(run.videos)
    return RunResult(
        folder,
        ended.clean,
        ended.reason,
        ended.actions,
        seconds,
        truth,
        told,
        filmed,
        record,
        saved.evidence,
        _short_horizon(inputs, ended.clean, ended.reason),
        _is_hopeless(inputs, ended.clean),
    )


def _is_hopeless(inputs: Inputs, done: bool) -> bool:
    given = inputs.given
    if done or not isinstance(given, Problem) or not given.goal:
        return False
    world = inputs.domain if inputs.world is None else inputs.world.domain
    return is_hopeless(world, given)


def _short_horizon(inputs: Inputs, done: bool, reason: str) -> tuple[int, int] | None:
    given = inputs.given
    if done or not isinstance(given, Problem) or given.horizon is not None or not given.goal:
        return None
    if not reason.startswith(IDLE):
        return None
    return first_and_longer(inputs.domain, given, Options().counted)


@contextmanager
def new_run(inputs: Inputs, runs: Path, video: bool) -> Iterator[OpenedRun]:
    """A run that begins, in a new folder in `runs`; a folder that would tell nothing is removed. Raises
    Refused, BadOption, OSError."""
    options = inputs.options
    with closing(open_session(inputs)) as session, begun_folder(runs) as begun:
        header = _header(options, session.setup.job, _copied(inputs, begun))
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
    inputs, cell, folder, again = run.inputs, run.session.cell, run.folder, to_go_on_from(run.folder)
    told = told_of(inputs.domain, inputs.given) if isinstance(inputs.given, Problem) else None
    last, event, evidence = "", None, inputs.evidence
    teacher = _teacher(inputs, person)
    entries = Entries(inputs.domain, lambda: cell.clock, None if run.saved is None else run.saved.spent)
    with (
        located_in(*inputs.sources),
        planning_refused(inputs.sources),
        Recorder(
            folder, run.header, run.session.picture, run.video, entries, run.session.save, run.resumed
        ) as recorder,
    ):
        try:
            with interruptions() as pressed:
                for event in clean(run.session.setup, cell, run.saved, teacher):
                    recorder.write(event)
                    follow(event)
                    if told is not None and isinstance(event, Looked):
                        last = told(event.situation)
                    if isinstance(event, Checkpoint):
                        evidence = event.state.evidence
                    if pressed:
                        raise KeyboardInterrupt
        except KeyboardInterrupt:
            _stop(run.session)
            recorder.note(Interrupted(cell.clock))
            how = "stopped with the tool up" if told is None else "stopped"
            on = f"go on with: cleancli execute --resume {again}"
            if inputs.robot is not None:
                on = "a run with a robot of your own is begun anew"
            raise RunStopped(f"{how}; {on}", again) from None
        except OSError as error:
            _stop(run.session)
            error.add_note(f"go on later with `cleancli execute --resume {again}`")
            raise
        except BaseException:  # a mistake of this program, or of a driver: the robot must not go on with it
            _stop(run.session)
            raise
    assert isinstance(event, Ended), "an episode's last event closes it"
    truth = run.session.truth()
    recorder.finish(truth)
    return replace(_result(run, event, truth, last), evidence=evidence)


def _stop(session: Session) -> None:
    """End a motion with the tool raised. A driver that cannot be reached stops its robot by itself."""
    with suppress(RobotError):
        session.stop()


def _teacher(inputs: Inputs, person: Teacher | None) -> Teacher | None:
    """Raises BadOption where a person is to be asked, and nobody can."""
    if not inputs.options.is_taught:
        return None
    if inputs.teacher is not None:
        return of_rules(inputs.teacher.domain, inputs.options.samples)
    if person is None:
        raise BadOption("a person is asked by `cleancli execute` alone: name a file of rules as the teacher")
    return person


def inputs_of(
    given: LoadedProblem,
    asked: EpisodeOptions,
    *,
    seed: int | None,
    objective: str | None,
    job: str | None,
    known: int | None = None,
    world: LoadedDomain | None = None,
    robot: Robot | None = None,
    teacher: LoadedDomain | None = None,
) -> Inputs:
    """What goes into a run: where it is not asked for, the problem's seed, time as the objective if the
    domain says how long each action takes, and as many examples as make a rule known where one learns (§6.3).

    Raises Refused (E902) where time is asked for and one is not known, BadOption where what is hoped of
    unknown rules makes no difference."""
    if asked.learning is not None:
        refuse_learning_pddl(given.domain)
    if STRATEGIES[asked.strategy].learns_rules and asked.learning is not None:
        asked = replace(asked, structure=True)
    if teacher is not None:
        asked = replace(asked, is_taught=True)
    _check_structure(asked)
    _check_optimism(asked)
    _check_horizon(given.model, asked.optimism, objective)
    with planning_refused(given.sources):
        by_time = _by_time(objective, given.domain.model)
    chosen = next(n for n in (seed, given.model.seed, asked.seed) if n is not None)
    usual = asked.known if asked.learning is None else KNOWN
    return Inputs(
        given.domain.model,
        given.model,
        given.sources,
        replace(asked, seed=chosen, by_time=by_time, known=usual if known is None else known),
        None if job is None else Job(job),
        world=None if world is None else World(world.model, world.sources),
        robot=robot,
        teacher=None if teacher is None else World(teacher.model, teacher.sources),
    )


def _check_structure(asked: EpisodeOptions) -> None:
    if STRATEGIES[asked.strategy].learns_rules and asked.learning is None:
        raise BadOption(f"the strategy {asked.strategy} learns rules while it works: ask for learning")
    if asked.structure and asked.learning is None:
        raise BadOption("structure is what of the rules is learned: ask for learning as well")
    if asked.is_taught and not STRATEGIES[asked.strategy].learns_rules:
        raise BadOption(f"a teacher is for the strategy explore, and {asked.strategy} asks nobody")
    if asked.structure and asked.optimism != "prior":
        raise BadOption(
            f"optimism {asked.optimism} is about the probabilities of rules; where whole rules are learned,"
            " the strategy explore hopes"
        )


def _check_optimism(asked: EpisodeOptions) -> None:
    if asked.optimism == "prior":
        return
    if asked.learning is None:
        raise BadOption(f"optimism {asked.optimism} is about rules that are being learned: ask for learning")
    if STRATEGIES[asked.strategy].planner is None:
        raise BadOption(f"optimism {asked.optimism} is for plans, and the strategy {asked.strategy} has none")


def _check_horizon(given: Problem | Scene, optimism: str, objective: str | None) -> None:
    if isinstance(given, Problem) and isinstance(given.horizon, Unlimited):
        if optimism != "prior":
            raise BadOption(f"optimism {optimism} hopes for reward, and without a horizon none counts")
        if objective == Objective.REWARD.value:
            raise BadOption("without a horizon no reward counts: the objective is time, or left out")


def _result(run: OpenedRun, ended: Ended, truth: Mapping[str, object], told: str) -> RunResult:
    record: dict[str, Any] = json.loads((run.folder / RUN).read_text(encoding="utf-8"))
    filmed = run.video and run.session.picture is not None
    return RunResult(
        run.folder,
        ended.clean,
        ended.reason,
        ended.actions,
        ended.spent.by_kind(),
        dict(truth),
        told,
        filmed,
        record,
        short_horizon=_short_horizon(run.inputs, ended.clean, ended.reason),
        hopeless=_is_hopeless(run.inputs, ended.clean),
    )


def _by_time(objective: str | None, domain: Domain) -> bool:
    """Whether plans discount by time. Raises NoDurationError where they are to and one is not known."""
    unknown = [action.name for action in domain.actions if action.duration is None]
    if objective == "time" and unknown:
        raise NoDurationError(unknown)
    return objective == "time" or (objective is None and discounts_time(domain))


def _copied(inputs: Inputs, folder: Path) -> dict[str, object]:
    """Copy what went in into the folder, and say which is which."""
    (folder / FILES).mkdir()
    of_world = () if inputs.world is None else inputs.world.sources
    of_teacher = () if inputs.teacher is None else inputs.teacher.sources
    texts = [(source.path, source.text) for source in (*inputs.sources, *of_world, *of_teacher)]
    copies = [_copy(*each, number, folder) for number, each in enumerate(texts)]
    entries, others = copies[: len(inputs.sources)], copies[len(inputs.sources) :]
    world, teacher = others[: len(of_world)], others[len(of_world) :]
    given = inputs.given
    if isinstance(given, Problem) or given.calibration is None:
        return {
            "files": entries,
            **({"world": world} if world else {}),
            **({"teacher": teacher} if teacher else {}),
        }
    path = Path(inputs.sources[-1].path).parent / given.calibration.path
    return {
        "files": entries,
        "calibration": _copy(str(path), as_text(given.calibration), len(entries), folder),
    }


def _copy(path: str, text: str, number: int, folder: Path) -> dict[str, str]:
    """Names of files may be the same in different folders, or those of files that no system likes."""
    name = re.sub(r"[^\w.-]", "_", Path(path).name) or "_"
    name = f"{number}-{name}" if (folder / FILES / name).exists() else name
    (folder / FILES / name).write_bytes(text.encode())
    return {
        "path": printable(path),
        "sha256": hashlib.sha256(text.encode()).hexdigest(),
        "copy": f"{FILES}/{name}",
    }


def _header(options: EpisodeOptions, job: Job, copied: Mapping[str, object]) -> dict[str, object]:
    """What another person needs to run the same again; the estimator is null where nothing is learned."""
    learning = options.learning
    return {
        "format": FORMAT,
        "versions": versions(),
        "seed": options.seed,
        "options": {
            "strategy": options.strategy,
            "planner": options.planner or STRATEGIES[options.strategy].planner,
            "samples": options.samples,
            "objective": "time" if options.by_time else "reward",
            "job": job.value,
            "known": options.known,
            "optimism": options.optimism,
            "structure": options.structure,
            "taught": options.is_taught,
            "estimator": learning.estimator if learning else None,
            "m": learning.m if learning else 0,
            "match": learning.match if learning else "shared",
            "forgetting": learning.forgetting if learning else 0,
            "max_actions": options.max_actions,
            "max_seconds": options.max_seconds,
        },
        **copied,
    }


def _left(truth: Mapping[str, object]) -> Iterator[str]:
    """Where the dirt truly is: particles, ink, or both."""
    if truth["ink_left"] is not None:
        yield f"truly: {truth['ink_left']:.1%} of the ink left"
    if not truth["particles"] and truth["ink_left"] is not None:
        return
    total, zone = truth["particles"], truth.get("in_zone")
    arrived = (
        f"{truth['in_container']} of {total} particles in the container"
        if zone is None
        else f"{zone} of {total} particles in the zone, {truth['in_container']} in the container"
    )
    yield (
        f"truly: {arrived}, {truth['on_table']} {'' if zone is None else 'elsewhere '}on the table,"
        f" {truth['on_floor']} on the floor"
        + (f", {truth['in_dustpan']} in the dustpan" if truth["in_dustpan"] else "")
    )
    if truth["on_table"]:
        yield f"left on the table at (m): {truth['left_on_table_at']}"
