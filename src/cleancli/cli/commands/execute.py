"""`cleancli execute`: clean a simulated table, watch it happen, and keep a record."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from math import isnan
from pathlib import Path

import click

from cleancli.api.checks import DISCOUNTING
from cleancli.api.inputs import LoadedDomain
from cleancli.api.lessons import Counting, is_own_file
from cleancli.api.run_inputs import inputs_of
from cleancli.api.series import Series, SeriesResult, carried_out
from cleancli.api.series_resuming import resumed
from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.inputs import may_include_outside, open_given, open_loaded, ships_with
from cleancli.cli.recordings import refuse_without_rerun
from cleancli.cli.unreached import tell_unreached
from cleancli.cli.usage import is_given, usage_errors
from cleancli.cli.views.rehearsal import rehearse
from cleancli.cli.views.run import Telling, echo_note, followed
from cleancli.execution.setup import MOST, EpisodeOptions, Job, or_usual, usual_seconds, usual_strategy
from cleancli.execution.strategies import STRATEGIES
from cleancli.execution.teaching import ASK
from cleancli.language.model import Problem
from cleancli.learning.estimate import examples_needed
from cleancli.learning.method import DELTA, KNOWN
from cleancli.learning.optimism import OPTIMISM
from cleancli.planning.registry import PLANNERS
from cleancli.recording.folder import RUN
from cleancli.recording.series import MOST_EPISODES

_BESIDE_RESUME = {"resume", "saved", "confirm", "as_data", "quiet"}
"""What may be said beside `--resume`, since it is not about what is carried out."""


def _number(context: click.Context, parameter: click.Parameter, value: float | None) -> float | None:
    """A limit that something can be compared with, where one is given."""
    if value is not None and isnan(value):
        raise click.BadParameter("this is no number", context, parameter)
    return value


@command_of("execute")
@click.option(
    "--resume",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    metavar="RUN",
    help="Go on with the run or the series in this folder, as it began; takes no other arguments.",
)
@options.seed(usual="PROBLEM's, or 1")
@click.option(
    "--strategy",
    type=click.Choice(list(STRATEGIES)),
    help="Who decides what to do; plan-N plans, and carries out N actions before planning again (§4.2.4)."
    f"  [default: {usual_strategy(is_scene=True)}, or for a problem that is no scene"
    f" {usual_strategy(is_scene=False)}]",
)
@click.option(
    "--planner", type=click.Choice(list(PLANNERS)), help="[default: all-outcomes for determinized, or prada+]"
)
@options.samples("Action sequences to draw for each plan.", 10_000, MOST)
@options.objective(
    DISCOUNTING, "time, if the domain says how long each action takes and its reward does not count it"
)
@click.option(
    "--job",
    type=click.Choice([job.value for job in Job]),
    help="How dirt leaves the table: pushed into the container, picked up with a dustpan, or wiped away."
    "  [default: dustpan, if the robot has one; wipe, if the domain does nothing else]",
)
@click.option(
    "--known",
    type=click.IntRange(min=0, max=MOST),
    metavar="T",
    help="Move the arm out of view after an action whose rule was seen less than T times (§5.2)."
    f"  [default: {KNOWN} with --learn, else 0]",
)
@click.option(
    "--epsilon",
    type=click.FloatRange(0, 1, min_open=True, max_open=True),
    help="In place of --known: as often as it takes until estimates are off by at most this (eq. 6)...",
)
@click.option(
    "--delta",
    type=click.FloatRange(0, 1, min_open=True, max_open=True),
    help="... but for this probability.  [default: 0.05]",
)
@click.option(
    "--optimism",
    type=click.Choice(OPTIMISM),
    default="prior",
    show_default=True,
    help="With --learn, what plans hope of rules that are not known yet: what their probabilities say, or the"
    " best there is (R-MAX).",
)
@click.option(
    "--world",
    metavar="FILE",
    help="The rules by which the symbolic world acts, for problems that are no scenes. [default: DOMAIN's]",
)
@click.option(
    "--learn",
    is_flag=True,
    help="Learn from each action, and plan with what was learned (§5).",
)
@click.option(
    "--structure",
    is_flag=True,
    help="With --learn, learn whole rules and not their probabilities alone (§7.1).",
)
@click.option(
    "--teacher",
    metavar="FILE",
    help="Asked by --strategy explore where no plan is believed to reach the goal: rules in FILE that answer;"
    f" `{ASK}` is a person at the terminal.",
)
@options.learning()
@click.option(
    "--episodes",
    type=click.IntRange(min=1, max=MOST_EPISODES),
    default=1,
    show_default=True,
    help="Carry PROBLEM out so often, with one seed after the other.",
)
@click.option(
    "--write",
    is_flag=True,
    help="With --learn, change the probabilities in DOMAIN's file after each episode.",
)
@options.max_actions("Stop after so many actions.", MOST)
@click.option(
    "--max-seconds",
    type=click.FloatRange(min=0, max=MOST),
    callback=_number,
    help="Stop after so many seconds, of robot and of planning."
    f"  [default: {usual_seconds(is_scene=True):g}, or for a problem that is no scene no limit]",
)
@click.option(
    "--runs",
    type=click.Path(path_type=Path),
    default=Path("runs"),
    show_default=True,
    help="Folder to make the run's folder in.",
)
@click.option("--video/--no-video", default=True, show_default=True, help="Record a video of the run.")
@click.option(
    "--rrd", type=options.FILE, metavar="FILE", help="Write the run for the Rerun viewer, as it goes on."
)
@click.option(
    "--save-frames",
    "saved",
    type=options.FOLDER,
    metavar="FOLDER",
    help="Write the frame that each look ends with into this folder, as `perceive` reads it.",
)
@click.option(
    "--dry-run",
    "rehearsal",
    type=options.FILE,
    metavar="FILE",
    help="Only look and decide: draw the first stroke over the camera's picture (PNG), and move nothing.",
)
@click.option(
    "--confirm",
    is_flag=True,
    help="Ask before each motion of the robot, and end the run where the answer is no.",
)
@options.as_json("Print the summary as JSON, and nothing else.")
@click.option("--quiet", is_flag=True, help="Print nothing but errors; the run's folder tells all.")
@usage_errors()
def command(
    domain: str | None,
    problem: str | None,
    resume: Path | None,
    seed: int | None,
    strategy: str | None,
    planner: str | None,
    samples: int,
    objective: str | None,
    job: str | None,
    known: int | None,
    epsilon: float | None,
    delta: float | None,
    optimism: str,
    world: str | None,
    learn: bool,
    structure: bool,
    teacher: str | None,
    estimator: str | None,
    m: float | None,
    match: str | None,
    forgetting: float | None,
    episodes: int,
    write: bool,
    max_actions: int,
    max_seconds: float | None,
    runs: Path,
    video: bool,
    rrd: Path | None,
    saved: Path | None,
    rehearsal: Path | None,
    confirm: bool,
    as_data: bool,
    quiet: bool,
) -> int:
    """Carry PROBLEM out with the rules of DOMAIN: look, decide, act, until nothing is left to do.

    A scene is carried out on a simulated table, by a simulated robot; any other problem in the symbolic
    world. Leaves a folder with run.json, experience.jsonl, and of a table a picture per action and a video.
    Exit code 3 if something is left at the end; the summary says where every lentil truly is and how much
    ink is left, apart from what perception believed.
    """
    telling = Telling(as_data, quiet, rrd, saved, confirm)
    follow = partial(followed, telling=telling)
    if resume is not None:
        _refuse_beside_resume()
        return _tell(_shown(resumed(resume, echo_note, follow), telling), telling)
    if domain is None or problem is None:
        raise click.UsageError("name a domain and a problem, or a run by --resume")
    _check_together(rrd, episodes, write, learn)
    given = open_given(domain, problem)
    if write and not is_own_file(domain):
        raise ships_with(domain, given.domain)
    method = Counting(estimator, m, match, forgetting).method(given.domain.model) if learn else None
    known, (chosen, seconds) = _known(known, epsilon, delta), or_usual(given.is_scene, strategy, max_seconds)
    asked = EpisodeOptions(chosen, planner, samples, max_actions, seconds, learning=method)
    asked = replace(asked, optimism=optimism, structure=structure, is_taught=teacher is not None)
    acting, shown_by = None if world is None else open_loaded(world), _shown_by(teacher, telling)
    inputs = inputs_of(
        given, asked, seed=seed, objective=objective, job=job, known=known, world=acting, teacher=shown_by
    )
    if rehearsal is not None:
        return rehearse(inputs, rehearsal)
    if isinstance(inputs.given, Problem) and not inputs.options.structure:
        tell_unreached(inputs.sources, inputs.domain, inputs.given)
    series = Series(given, inputs, episodes, runs, video, is_own_file(domain), write, may_include_outside())
    return _tell(_shown(carried_out(series, follow), telling), telling)


def _check_together(rrd: Path | None, episodes: int, write: bool, learn: bool) -> None:
    """Raises UsageError for options that do not go together; MissingPart without Rerun, BadParameter where
    its file cannot be written."""
    if write and not learn:
        raise click.UsageError("--write writes what --learn has learned: ask for both")
    if rrd is None:
        return
    refuse_without_rerun()
    if not rrd.resolve().parent.is_dir():
        raise click.BadParameter(f"there is no folder `{rrd.parent}`", param_hint="--rrd")
    if episodes > 1:
        raise click.UsageError("--rrd writes one run, and --episodes carries out several: ask for one")


def _shown_by(teacher: str | None, telling: Telling) -> LoadedDomain | None:
    """The rules of a teacher that is a file. Raises UsageError where a person would be asked unseen."""
    if teacher == ASK and telling.silently:
        raise click.UsageError(f"--teacher {ASK} asks a person, and --quiet and --json show nothing")
    return None if teacher in (None, ASK) else open_loaded(teacher)


def _shown(results: Iterable[SeriesResult], telling: Telling) -> SeriesResult:
    """The last of what a series has come to after each episode, which is told."""
    for result in results:
        if not telling.silently:
            echo(str(result.runs[-1]))
    return result


def _known(known: int | None, epsilon: float | None, delta: float | None) -> int | None:
    """After how many examples a rule is known, if that is said. Raises UsageError for more than one way of
    saying so."""
    if known is not None and (epsilon, delta) != (None, None):
        raise click.UsageError("--known and --epsilon say the same: ask for one")
    if epsilon is None:
        if delta is not None:
            raise click.UsageError("--delta is for --epsilon: ask for both")
        return known
    needed = examples_needed(epsilon, DELTA if delta is None else delta)
    if needed > MOST:
        raise click.UsageError(f"--epsilon {epsilon:g} would take {needed} examples of each rule")
    return needed


def _refuse_beside_resume() -> None:
    """Raises UsageError for what a resumed run has from its beginning."""
    for each in click.get_current_context().command.params:
        if each.name is not None and each.name not in _BESIDE_RESUME and is_given(each.name):
            what = each.name.upper() if isinstance(each, click.Argument) else each.opts[0]
            raise click.UsageError(f"--resume goes on as the run began, and takes no {what}")


def _tell(result: SeriesResult, telling: Telling) -> int:
    """What all episodes came to; each was told already where that is wanted. One episode in which nothing
    was learned is told as its run.json."""
    alone = len(result.runs) == 1 and result.learned is None
    if telling.as_data and alone:
        echo((result.runs[0].folder / RUN).read_text(encoding="utf-8"), nl=False)
    elif telling.as_data:
        click.echo(json.dumps(result.to_dict(), indent=2))
    elif not telling.quiet and not alone:
        echo(str(result))
    return ExitCode.DONE if result.is_clean else ExitCode.NOT_CLEAN
