"""The fast stand-in beside the physics: python benchmarks/stand_in.py [--keep FOLDER] [--part NAME] ...

Tries the same in both worlds, with the same seeds, and prints how much they differ:

- height: a push of sixteen spread lentils at fixed heights, from near and from far: what share of them comes
  into the container, and which `SLIPS` and `SLIPS_SPREAD` of world/kinematic.py make that likeliest;
- turn: a stroke that turns on its way: what share lies before the cloth at its end;
- episodes: strategies on forty scattered lentils: moving time, paired by seed.

About 15 minutes of CPU for heights and turns, and 35 for episodes. With --keep every trial and episode is
written into FOLDER as soon as it is over; those that are there already are not run again. Trials and episodes
have the seeds N, N + 1 and so on. `--quick` tries very little, in about a minute.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from math import cos, hypot, radians, sin
from pathlib import Path

import numpy as np
from kept import Kept, Row
from physics import BASE, Run, show
from scipy.optimize import minimize
from scipy.stats import norm
from strategies import interval, moving, rows

from cleancli.array_types import Floats
from cleancli.motion.actions import path_along
from cleancli.motion.pace import FAST_SPEED
from cleancli.motion.path import ToolPath, pressed
from cleancli.scene.model import Scattered, Scene
from cleancli.world.kinematic import SLIPS, SLIPS_SPREAD, KinematicTable
from cleancli.world.rag import edge_heights
from cleancli.world.robot import finish
from cleancli.world.table import PybulletTable, Truth, stroke_error

PHYSICS, STAND_IN = "physics", "stand-in"
LENTILS = 16
HALF = 0.04
"""Half the side of the square in which lentils lie, metres: four of the cloth's six flaps pass over it."""

HEIGHTS = (-3.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0)
"""Of the tool above the surface, millimetres."""

BEGINS = {"near": 0.30, "far": -0.20}
"""Middles of the squares: 15 and 65 cm before the edge of the table, metres."""

TURNS = (0, 30, 60, 90)
"""Degrees by which a stroke turns after 25 cm, before it goes on for 20."""

KEPT_WITHIN = 0.08
"""Metres from the tool within which a lentil lies before the cloth."""

STRATEGIES = (("sweeping", "plan-2"), ("cleaning", "tsp"), ("cleaning", "wipe"), ("cleaning", "reactive"))
"""Domains and strategies of the episodes."""


def square(x: float) -> Scene:
    """Lentils that are spread around (x, 0), so that none lies on another."""
    return replace(BASE, dirt=(Scattered(LENTILS, (x - HALF, -HALF), (x + HALF, HALF)),))


def after(world: str, scene: Scene, seed: int, path: ToolPath, height: float) -> tuple[Truth, float, float]:
    """What is where when the path was followed at this height in metres, whatever the error of the stroke
    would have been; and where the tool is then."""
    error = float(stroke_error(path, np.random.default_rng(seed).spawn(4)[2], scene.height_noise)[2])
    fixed = pressed(path, error - height)
    if world == STAND_IN:
        stand_in = KinematicTable(scene, seed)
        stand_in.start(fixed)
        finish(stand_in)
        return stand_in.truth(), *stand_in.tool[:2]
    with closing(PybulletTable(scene, seed)) as table:
        table.start(fixed)
        finish(table)
        return table.truth(), *table.tool[:2]


def taken(world: str, height: float, begin: str, seed: int) -> Row:
    """How many lentils one push at this height, in millimetres, brings into the container."""
    scene = square(BEGINS[begin])
    ends = (BEGINS[begin] - HALF - 0.01, 0.0), (scene.surface.width / 2 + 0.05, 0.0)
    path = path_along(ends, scene, FAST_SPEED)
    truth, _, _ = after(world, scene, seed, path, 1e-3 * height)
    return {"taken": truth.in_container}


def turned(world: str, turn: int, seed: int) -> Row:
    """How many lentils lie before the cloth at the end of a pressed stroke that turns."""
    corner, angle = (0.0, 0.0), radians(turn)
    scene = square(-0.20)
    path = path_along(((-0.25, 0.0), corner, (0.20 * cos(angle), 0.20 * sin(angle))), scene, FAST_SPEED)
    truth, x, y = after(world, scene, seed, path, -2e-3)
    return {"taken": sum(hypot(a - x, b - y) <= KEPT_WITHIN for a, b, _ in truth.left)}


