"""`cleancli act`: try one action many times, and count how it truly ends (§3.3.2)."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

import click
import numpy as np

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.inputs import open_simulated
from cleancli.cli.progress import counting
from cleancli.execution.trials import Trial, TrialResult, attempt
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import meant
from cleancli.motion.actions import ARITIES, TO_ZONE, can_execute
from cleancli.recording.overlay import overlay
from cleancli.recording.pictures import write_png
from cleancli.scene.grasps import SHIPPED, named
from cleancli.scene.model import Rag, Scene
from cleancli.scene.robots import ARMS
from cleancli.simulation.summary import wilson

COUNTED = (TrialResult.NONE_LEFT, TrialResult.SOME_LEFT, TrialResult.SPREAD_OUT)
"""The outcomes of which shares are given; in the other trials nothing was done."""

_Tried = TypeVar("_Tried")


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
    as_data: bool,
) -> None:
    """Carry out ACTION on the table of SCENE many times, and tabulate what truly became of the dirt.

    Every trial has a seed of its own: it decides where in its groups the dirt lies, and all noise.
    docs/physics.md says when nothing, or something, counts as left.
    """
    setting = open_simulated(scene, robot)
    arity = _arity(action, setting)
    names = _names(areas, action, arity)
    if plot is not None and not plot.resolve().parent.is_dir():
        raise click.BadParameter(f"there is no folder `{plot.parent}`", param_hint="--plot")
    first = setting.seed if seed is None else seed
    variants = _variants(setting, grasps)
    found: dict[str, list[Trial]] = {name: [] for name in variants}
    with counting(f"{action}, {{}} of {plural(repeat * len(variants), 'trial')}", as_data) as count:
        for name, variant in variants.items():
            try_one = partial(attempt, variant, action, names)
            for trial in in_order(try_one, range(first, first + repeat), jobs):
                found[name].append(trial)
                count()
    if plot is not None:
        panels = [
            (f"{action}, {name}: {plural(len(trials), 'trial')}", trials) for name, trials in found.items()
        ]
        write_png(plot, overlay(setting, panels))
    echo(
        _as_json(setting, action, names, variants, found)
        if as_data
        else "\n\n".join(
            table(f"{action}, {setting.robot}, grasp {name} of {_cm(variants[name])}", trials)
            for name, trials in found.items()
        )
    )


def in_order(try_one: Callable[[int], _Tried], seeds: Sequence[int], jobs: int) -> Iterator[_Tried]:
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
        lines.append(f"{outcome.value:12} {counts[outcome]:6}  {share:5.2f}  {low:.2f}-{high:.2f}")
    lines += [f"{o.value:12} {counts[o]:6}" for o in TrialResult if o not in COUNTED and counts[o]]
    reasons = Counter(trial.failure for trial in trials if trial.failure)
    lines += [f"  {number} x {reason}" for reason, number in reasons.most_common()]
    done = [trial for trial in trials if trial.outcome in COUNTED]
    if done:
        left = sum(trial.left for trial in done) / max(1, sum(trial.targets for trial in done))
        lines.append(
            f"left on the table: {left:.0%} of the dirt;"
            f" on the floor: {plural(sum(t.lost for t in done), 'particle')};"
            f" robot time: {np.mean([t.seconds for t in done]):.1f} s"
        )
    return "\n".join(lines)


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


def _as_json(
    setting: Scene,
    action: str,
    names: Sequence[str],
    variants: Mapping[str, Scene],
    found: Mapping[str, Sequence[Trial]],
) -> str:
    head = {"scene": setting.name, "robot": setting.robot, "action": action, "areas": list(names)}
    grasps = [
        {"grasp": name, "width": variants[name].rag.width, "outcomes": _shares(trials)}
        | {"trials": [_trial(trial) for trial in trials]}
        for name, trials in found.items()
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
    return f"{setting.rag.width * 100:.4g} cm"
