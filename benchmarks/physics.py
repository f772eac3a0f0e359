"""What actions truly do: python benchmarks/physics.py [--keep FILE] [--repeat N] [--seed N] [--part NAME] ...

Prints the tables of docs/measurements/physics.md, a row as soon as its trials are done:

- actions: each action of §3.2, with each grasp, on compact and on scattered dirt;
- path: the WAM's fast and straight pushes (§3.2.1), and what of their difference is path and what speed;
- ink: how much ink a pass takes.

All of it takes about two hours of CPU. With --keep every trial is written to a file as soon as it is done,
and trials that stand there already are not done again, but all count. Trials have the seeds N, N + 1 and so
on. `--action NAME` makes the rows of one action alone, `--grasp` those of some grasps. `--quick` tries
little of everything, in about a minute.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
from kept import Kept, Row
from scipy.stats import binomtest, chi2_contingency, wilcoxon

from cleancli.execution.seeds import Stream, derived
from cleancli.execution.trials import COUNTED, TrialResult, attempt, in_order
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.motion.actions import ARITIES, PICK_UP, PICK_UPS, TO_ZONE, WIPES, tool_path
from cleancli.motion.arm import forward
from cleancli.motion.joint_path import nearest_pose, stroke
from cleancli.motion.legs import legs
from cleancli.motion.pace import FAST_SPEED, STRAIGHT_SPEED
from cleancli.motion.path import Interpolation, ToolPath, Unreachable
from cleancli.scene.check import load_scene
from cleancli.scene.grasps import SHIPPED
from cleancli.scene.model import Container, Group, Ink, Rag, Scene
from cleancli.world.robot import finish
from cleancli.world.robots import wam
from cleancli.world.table import PybulletTable

LAYOUTS: Mapping[str, float] = {"compact": 0.025, "scattered": 0.055}
"""Radius of the discs in which twelve lentils lie, metres."""

PLACES: Mapping[int, tuple[tuple[float, float], ...]] = {
    1: ((0.10, 0.0),),
    2: ((-0.15, 0.08), (0.08, -0.04)),
    3: ((-0.25, 0.08), (-0.05, 0.0), (0.16, -0.06)),
}
"""Middles of the discs by the number of areas that an action takes: the first is 35 cm from the container."""

PICKED: Mapping[int, tuple[tuple[float, float], ...]] = {
    1: ((0.05, 0.0),),
    2: ((0.16, 0.04), (-0.02, -0.04)),
    3: ((0.17, 0.08), (0.10, -0.07), (0.0, -0.04)),
}
"""The same of the discs to pick up, on the smaller surface that REEM reaches."""

BOW_PLACES = (-0.20, -0.18), (0.05, 0.18)
"""The WAM's discs lie anywhere between these corners, elsewhere for each seed."""

WAYS: Mapping[str, tuple[Interpolation, float]] = {
    "straight, slow": (Interpolation.STRAIGHT, STRAIGHT_SPEED),  # moveToContainerStraight
    "straight, quick": (Interpolation.STRAIGHT, FAST_SPEED),
    "bowed, slow": (Interpolation.JOINT, STRAIGHT_SPEED),
    "bowed, quick": (Interpolation.JOINT, FAST_SPEED),  # moveToContainerFast
}
"""Both pushes of §3.2.1, and what lies between them."""

PASSES = 3
"""Of the rag over one line of ink."""

BASE = load_scene(Source("base", "scene base { dirt { ink { along = (0 m, 0 m) } } }"))
DESK = replace(
    BASE,
    robot="reem",
    surface=replace(BASE.surface, width=0.50, depth=0.40),
    container=Container("south", 0.0, 0.32, 0.16),
)
BENCH = replace(BASE, robot="wam", surface=replace(BASE.surface, width=0.60, depth=0.55))


PathOf = Callable[[str, tuple[Ellipse, ...], Scene], ToolPath]


