"""Blocks pushed into a zone: python benchmarks/piles.py [--seed N] [--episodes N] [--keep FILE]

The sweeping task of Zeng et al. (2020), Transporter Networks, on the table of `problems/piles.nid`: fifty
blocks in a square of 20 cm in the middle, a square zone of 12 cm that each seed places and turns anywhere
beside them in the middle 100 x 50 cm, at most 20 pushes. The score of an episode is the share of the blocks
that truly lie in the zone at its end. Prints a line an episode, and then the mean score and the pushes used,
with Student's t intervals of 95 %, and in how many episodes all blocks came into the zone. Every episode is a
line of FILE as soon as it is over; those that FILE holds are not run again. `--picture` draws the table
before and after the first episode, which is then run again.

About half a minute of CPU an episode, 25 minutes for all fifty; with `--quick`, one episode of three pushes,
a few seconds.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import hypot, pi
from pathlib import Path
from typing import Any

import numpy as np
from episodes import carried_out, on_table
from kept import Kept
from strategies import interval

from cleancli.array_types import Floats
from cleancli.execution.events import Ended
from cleancli.execution.setup import EpisodeOptions, discounts_time
from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.recording.pictures import write_png
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene, Zone
from cleancli.world.table import PybulletTable

WORKSPACE = 1.00, 0.50
"""Metres in the middle of the table where the zone may lie."""

PILE = 0.10
"""Metres from the middle to which blocks lie, along x and along y."""

MOST_PUSHES = 20

SIZE = 480, 360
"""Pixels of a picture."""

Row = dict[str, Any]


def drawn(base: Scene, seed: int) -> Scene:
    """The scene with a zone that the seed places where no block lies."""
    assert base.zone is not None
    rng = np.random.default_rng(seed)
    around = hypot(base.zone.side, base.zone.side) / 2
    half = np.array(WORKSPACE) / 2 - around
    while True:
        place: Floats = rng.uniform(-half, half)
        if np.abs(place).max() > PILE + around:
            centre = round(float(place[0]), 4), round(float(place[1]), 4)
            zone = Zone(centre, base.zone.side, round(float(rng.uniform(0, 2 * pi)), 4))
            return replace(base, zone=zone)


def episode(strategy: str, seed: int, pushes: int, picture: Path | None = None) -> Row:
    """One episode with the table of a seed, perhaps drawn: its score, and what it took."""
    domain = load_domain(read_source(find("piles", "domains")))
    scene = drawn(load_scene(read_source(find("piles", "problems"))), seed)
    options = EpisodeOptions(strategy=strategy, seed=seed, max_actions=pushes, by_time=discounts_time(domain))
    with on_table(domain, scene, options, stand_in=False) as opened:
        table = opened[2]
        assert isinstance(table, PybulletTable)
        before = table.picture(*SIZE)
        ended = next(event for event in carried_out(opened) if isinstance(event, Ended))
        truth = table.truth()
        if picture is not None:
            write_png(picture, np.hstack((before, table.picture(*SIZE))))
    return {
        "job": [strategy, seed, pushes],
        "score": (truth.in_zone or 0) / truth.total,
        "pushes": ended.actions,
        "clean": ended.clean,
        "lost": truth.on_floor + truth.in_container,
        "seconds": ended.spent.by_kind(),
    }


def rows(strategy: str, seeds: Sequence[int], pushes: int, kept: Kept) -> Iterator[Row]:
    """The rows of all seeds; those that are not kept yet are run and kept."""
    known = {tuple(row["job"]): dict(row) for row in kept.rows()}
    for seed in seeds:
        row = known.get((strategy, seed, pushes))
        if row is None:
            row = episode(strategy, seed, pushes)
            kept.add(row)
        yield row


def main() -> list[Row]:
    """Run what is missing, and print scores."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--strategy", default="plan-2")
    parser.add_argument("--episodes", type=int, default=50)
    parser.add_argument("--seed", type=int, default=101, help="of the first episode; others follow it")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="episodes run before are in it")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="PNG of the table before and after")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    episodes, pushes = (1, 3) if options.quick else (options.episodes, MOST_PUSHES)
    if options.picture is not None:
        episode(options.strategy, options.seed, pushes, options.picture)
    found = []
    for row in rows(
        options.strategy, range(options.seed, options.seed + episodes), pushes, Kept(options.keep)
    ):
        found.append(row)
        told = "clean" if row["clean"] else "not clean"
        print(f"seed {row['job'][1]}: {row['score']:.2f} in {row['pushes']} pushes, {told}", flush=True)
    full = sum(row["score"] == 1 for row in found)
    print(f"score {interval([100 * row['score'] for row in found])} %", end="; ")
    print(f"pushes {interval([row['pushes'] for row in found])}; all blocks in {full} of {len(found)}")
    return found


if __name__ == "__main__":
    main()
