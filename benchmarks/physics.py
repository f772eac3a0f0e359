"""How each action truly ends, by grasp and layout: python benchmarks/physics.py [--repeat N] [--jobs N]

Prints the table of docs/physics.md, a row as soon as its trials are done. 40 trials of every action, grasp
and layout take about half an hour of CPU. `--quick` tries a push twice with two grasps.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.stats import chi2_contingency

from cleancli.cli.act import COUNTED, in_order, tally
from cleancli.execution.trials import Trial, attempt
from cleancli.language.diagnostics import Source
from cleancli.motion.actions import SKILLS
from cleancli.scene.check import load_scene
from cleancli.scene.grasps import SHIPPED
from cleancli.scene.model import Group, Rag, Scene

LAYOUTS: Mapping[str, float] = {"compact": 0.025, "scattered": 0.055}
"""Radius of the discs in which twelve lentils lie, metres."""

PLACES: Mapping[int, tuple[tuple[float, float], ...]] = {
    1: ((0.10, 0.0),),
    2: ((-0.15, 0.08), (0.08, -0.04)),
    3: ((-0.25, 0.08), (-0.05, 0.0), (0.16, -0.06)),
}
"""Middles of the discs by the number of areas that an action takes: the first is 35 cm from the container."""

BASE = load_scene(Source("base", "scene base { dirt { ink { along = (0 m, 0 m) } } }"))


def layout(arity: int, radius: float, grasp: str) -> Scene:
    """The default table with twelve lentils in each disc."""
    held = SHIPPED[grasp]
    dirt = tuple(Group(12, place, radius) for place in PLACES[arity])
    return replace(BASE, dirt=dirt, rag=Rag(held, held.width))


def rows(
    actions: Sequence[str], layouts: Sequence[str], grasps: Sequence[str], repeat: int, jobs: int
) -> Iterator[str]:
    """A table's lines: shares of outcomes by grasp; `p`: how likely chance makes grasps differ so much."""
    yield "| action | lentils | grasp | none left | some left | spread out | trials | left | seconds | p |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for action in actions:
        arity = SKILLS[action].arity
        for kind in layouts:
            counts = []
            for grasp in grasps:
                try_one = partial(attempt, layout(arity, LAYOUTS[kind], grasp), action, arity, ())
                trials = tuple(in_order(try_one, range(1, 1 + repeat), jobs))
                found, total = tally(trials)
                counts.append([found[outcome] for outcome in COUNTED])
                p = chance(counts) if grasp == grasps[-1] else ""
                shares = " | ".join(f"{count / max(total, 1):.2f}" for count in counts[-1])
                yield f"| {action} | {kind} | {grasp} | {shares} | {total} | {_left(trials)} | {p} |"


def chance(counts: Sequence[Sequence[int]]) -> str:
    """The p-value of a chi-squared test over grasps (rows) and outcomes that occurred (columns)."""
    table = np.array(counts)
    table = table[:, table.sum(axis=0) > 0]
    return "1" if table.shape[1] < 2 else f"{chi2_contingency(table).pvalue:.1g}"


def _left(trials: Sequence[Trial]) -> str:
    done = [trial for trial in trials if trial.outcome in COUNTED]
    share = sum(t.left for t in done) / max(1, sum(t.targets for t in done))
    return f"{share:.0%} | {np.mean([t.seconds for t in done] or [0.0]):.1f}"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=40)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        lines = rows(("moveToContainerFast",), ("compact",), ("wide", "corner"), 2, 1)
    else:
        lines = rows(tuple(SKILLS), tuple(LAYOUTS), tuple(SHIPPED), options.repeat, options.jobs)
    for line in lines:
        print(line, flush=True)


if __name__ == "__main__":
    main()