@dataclass(frozen=True, slots=True)
class Run:
    """How often to try what, the `first` seed, how many tries at a time, and what is kept of them."""

    repeat: int
    first: int
    jobs: int
    keep: Kept

    def rows(self, what: Mapping[str, str], try_one: Callable[[int], Row]) -> list[Row]:
        """A row for each seed, all of which say `what` was tried; those kept are not tried again, and those
        of later seeds count too."""
        seeds = range(self.first, self.first + self.repeat)
        kept: dict[int, Row] = {row["seed"]: row for row in self.keep.rows() if row.items() >= what.items()}
        missing = [seed for seed in seeds if seed not in kept]
        for seed, row in zip(missing, in_order(try_one, missing, self.jobs), strict=True):
            kept[seed] = {**what, "seed": seed, **row}
            self.keep.add(kept[seed])
        return [kept[seed] for seed in sorted(kept) if seed >= self.first]


def layout(action: str, kind: str, grasp: str) -> Scene:
    """A table with twelve lentils in each disc."""
    scene, places = (DESK, PICKED) if action in PICK_UPS else (BASE, PLACES)
    dirt = tuple(Group(12, place, LAYOUTS[kind]) for place in places[ARITIES[action]])
    return replace(scene, dirt=dirt, rag=Rag(SHIPPED[grasp], SHIPPED[grasp].width))


def trial(scene: Scene, action: str, seed: int) -> Row:
    """How the action ends on this table."""
    return _row(scene, action, seed)


