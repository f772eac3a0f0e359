"""Trials of one action: a table of how they ended, a picture of what they left, or all of it as data."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from cleancli.cli.echo import echo
from cleancli.execution.trials import COUNTED, Trial, TrialResult
from cleancli.language.diagnostics.plural import plural
from cleancli.recording.overlay import overlay
from cleancli.recording.pictures import write_png
from cleancli.scene.model import Scene
from cleancli.statistics.shares import wilson


@dataclass(frozen=True, slots=True)
class Tried:
    """What is tried: an action upon areas of these `names` on a scene's table with these `seeds`, and with
    the scene's `variants` by their grasps; and the trials that were `found` so far."""

    setting: Scene
    action: str
    names: Sequence[str]
    seeds: Sequence[int]
    variants: Mapping[str, Scene]
    found: dict[str, list[Trial]] = field(default_factory=dict)


def show_trials(tried: Tried, plot: Path | None, as_data: bool) -> None:
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
            _table(f"{action}, {setting.robot}, grasp {name} of {_cm(tried.variants[name])}", trials)
            for name, trials in found.items()
        )
    )


def _table(title: str, trials: Sequence[Trial]) -> str:
    """The outcomes of trials with their shares, and Wilson's intervals of 95 %."""
    counts, total = _tally(trials)
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


def _tally(trials: Sequence[Trial]) -> tuple[Counter[TrialResult], int]:
    """How often each outcome was met, and how many trials count."""
    counts = Counter(trial.outcome for trial in trials)
    return counts, sum(counts[outcome] for outcome in COUNTED)


def _as_json(tried: Tried) -> str:
    names, setting = list(tried.names), tried.setting
    head = {"scene": setting.name, "robot": setting.robot, "action": tried.action, "areas": names}
    grasps = [
        {"grasp": name, "width": tried.variants[name].rag.width, "outcomes": _shares(trials)}
        | {"trials": [_trial(trial) for trial in trials]}
        for name, trials in tried.found.items()
    ]
    return json.dumps(head | {"grasps": grasps}, indent=2)


def _shares(trials: Sequence[Trial]) -> dict[str, object]:
    counts, total = _tally(trials)
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
