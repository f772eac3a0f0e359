"""`cleancli execute`: clean a simulated table, watch it happen, and keep a record."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from math import isnan
from pathlib import Path

import click
from click.core import ParameterSource

from cleancli.cli.commands.report import write_page
from cleancli.cli.completion import domains, problems
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode, Stopped
from cleancli.cli.inputs import open_domain, open_problem
from cleancli.cli.progress import working
from cleancli.cli.resume import reopened, unfinished
from cleancli.cli.run_session import (
    Inputs,
    alone_in,
    interruptions,
    none_left_where_refused,
    open_session,
    versions,
)
from cleancli.cli.symbolic import told_of
from cleancli.cli.views.live import show
from cleancli.compiler.task import NoDurationError
from cleancli.execution.episode_state import EpisodeState
from cleancli.execution.events import Ended, Looked
from cleancli.execution.loop import clean
from cleancli.execution.session import Session
from cleancli.execution.setup import MOST, EpisodeOptions, Job
from cleancli.execution.strategies import DEFAULT_STRATEGY, STRATEGIES
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.diagnostics.plural import plural
from cleancli.language.find import find
from cleancli.language.load import located_in, read_source
from cleancli.language.model import Domain, Problem
from cleancli.planning.refusal import planning_refused
from cleancli.planning.registry import PLANNERS
from cleancli.recording.begun import begun_folder, named
from cleancli.recording.checkpoint import cut_back
from cleancli.recording.folder import FILES
from cleancli.recording.journal import Interrupted, Resumed
from cleancli.recording.journal_writer import Entries
from cleancli.recording.run_folder import Recorder, write_run
from cleancli.report.run import FORMAT
from cleancli.scene.calibration import as_text


def _number(context: click.Context, parameter: click.Parameter, value: float) -> float:
    """A limit that something can be compared with."""
    if isnan(value):
        raise click.BadParameter("this is no number", context, parameter)
    return value


@click.command("execute", short_help="Clean a simulated table: look, plan, act, until it is clean.")
@click.argument("domain", required=False, shell_complete=domains)
@click.argument("problem", required=False, shell_complete=problems)
@click.option(
    "--resume",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    metavar="RUN",
    help="Go on with the run in this folder, as it began; takes no other arguments.",
)
@click.option("--seed", type=click.IntRange(min=0), help="Seed of all randomness. [default: PROBLEM's, or 1]")
@click.option(
    "--strategy",
    type=click.Choice(list(STRATEGIES)),
    default=DEFAULT_STRATEGY,
    show_default=True,
    help="Who decides what to do; plan-N plans, and carries out N actions before planning again (§4.2.4).",
)
@click.option(
    "--planner", type=click.Choice(list(PLANNERS)), help="[default: all-outcomes for determinized, or prada+]"
)
@click.option(
    "--samples",
    type=click.IntRange(min=1, max=MOST),
    default=10_000,
    show_default=True,
    help="Action sequences to draw for each plan.",
)
@click.option(
    "--objective",
    type=click.Choice(["reward", "time"]),
    help="What discounts later rewards: the number of actions before, or their duration."
    "  [default: time, if the domain says how long each action takes]",
)
@click.option(
    "--job",
    type=click.Choice([job.value for job in Job]),
    help="How dirt leaves the table: pushed into the container, or picked up with a dustpan."
    "  [default: dustpan, if the robot has one]",
)
@click.option(
    "--known",
    type=click.IntRange(min=0, max=MOST),
    default=0,
    show_default=True,
    metavar="T",
    help="Move the arm out of view after an action whose rule was seen less than T times (§5.2).",
)
@click.option(
    "--max-actions",
    type=click.IntRange(min=0, max=MOST),
    default=60,
    show_default=True,
    help="Stop after so many actions.",
)
@click.option(
    "--max-seconds",
    type=click.FloatRange(min=0, max=MOST),
    callback=_number,
    default=1800,
    show_default=True,
    help="Stop after so many seconds, of robot and of planning.",
)
@click.option(
    "--runs",
    type=click.Path(path_type=Path),
    default=Path("runs"),
    show_default=True,
    help="Folder to make the run's folder in.",
)
@click.option("--video/--no-video", default=True, show_default=True, help="Record a video of the run.")
@click.option("--json", "as_data", is_flag=True, help="Print the summary as JSON, and nothing else.")
@click.option("--quiet", is_flag=True, help="Print nothing but errors; the run's folder tells all.")
def command(
    domain: str | None,
    problem: str | None,
    resume: Path | None,
    seed: int | None,
    strategy: str,
    planner: str | None,
    samples: int,
    objective: str | None,
    job: str | None,
    known: int,
    max_actions: int,
    max_seconds: float,
    runs: Path,
    video: bool,
    as_data: bool,
    quiet: bool,
) -> int:
    """Carry PROBLEM out with the rules of DOMAIN: look, decide, act, until nothing is left to do.

    A scene is carried out on a simulated table, by a simulated robot; any other problem in the symbolic
    world. Leaves a folder with run.json, experience.jsonl, and of a table a picture per action and a video.
    Exit code 3 if something is left at the end; the summary says where every lentil truly is, apart from what
    perception believed.
    """
    said = _Said(as_data, quiet)
    if resume is not None:
        _refuse_beside_resume()
        with alone_in(resume):
            return _go_on(resume, said)
    if domain is None or problem is None:
        raise click.UsageError("name a domain and a problem, or a run by --resume")
    _, domain_sources, model = open_domain(domain)
    given = open_problem(problem, model)
    sources = (*domain_sources, read_source(find(problem, "problems")))
    with planning_refused(sources):
        is_by_time = _by_time(objective, model)
    options = EpisodeOptions(
        strategy,
        planner,
        samples,
        max_actions,
        max_seconds,
        next(n for n in (seed, given.seed, 1) if n is not None),
        is_by_time,
        known,
    )
    inputs = Inputs(model, given, sources, options, None if job is None else Job(job))
    with closing(open_session(inputs)) as session, begun_folder(runs) as begun:
        header = _header(options, session.setup.job, _copied(inputs, begun))
        write_run(begun, header)
        folder = named(begun, f"{given.name}-seed{options.seed}")
        with none_left_where_refused(folder):
            return _carry_out(inputs, session, folder, header, video, said)


_SHORT = 0.05
"""Seconds that are shown as 0.0."""


@dataclass(frozen=True, slots=True)
class _Said:
    """How the run is told: as data, or not at all."""

    as_data: bool
    quiet: bool

    @property
    def silently(self) -> bool:
        """Whether nothing is shown while it lasts."""
        return self.as_data or self.quiet


def _refuse_beside_resume() -> None:
    """Raises UsageError for what a resumed run has from its beginning."""
    context = click.get_current_context()
    for name in context.params:
        source = context.get_parameter_source(name)
        given = source not in (ParameterSource.DEFAULT, None) and name not in ("resume", "as_data", "quiet")
        if given:
            what = name.upper() if name in ("domain", "problem") else f"--{name.replace('_', '-')}"
            raise click.UsageError(f"--resume goes on as the run began, and takes no {what}")


def _go_on(folder: Path, said: _Said) -> int:
    """Go on with a run that was cut short, from its last checkpoint."""
    begun = unfinished(folder)
    saved, session = reopened(folder, begun)
    with closing(session):
        dropped = cut_back(folder, saved)
        after = 0 if saved is None else saved.episode.actions
        resumed = Resumed(after, dropped)
        if not said.silently:
            echo(f"going on after {plural(after, 'action')}", err=True)
        episode = None if saved is None else saved.episode
        return _carry_out(begun.inputs, session, folder, begun.header, begun.video, said, resumed, episode)


def _carry_out(
    inputs: Inputs,
    session: Session,
    folder: Path,
    header: Mapping[str, object],
    video: bool,
    said: _Said,
    resumed: Resumed | None = None,
    saved: EpisodeState | None = None,
) -> int:
    """The loop to its end, recorded and shown; from a checkpoint on, if there is one."""
    setup, cell = session.setup, session.cell
    told = told_of(inputs.domain, inputs.given) if isinstance(inputs.given, Problem) else None
    last = ""
    entries = Entries(inputs.domain, lambda: cell.clock, None if saved is None else saved.spent)
    with (
        located_in(*inputs.sources),
        planning_refused(inputs.sources),
        Recorder(folder, header, session.picture, video, entries, session.save, resumed) as recorder,
        show(said.silently, setup.scene, lambda: cell.tool, setup.options.max_actions, told=told) as view,
    ):
        try:
            with interruptions() as pressed:
                for event in clean(setup, cell, saved):
                    recorder.write(event)
                    view.write(event)
                    if told is not None and isinstance(event, Looked):
                        last = told(event.situation)
                    if pressed:
                        raise KeyboardInterrupt
        except KeyboardInterrupt:
            session.stop()
            recorder.note(Interrupted(cell.clock))
            how = "stopped with the tool up" if told is None else "stopped"
            raise Stopped(f"{how}; go on with: cleancli execute --resume {folder}") from None
        except OSError:
            session.stop()
            echo(f"go on later with `cleancli execute --resume {folder}`", err=True)
            raise
    assert isinstance(event, Ended), "an episode's last event closes it"
    truth = session.truth()
    recorder.finish(truth)
    with working("writing report.html", said.silently):
        write_page(folder)
    if said.as_data:
        echo((folder / "run.json").read_text(encoding="utf-8"), nl=False)
    elif not said.quiet:
        echo(_summary(event, truth, folder, video and session.picture is not None, last))
    return ExitCode.DONE if event.clean else ExitCode.NOT_CLEAN


def _by_time(objective: str | None, domain: Domain) -> bool:
    """Whether plans discount by time. Raises NoDurationError where they are to and one is not known."""
    unknown = [action.name for action in domain.actions if action.duration is None]
    if objective == "time" and unknown:
        raise NoDurationError(unknown)
    return objective == "time" or (objective is None and not unknown)


def _copied(inputs: Inputs, folder: Path) -> dict[str, object]:
    """Copy what went in into the folder, and say which is which."""
    (folder / FILES).mkdir()
    texts = [(source.path, source.text) for source in inputs.sources]
    entries = [_copy(*each, number, folder) for number, each in enumerate(texts)]
    given = inputs.given
    if isinstance(given, Problem) or given.calibration is None:
        return {"files": entries}
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
    """What another person needs to run the same again."""
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
            "max_actions": options.max_actions,
            "max_seconds": options.max_seconds,
        },
        **copied,
    }


def _summary(ended: Ended, truth: Mapping[str, object], folder: Path, video: bool, told: str) -> str:
    """`told`: of the symbolic world, which is not called clean, and has no looks that would take time."""
    kinds = {kind: s for kind, s in ended.spent.by_kind().items() if s >= _SHORT or not told}
    spent = ", ".join(f"{kind.replace('_', ' ')} {s:.1f}" for kind, s in kinds.items())
    is_so = "" if ended.clean else "not "
    lines = [f"{is_so}{'done' if told else 'clean'}: {ended.reason}, after {plural(ended.actions, 'action')}"]
    if kinds:
        lines.append(f"seconds: {ended.spent.total:.1f} ({spent})")
    if told:
        lines.insert(1, f"in the end: {told}")
    if "particles" in truth:
        lines += _left(truth)
    lines.append(f"record: {folder}/  page: report.html" + ("  video: video.mp4" if video else ""))
    return "\n".join(lines)


def _left(truth: Mapping[str, object]) -> Iterator[str]:
    """Where the dirt truly is."""
    yield (
        f"truly: {truth['in_container']} of {truth['particles']} particles in the container,"
        f" {truth['on_table']} on the table, {truth['on_floor']} on the floor"
        + (f", {truth['in_dustpan']} in the dustpan" if truth["in_dustpan"] else "")
    )
    if truth["on_table"]:
        yield f"left on the table at (m): {truth['left_on_table_at']}"
    if truth["ink_left"]:
        yield f"ink left: {truth['ink_left']:.0%}"
