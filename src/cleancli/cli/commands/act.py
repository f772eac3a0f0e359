"""`cleancli act`: try one action many times, and count how it truly ends (§3.3.2)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import click
import numpy as np

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.inputs import open_with
from cleancli.cli.progress import counting
from cleancli.cli.questions import answer
from cleancli.cli.usage import is_given
from cleancli.cli.views.motions import ask_before, way_of
from cleancli.cli.views.trials import Tried, show_trials
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.seen_trials import aimed, attempt_seen
from cleancli.execution.trials import attempt, in_order
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import meant
from cleancli.motion.actions import ARITIES, TO_ZONE, can_execute
from cleancli.perception.frame_source import BadRecording
from cleancli.perception.pictures import draw
from cleancli.perception.surface import NoSurface
from cleancli.recording.pictures import write_png
from cleancli.scene.grasps import SHIPPED, named
from cleancli.scene.model import Rag, Scene
from cleancli.scene.robots import ARMS


@command_of("act")
@click.option(
    "--repeat", type=click.IntRange(min=1), default=20, show_default=True, help="How often, per grasp."
)
@click.option(
    "--areas", default="", help='Areas to act on, as the first look names them: "a2 a1". [default: the first]'
)
@click.option(
    "--grasp", "grasps", multiple=True, help="A grasp to try, in its own width. [default: the scene's rag]"
)
@click.option("--robot", type=click.Choice(list(ARMS)), help="The robot that acts. [default: the scene's]")
@options.seed("the first trial")
@options.jobs("Trials at a time.")
@click.option(
    "--plot",
    type=options.FILE,
    help="Draw where particles lay before and after, and the tool's way, as a PNG picture.",
)
@click.option(
    "--dry-run",
    "rehearsal",
    type=options.FILE,
    metavar="FILE",
    help="Of a remote robot: only look, draw the stroke over the camera's picture (PNG), and move nothing.",
)
@click.option("--confirm", is_flag=True, help="Ask before each motion of a remote robot.")
@options.as_json("Print every trial as JSON, and nothing else.")
def command(
    scene: str,
    action: str,
    repeat: int,
    areas: str,
    grasps: tuple[str, ...],
    robot: str | None,
    seed: int | None,
    jobs: int,
    plot: Path | None,
    rehearsal: Path | None,
    confirm: bool,
    as_data: bool,
) -> None:
    """Carry out ACTION on the table of SCENE many times, and tabulate what truly became of the dirt.

    Every trial has a seed of its own: it decides where in its groups the dirt lies, and all noise.
    docs/physics.md says when nothing, or something, counts as left. On the table of a remote robot a person
    lays the dirt and is asked before each trial, and what became of it is what the camera sees.
    """
    setting = open_with(scene, robot)
    names = _names(areas, action, _arity(action, setting))
    for option, file in (("--plot", plot), ("--dry-run", rehearsal)):
        if file is not None and not file.resolve().parent.is_dir():
            raise click.BadParameter(f"there is no folder `{file.parent}`", param_hint=option)
    first = setting.seed if seed is None else seed
    tried = Tried(setting, action, names, range(first, first + repeat), _variants(setting, grasps))
    if setting.address is None:
        _refuse_given("is for a robot at the end of a socket", ("rehearsal", "confirm"))
        _simulate(tried, jobs, as_data)
        show_trials(tried, plot, as_data)
        return
    _refuse_given("is for simulated tables", ("grasps", "jobs"))
    try:
        if rehearsal is not None:
            _rehearse(tried, rehearsal)
        else:
            _carry_out(tried, confirm)
    except NoSurface as error:
        raise BadRecording(f"the camera: {error}") from error
    finally:  # what has been tried is told, whatever ends it
        show_trials(tried, plot, as_data)


def _simulate(tried: Tried, jobs: int, silently: bool) -> None:
    """All trials of all grasps, counted while they go on."""
    number = plural(len(tried.seeds) * len(tried.variants), "trial")
    with counting(f"{tried.action}, {{}} of {number}", silently) as count:
        for name, variant in tried.variants.items():
            trials = tried.found.setdefault(name, [])
            for trial in in_order(partial(attempt, variant, tried.action, tried.names), tried.seeds, jobs):
                trials.append(trial)
                count()


def _carry_out(tried: Tried, confirm: bool) -> None:
    """The trials of a remote robot, as many as a person has laid dirt for."""
    from cleancli.remote.robot import RemoteRobot

    (trials,) = (tried.found.setdefault(name, []) for name in tried.variants)
    with RemoteRobot(tried.setting.driver) as robot:
        for number, seed in enumerate(tried.seeds, start=1):
            question = f"trial {number} of {len(tried.seeds)}: is the dirt laid out, and nobody in reach?"
            if not answer(partial(click.confirm, question, default=False, err=True)):
                return
            asks = {"asks": ask_before} if confirm else {}
            trials.append(attempt_seen(tried.setting, tried.action, tried.names, seed, robot, **asks))


def _rehearse(tried: Tried, file: Path) -> None:
    """The stroke of the first trial over the camera's picture, by a look from where the arm is."""
    from cleancli.remote.robot import RemoteRobot

    rng = np.random.default_rng(derived(tried.seeds[0], Stream.PERCEPTION))
    with RemoteRobot(tried.setting.driver) as robot:
        aim = aimed(tried.setting, tried.action, tried.names, robot, rng)
    stroke = None if aim.path is None else np.array(aim.path.stroke).reshape(-1, 2)
    write_png(file, draw(aim.frame, aim.areas, stroke=stroke))
    if aim.path is None:
        echo(f"{tried.action} finds too few areas to act on; {file} shows what is seen")
    else:
        what = f"{tried.action}({', '.join(area.name for area in aim.chosen)})"
        echo(f"it would carry out {what}: {way_of(aim.path)}; {file} shows it, and nothing has moved")