def actions(run: Run, names: Sequence[str], kinds: Sequence[str], grasps: Sequence[str]) -> Iterator[str]:
    """Shares of outcomes by grasp. `from wide`: how likely chance makes a grasp differ from the first so
    much; `p`: how likely it makes all of them."""
    yield (
        "| action | lentils | grasp | none left | some left | spread out | trials | failed | left | seconds"
        " | from wide | p |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|---|"
    for action, kind in product(names, kinds):
        counts: list[list[int]] = []
        for grasp in grasps:
            what = {"part": "actions", "action": action, "lentils": kind, "grasp": grasp}
            rows = run.rows(what, partial(trial, layout(action, kind, grasp), action))
            counts.append([_number(rows, outcome) for outcome in COUNTED])
            apart = chance((counts[0], counts[-1])) if len(counts) > 1 else ""
            p = chance(counts) if grasp == grasps[-1] else ""
            yield f"| {action} | {kind} | {grasp} | {_shares(rows)} | {_means(rows)} | {apart} | {p} |"


def chance(counts: Sequence[Sequence[int]]) -> str:
    """The p-value of a chi-squared test over grasps (rows) and outcomes that occurred (columns)."""
    table = np.array(counts)
    table = table[:, table.sum(axis=0) > 0]
    if table.shape[1] < 2 or not table.any(axis=1).all():
        return "1"
    return f"{chi2_contingency(table).pvalue:.1g}"


def push(way: str, action: str, areas: tuple[Ellipse, ...], scene: Scene) -> ToolPath:
    """The path of `moveToContainerStraight`, gone another way."""
    path = tool_path(action, areas, scene)
    interpolation, speed = WAYS[way]
    waypoints = tuple(replace(w, speed=speed) if w.speed == STRAIGHT_SPEED else w for w in path.waypoints)
    return replace(path, waypoints=waypoints, interpolation=interpolation)


def bow(path: ToolPath, scene: Scene) -> float:
    """How far, in metres, the WAM's tool leaves the straight line between the ends of its stroke."""
    arm, parts = wam.arm_for(scene), legs(path.waypoints, np.zeros(4))
    rest = nearest_pose(arm, parts[0].points[0])
    joints = stroke(arm, parts, path.interpolation, rest, 1)
    level = next(number for number, leg in enumerate(parts) if leg.level)
    places = forward(arm, joints[level])[:, :2, 3]
    along = (places[-1] - places[0]) / np.linalg.norm(places[-1] - places[0])
    away = (places - places[0]) @ np.array((-along[1], along[0]))
    return float(np.abs(away).max())


def bowed(way: str, kind: str, seed: int) -> Row:
    """A push by the WAM, of a disc whose place the seed decides; `bow` in metres."""
    x, y = np.random.default_rng(seed).uniform(*BOW_PLACES)
    scene = replace(BENCH, dirt=(Group(12, (float(x), float(y)), LAYOUTS[kind]),))
    bows: list[float] = []

    def path_of(action: str, areas: tuple[Ellipse, ...], scene: Scene) -> ToolPath:
        path = push(way, action, areas, scene)
        with suppress(Unreachable):  # the trial will fail, and say why
            bows.append(bow(path, scene))
        return path

    return {**_row(scene, "moveToContainerStraight", seed, path_of), "bow": bows}


def paths(run: Run, kinds: Sequence[str]) -> Iterator[str]:
    """The four ways to push, and then tests of pairs of them: the same seed is the same table and the same
    noise, so that every push has its partner."""
    found: dict[tuple[str, str], list[Row]] = {}
    yield "| lentils | way | none left | some left | spread out | trials | failed | left | seconds | bow |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for kind, way in product(kinds, WAYS):
        what = {"part": "path", "lentils": kind, "way": way}
        rows = run.rows(what, partial(bowed, way, kind))
        found[kind, way] = rows
        middle = np.median([b for row in rows for b in row["bow"]])
        yield f"| {kind} | {way} | {_shares(rows)} | {_means(rows)} | {1000 * middle:.0f} mm |"
    yield ""
    yield "| lentils | first | second | pairs | first left | second | p | only first cleared | second | p |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for kind, (one, other) in product(kinds, PAIRS):
        yield f"| {kind} | {one} | {other} | {_compared(found[kind, one], found[kind, other])} |"


PAIRS = (
    ("straight, slow", "bowed, quick"),
    ("straight, slow", "bowed, slow"),
    ("straight, quick", "bowed, quick"),
    ("straight, slow", "straight, quick"),
    ("bowed, slow", "bowed, quick"),
)
"""The two actions; the path alone, at each speed; the speed alone, on each path."""


def _compared(first: Sequence[Row], second: Sequence[Row]) -> str:
    """Shares of dirt left, with Wilcoxon's signed-rank test; how often one alone cleared all, with
    McNemar's."""
    both = [(a, b) for a, b in zip(first, second, strict=True) if _done(a) and _done(b)]
    left = np.array([[row["left"] / max(1, row["targets"]) for row in pair] for pair in both]).reshape(-1, 2)
    cleared = left == 0
    alone = [int((cleared[:, k] & ~cleared[:, 1 - k]).sum()) for k in (0, 1)]
    differ = bool((left[:, 0] != left[:, 1]).any())
    p = wilcoxon(left[:, 0], left[:, 1]).pvalue if differ else 1.0
    mcnemar = binomtest(alone[0], sum(alone)).pvalue if sum(alone) else 1.0
    one, other = left.mean(axis=0) if len(left) else (0.0, 0.0)
    return f"{len(both)} | {one:.0%} | {other:.0%} | {p:.1g} | {alone[0]} | {alone[1]} | {mcnemar:.1g}"


def passes(grasp: str, seed: int) -> Row:
    """How much of a line of ink, 6 cm across the rag's way, is left after each pass of one table."""
    held, line = SHIPPED[grasp], Ink(((-0.10, -0.03), (-0.10, 0.03)), 0.008)
    scene = replace(BASE, dirt=(line,), rag=Rag(held, held.width))
    area = Ellipse((-0.10, 0.0), (0.034, 0.004), np.pi / 2)
    left = []
    with closing(PybulletTable(scene, derived(seed, Stream.WORLD))) as table:
        for _ in range(PASSES):
            table.start(tool_path("moveToContainerStraight", (area,), scene))
            finish(table)
            left.append(round(table.truth().ink_left or 0.0, 4))
    return {"left": left}


def ink(run: Run, grasps: Sequence[str]) -> Iterator[str]:
    """By grasp: the shares of passes that take next to no ink, and most of it; the mean left after each."""
    header = " | ".join(f"after {number + 1}" for number in range(PASSES))
    yield f"| grasp | passes | took under 5 % | took over half | {header} |"
    yield "|---|---|---|---|" + "---|" * PASSES
    for grasp in grasps:
        rows = run.rows({"part": "ink", "grasp": grasp}, partial(passes, grasp))
        left = np.array([row["left"] for row in rows])
        before = np.column_stack((np.ones(len(left)), left[:, :-1]))
        took = (1 - left / np.maximum(before, 1e-9))[before > 0.01]
        means = " | ".join(f"{share:.0%}" for share in left.mean(axis=0))
        yield f"| {grasp} | {took.size} | {(took < 0.05).mean():.0%} | {(took > 0.5).mean():.0%} | {means} |"


def _row(scene: Scene, action: str, seed: int, path_of: PathOf = tool_path) -> Row:
    rightmost_first = [f"a{number}" for number in range(ARITIES[action], 0, -1)]
    done = attempt(scene, action, rightmost_first if action in PICK_UPS else (), seed, path_of)
    return {
        "outcome": done.outcome.value,
        "targets": done.targets,
        "left": done.left,
        "on_floor": done.lost,
        "seconds": round(done.seconds, 3),
        "failure": done.failure,
    }


def _done(row: Row) -> bool:
    return row["outcome"] in [outcome.value for outcome in COUNTED]


def _number(rows: Sequence[Row], outcome: TrialResult) -> int:
    return sum(row["outcome"] == outcome.value for row in rows)


def _shares(rows: Sequence[Row]) -> str:
    """Shares of the outcomes, how many trials count, and how many do not."""
    counts = [_number(rows, outcome) for outcome in COUNTED]
    total = sum(counts)
    shares = " | ".join(f"{count / max(total, 1):.2f}" for count in counts)
    return f"{shares} | {total} | {len(rows) - total}"


def _means(rows: Sequence[Row]) -> str:
    """The share of dirt left, and the mean robot time."""
    done = [row for row in rows if _done(row)]
    share = sum(row["left"] for row in done) / max(1, sum(row["targets"] for row in done))
    return f"{share:.0%} | {np.mean([row['seconds'] for row in done] or [0.0]):.1f}"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeat", type=int, default=40, help="trials of each kind")
    parser.add_argument("--seed", type=int, default=1, help="of the first trial of each kind")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path, metavar="FILE", help="trials done before are in it")
    parser.add_argument("--part", choices=("actions", "path", "ink"), help="[default: all of them]")
    parser.add_argument("--action", choices=tuple(ARITIES), help="[default: all of them]")
    parser.add_argument("--grasp", choices=tuple(SHIPPED), nargs="+", help="[default: all of them]")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    repeat = 2 if options.quick else options.repeat
    run = Run(repeat, options.seed, options.jobs, Kept(options.keep))
    grasps = options.grasp or (("wide", "corner") if options.quick else tuple(SHIPPED))
    kinds = ("compact",) if options.quick else tuple(LAYOUTS)
    every = tuple(a for a in ARITIES if a not in (*WIPES, *TO_ZONE))
    names = ("moveToContainerFast", PICK_UP) if options.quick else every
    names = (options.action,) if options.action else names
    parts = {
        "actions": lambda: actions(run, names, kinds, grasps),
        "path": lambda: paths(run if options.quick else replace(run, repeat=3 * repeat), kinds),
        "ink": lambda: ink(run, grasps[:1] if options.quick else grasps),
    }
    show(parts, options.part)


def show(parts: Mapping[str, Callable[[], Iterator[str]]], asked: str | None) -> None:
    """Print the tables of one part, or of all, a line as soon as it is known."""
    for part in [asked] if asked else parts:
        for line in parts[part]():
            print(line, flush=True)
        print(flush=True)


if __name__ == "__main__":
    main()
