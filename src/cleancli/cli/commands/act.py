"""`cleancli act`: try one action many times, and count how it truly ends (§3.3.2)."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

import click
import numpy as np
from click.core import ParameterSource

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.inputs import open_with
from cleancli.cli.progress import counting
from cleancli.cli.questions import answer
from cleancli.cli.views.motions import ask_before, way_of
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.seen_trials import aimed, attempt_seen
from cleancli.execution.trials import Trial, TrialResult, attempt
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import meant
from cleancli.motion.actions import ARITIES, TO_ZONE, can_execute
from cleancli.perception.frame_source import BadRecording
from cleancli.perception.pictures import draw
from cleancli.perception.surface import NoSurface
from cleancli.recording.overlay import overlay
from cleancli.recording.pictures import write_png
from cleancli.scene.grasps import SHIPPED, named
from cleancli.scene.model import Rag, Scene
from cleancli.scene.robots import ARMS
from cleancli.statistics.shares import wilson

COUNTED = (TrialResult.NONE_LEFT, TrialResult.SOME_LEFT, TrialResult.SPREAD_OUT)
"""The outcomes of which shares are given; in the other trials nothing was done."""

_Outcome = TypeVar("_Outcome")


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
    tried = _Tried(setting, action, names, range(first, first + repeat), _variants(setting, grasps))
    if setting.address is None:
        _refuse_given("is for a robot at the end of a socket", ("rehearsal", "confirm"))
        _simulate(tried, jobs, as_data)
        _show(tried, plot, as_data)
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
        _show(tried, plot, as_data)


@dataclass(frozen=True, slots=True)
class _Tried:
    """What is tried: an action upon areas of these `names` on a scene's table with these `seeds`, and with
    the scene's `variants` by their grasps; and the trials that were `found` so far."""

    setting: Scene
    action: str
    names: Sequence[str]
    seeds: Sequence[int]
    variants: Mapping[str, Scene]
    found: dict[str, list[Trial]] = field(default_factory=dict)


def _simulate(tried: _Tried, jobs: int, silently: bool) -> None:
    """All trials of all grasps, counted while they go on."""
    number = plural(len(tried.seeds) * len(tried.variants), "trial")
    with counting(f"{tried.action}, {{}} of {number}", silently) as count:
        for name, variant in tried.variants.items():
            trials = tried.found.setdefault(name, [])
            for trial in in_order(partial(attempt, variant, tried.action, tried.names), tried.seeds, jobs):
                trials.append(trial)
                count()


def _carry_out(tried: _Tried, confirm: bool) -> None:
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


def _rehearse(tried: _Tried, file: Path) -> None:
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
    context = click.get_current_context()
    options = {each.name: each.opts[0] for each in context.command.params}
    for name in names:
        if context.get_parameter_source(name) not in (ParameterSource.DEFAULT, None):
            raise click.UsageError(f"{options[name]} {what}")


def _show(tried: _Tried, plot: Path | None, as_data: bool) -> None:
    """What all trials came to; nothing where there were none."""
    if not any(tried.found.values()):
        return
    setting, action, found = tried.setting, tried.action, tried.found
    if plot is not None:
        panels = [
            (f"{action}, {name}: {plural(len(trials), 'trial')}", trials) for name, trials in found.items()
        ]
        write_png(plot, overlay(setting, panels))
    if as_data:
        echo(_as_json(tried))
        return
    echo(
        "\n\n".join(
            table(f"{action}, {setting.robot}, grasp {name} of {_cm(tried.variants[name])}", trials)
            for name, trials in found.items()
        )
    )


def in_order(try_one: Callable[[int], _Outcome], seeds: Sequence[int], jobs: int) -> Iterator[_Outcome]:
    """What came of these seeds in their order, so many at a time."""
    if jobs == 1:
        yield from map(try_one, seeds)
        return
    # A fork would share what the engine and OpenCV have loaded; a fresh process shares nothing.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(try_one, seeds)


def table(title: str, trials: Sequence[Trial]) -> str:
    """The outcomes of trials with their shares, and Wilson's intervals of 95 %."""
    counts, total = tally(trials)
    lines = [title, f"{'outcome':12} {'trials':>6}  {'share':>5}  95 %"]
    for outcome in COUNTED:
        low, high = wilson(counts[outcome], total)
        share = counts[outcome] / total if total else 0.0
        lines.append(f"{outcome.value:12} {counts[outcome]:6}  {share:5.2f}  {low:z.2f}-{high:z.2f}")
    lines += [f"{o.value:12} {counts[o]:6}" for o in TrialResult if o not in COUNTED and counts[o]]
    reasons = Counter(trial.failure for trial in trials if trial.failure)
    lines += [f"  {number} x {reason}" for reason, number in reasons.most_common()]
    done = [trial for trial in trials if trial.outcome in COUNTED]
    if done:
        left = sum(trial.left for trial in done) / max(1, sum(trial.targets for trial in done))
        lines.append(
            f"left on the table: {left:z.0%} of the dirt{_on_floor(done)};"
            f" robot time: {np.mean([t.seconds for t in done]):z.1f} s"
        )
    return "\n".join(lines)


def _on_floor(trials: Sequence[Trial]) -> str:
    """How much fell down, if that is known."""
    lost = [trial.lost for trial in trials if trial.lost is not None]
    return f"; on the floor: {plural(sum(lost), 'particle')}" if lost else ""


def tally(trials: Sequence[Trial]) -> tuple[Counter[TrialResult], int]:
    """How often each outcome was met, and how many trials count."""
    counts = Counter(trial.outcome for trial in trials)
    return counts, sum(counts[outcome] for outcome in COUNTED)


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


def _as_json(tried: _Tried) -> str:
    names, setting = list(tried.names), tried.setting
    head = {"scene": setting.name, "robot": setting.robot, "action": tried.action, "areas": names}
    grasps = [
        {"grasp": name, "width": tried.variants[name].rag.width, "outcomes": _shares(trials)}
        | {"trials": [_trial(trial) for trial in trials]}
        for name, trials in tried.found.items()
    ]
    return json.dumps(head | {"grasps": grasps}, indent=2)


def _shares(trials: Sequence[Trial]) -> dict[str, object]:
    counts, total = tally(trials)
    shares: dict[str, object] = {}
    for outcome in COUNTED:
        low, high = wilson(counts[outcome], total)
        share = counts[outcome] / total if total else None
        shares[outcome.value] = {"trials": counts[outcome], "share": share, "low": low, "high": high}
    return shares


def _trial(trial: Trial) -> dict[str, object]:
    return {
        "seed": trial.seed,
        "outcome": trial.outcome.value,
        "targets": trial.targets,
        "left": trial.left,
        "on_floor": trial.lost,
        "seconds": round(trial.seconds, 3),
        "failure": trial.failure,
    }


def _cm(setting: Scene) -> str:
    return f"{setting.rag.width * 100:z.4g} cm"