def _refuse_given(what: str, names: Sequence[str]) -> None:
    """Raises UsageError for an option that makes no sense with this robot."""
    options = {each.name: each.opts[0] for each in click.get_current_context().command.params}
    for name in names:
        if is_given(name):
            raise click.UsageError(f"{options[name]} {what}")


def _arity(action: str, setting: Scene) -> int:
    if action not in ARITIES:
        raise click.BadParameter(
            f"no action `{action}`; {meant(action, ARITIES, 'action')}", param_hint="ACTION"
        )
    if not can_execute(action, ARITIES[action], setting.arms):
        able = [drive for drive, arms in ARMS.items() if can_execute(action, ARITIES[action], arms)]
        raise click.BadParameter(
            f"`{setting.robot}` can't {action}; it takes --robot {' or '.join(able)}", param_hint="ACTION"
        )
    if action in TO_ZONE and setting.zone is None:
        raise click.BadParameter(
            f"{action} takes a scene with a zone, which `{setting.name}` has not", param_hint="ACTION"
        )
    return ARITIES[action]


def _names(areas: str, action: str, arity: int) -> tuple[str, ...]:
    names = tuple(name for name in re.split(r"[\s,]+", areas) if name)
    if names and (len(names) != arity or len(set(names)) != arity):
        takes = "one area" if arity == 1 else f"{arity} different areas"
        raise click.BadParameter(f"{action} takes {takes}", param_hint="--areas")
    return names


def _variants(setting: Scene, grasps: Sequence[str]) -> Mapping[str, Scene]:
    """The scene with each grasp asked for, by name; as it is, where none is."""
    if not grasps:
        return {setting.rag.grasp.name: setting}
    known = named((*SHIPPED.values(), *setting.grasps))
    for name in grasps:
        if name not in known:
            raise click.BadParameter(
                f"no grasp `{name}`; {meant(name, known, 'grasp')}", param_hint="--grasp"
            )
    return {name: replace(setting, rag=Rag(known[name], known[name].width)) for name in grasps}