def heights(run: Run) -> Iterator[str]:
    """Shares taken by height, and the likeliest numbers of the stand-in."""
    found: list[Row] = []
    yield "| height | physics, near | stand-in | physics, far | stand-in |\n|---|---|---|---|---|"
    for height in HEIGHTS:
        cells = []
        for begin in BEGINS:
            for world in (PHYSICS, STAND_IN):
                what = {"part": "height", "world": world, "height": f"{height:g}", "begin": begin}
                tried = run.rows(what, partial(taken, world, height, begin))
                found += tried if world == PHYSICS else []
                cells.append(f"{_share(tried):.0%}")
        yield f"| {height:g} mm | {' | '.join(cells)} |"
    slips, spread = likeliest(found)
    yield f"\nlikeliest: SLIPS {1e3 * slips:.2f} mm, SLIPS_SPREAD {1e3 * spread:.2f} mm"


def likeliest(found: Sequence[Row]) -> tuple[float, float]:
    """`SLIPS` and `SLIPS_SPREAD`, in metres, under which what was found is likeliest: each lentil meets any
    of the four flaps in the middle."""
    edges = {row["seed"]: _middle_edges(row["seed"]) for row in found}

    def unlikeliness(numbers: Floats) -> float:
        slips, spread = np.exp(numbers)
        total = 0.0
        for row in found:
            over = (float(row["height"]) + 1e3 * edges[row["seed"]] - slips) / spread
            share = float(np.clip(norm.cdf(-over).mean(), 1e-3, 1 - 1e-3))
            total -= row["taken"] * np.log(share) + (LENTILS - row["taken"]) * np.log(1 - share)
        return total

    best = minimize(unlikeliness, np.log((1e3 * SLIPS, 1e3 * SLIPS_SPREAD)), method="Nelder-Mead")
    slips, spread = 1e-3 * np.exp(best.x)
    return float(slips), float(spread)


def _middle_edges(seed: int) -> Floats:
    return edge_heights(BASE.rag, np.random.default_rng(seed).spawn(4)[1])[1:-1]


def turns(run: Run) -> Iterator[str]:
    """Shares that are still before the cloth, by how far a stroke turns."""
    yield "| turn | physics | stand-in |\n|---|---|---|"
    for turn in TURNS:
        cells = []
        for world in (PHYSICS, STAND_IN):
            what = {"part": "turn", "world": world, "turn": str(turn)}
            cells.append(f"{_share(run.rows(what, partial(turned, world, turn))):.0%}")
        yield f"| {turn}° | {' | '.join(cells)} |"


def _share(tried: Sequence[Row]) -> float:
    return sum(int(row["taken"]) for row in tried) / (LENTILS * len(tried))


def episodes(
    seeds: Sequence[int], scene: str, strategies: Sequence[tuple[str, str]], keep: Kept
) -> Iterator[str]:
    """Moving time in both worlds, and how much longer the physics takes, over pairs clean in both."""
    yield "| domain | strategy | pairs | physics | stand-in | difference | actions | actions | left | left |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for domain, strategy in strategies:
        jobs = [(domain, scene, strategy, seed) for seed in seeds]
        ours, theirs = (
            {tuple(row["job"]): row for row in rows(jobs, 1, keep, here)} for here in (True, False)
        )
        pairs = [(theirs[job], ours[job]) for job in jobs if theirs[job]["clean"] and ours[job]["clean"]]
        yield f"| {domain} | {strategy} | {len(pairs)} of {len(jobs)} | {_compared(pairs)} |"


def _compared(pairs: Sequence[tuple[Row, Row]]) -> str:
    times = np.array([[moving(dict(row)) for row in pair] for pair in pairs]).reshape(-1, 2)
    told = [interval(column.tolist()) for column in (*times.T, times[:, 0] - times[:, 1])]
    actions = [f"{np.mean([pair[k]['actions'] for pair in pairs]):.1f}" for k in (0, 1)]
    left = [str(sum(pair[k]["left"] + pair[k]["lost"] for pair in pairs)) for k in (0, 1)]
    return " | ".join((*told, *actions, *left))


def main() -> None:
    """Print the tables, a row as soon as it is known."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeat", type=int, default=12, help="trials of each kind")
    parser.add_argument("--episodes", type=int, default=8, help="of each strategy")
    parser.add_argument("--seed", type=int, default=1, help="of the first trial and the first episode")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="what was run before is in it")
    parser.add_argument("--part", choices=("height", "turn", "episodes"), help="[default: all of them]")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.keep:
        options.keep.mkdir(parents=True, exist_ok=True)
    trials, whole = (Kept(options.keep and options.keep / f"{n}.jsonl") for n in ("trials", "episodes"))
    run = Run(1 if options.quick else options.repeat, options.seed, 1, trials)
    seeds = range(options.seed, options.seed + (2 if options.quick else options.episodes))
    scene, strategies = ("two_groups", STRATEGIES[-1:]) if options.quick else ("scattered_40", STRATEGIES)
    parts = {
        "height": lambda: heights(run),
        "turn": lambda: turns(run),
        "episodes": lambda: episodes(seeds, scene, strategies, whole),
    }
    show(parts, options.part)


if __name__ == "__main__":
    main()
