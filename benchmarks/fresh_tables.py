"""Strategies on tables that nobody has chosen: python benchmarks/fresh_tables.py [--robot NAME] [--keep FILE]

Draws two groups of lentils (or `--groups N`) for each seed, anywhere that the robot's rag reaches for 5 cm
around, on the surface of the shipped scene for that robot: REEM picks up with its dustpan, the WAM and the
gantry push. On each table `cleancli execute` is carried out for every strategy, named DOMAIN/STRATEGY. Prints
what `strategies.py` prints. Every episode is a line of FILE as soon as it is over; those that FILE holds are
not run again.

About a minute of CPU for an episode of an arm: 40 minutes for each robot; with `--quick` (one table of the
gantry, two strategies) half a minute.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from kept import Kept
from strategies import domain_of, moving, run, table

from cleancli.array_types import Floats
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.scene.check import load_scene
from cleancli.scene.format import print_scene
from cleancli.scene.model import Group, Scene
from cleancli.world.reach_map import reach

SCENES: Mapping[str, str] = MappingProxyType(
    {"gantry": "two_groups", "wam": "wam_groups", "reem": "reem_pick_up"}
)
STRATEGIES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "gantry": ("sweeping/plan-2", "cleaning/plan-2", "cleaning/tsp", "cleaning/reactive"),
        "wam": ("sweeping/plan-2", "cleaning/plan-2", "cleaning/tsp", "cleaning/reactive"),
        "reem": ("sweeping/plan-2", "cleaning/plan-2", "cleaning/reactive"),
    }
)
COUNTS = (8, 16)
"""Lentils of a group, from and below."""
RADII = (0.02, 0.03)
APART = 0.10
"""Metres between the middles of groups, at least."""
AROUND = 0.05
"""Metres around the middle of a group that the rag reaches as well: it comes down behind what it pushes."""

Row = dict[str, Any]


def drawn(base: Scene, seed: int, number: int = 2) -> Scene:
    """The scene with a number of groups that the seed places."""
    rng, middles = np.random.default_rng(seed), _middles(base)
    groups: list[Group] = []
    while len(groups) < number:
        x, y = (float(value) for value in middles[rng.integers(len(middles))])
        if all(np.hypot(x - group.centre[0], y - group.centre[1]) >= APART for group in groups):
            groups.append(Group(int(rng.integers(*COUNTS)), (x, y), float(rng.uniform(*RADII))))
    return replace(base, dirt=tuple(groups))


def _middles(scene: Scene) -> Floats:
    """(n, 2) places around which the robot reaches everything."""
    places, able = reach(scene)
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 - AROUND
    missed = places[~able]
    gaps = np.linalg.norm(places[:, None] - missed[None], axis=2).min(axis=1, initial=np.inf)
    around: Floats = places[(np.abs(places) <= half).all(axis=1) & (gaps > AROUND)]
    return around


def episode(robot: str, name: str, groups: int, seed: int) -> Row:
    """What `strategies.py` tells of an episode of DOMAIN/STRATEGY on the table of a seed."""
    domain, strategy = domain_of(name, "cleaning")
    base = load_scene(read_source(find(SCENES[robot], "problems")))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fresh.nid"
        path.write_text(print_scene(drawn(base, seed, groups)), encoding="utf-8")
        return {**run((domain, str(path), strategy, seed)), "job": [robot, name, groups, seed]}


def rows(robot: str, names: Sequence[str], groups: int, seeds: Sequence[int], kept: Kept) -> Iterator[Row]:
    """The rows of all episodes; those that are not kept yet are run and kept."""
    known = {tuple(row["job"]): dict(row) for row in kept.rows()}
    for seed in seeds:
        for name in names:
            row = known.get((robot, name, groups, seed))
            if row is None:
                row = episode(robot, name, groups, seed)
                kept.add(row)
            yield row


def main() -> None:
    """Run what is missing, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--robot", choices=list(SCENES), default="reem")
    parser.add_argument("--strategy", nargs="+", metavar="DOMAIN/STRATEGY", help="the robot's own otherwise")
    parser.add_argument("--groups", type=int, default=2, help="on each table")
    parser.add_argument("--tables", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1, help="of the first table; others follow it")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="episodes run before are in it")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.robot, options.tables = "gantry", 1
        options.strategy = ["sweeping/plan-2", "cleaning/reactive"]
    names = options.strategy or STRATEGIES[options.robot]
    seeds = range(options.seed, options.seed + options.tables)
    found: list[Row] = []
    for row in rows(options.robot, names, options.groups, seeds, Kept(options.keep)):
        found.append(row)
        told = f"{row['actions']} actions, {row['left'] + row['lost']} left; {row['reason']}"
        print(f"{' '.join(map(str, row['job']))}: moving {moving(row):.1f} s, {told}", flush=True)
    print("", *table({name: [row for row in found if row["job"][1] == name] for name in names}), sep="\n")


if __name__ == "__main__":
    main()
