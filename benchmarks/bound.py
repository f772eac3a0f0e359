"""How far strategies are from the best: python benchmarks/bound.py [--seeds N ...] [--episodes FILE] ...

For each table it prints the seconds that a robot needs that knows where all particles truly lie and never
fails, with three kinds of strokes:

- nearest: pushes that end at the nearest place of the mouth, as the skill makes them on an empty table;
- free: these, and straight pushes with any aim;
- bending: these, and strokes that bend up to three times on their way into the container (`--bends`).

Which strokes of the first two kinds are best is an integer program's answer: a set cover over all corridors
that differ in what they take. `least` is what it has proven, in the seconds that plans expect of strokes: no
choice of such strokes takes less, but for what an aim between two that were tried could save (hundredths of a
second). Bending strokes are found by annealing and chosen by the same program: the best known, not the best.
`carried out` is how long the chosen strokes take one after another on the fast stand-in without errors, which
is a bit more than plans expect; they clean the table. `in the physics` is how long the bending ones take on
the simulated table itself, without errors, and what they leave there. Left out are strokes that end on the
table.

With `--episodes`, rows of `benchmarks/strategies.py --keep`, it then prints for each strategy by how much its
moving time (transits and strokes) exceeds that of the bending strokes carried out. The same strategy plays
the same table on the stand-in, each time with less that makes it hard, and the differences add up to the
whole:

- beyond: the episode less the stand-in's own: heaps, friction, errors of pictures, and other luck;
- failure: the stand-in's own less one in which no stroke has an error;
- hiding: that one less one whose looks see also what the tool hides, so that areas are made of all true
  places: perception, but for its errors in pictures, which are beyond;
- planning: the last one less the bound: what areas as ellipses, the domain's actions and the planner cost.

One episode stands for each, so a table's own parts are mostly luck, and only means over many tables tell. A
table on which one of the episodes did not end clean is left out of the means. Tables must have a gantry and
no ink. About half a minute of CPU a table, and 10 s for each episode; with `--quick` (two groups) 10 s.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bound_replay import VARIANTS, carried_out, carried_out_in_physics, episode, is_sound, layout_of
from bound_search import Annealing, Cover, quickest
from bound_strokes import Layout, Stroke, nearest_pushes, straight_pushes, undominated
from episodes import Job
from kept import Kept
from strategies import Row, interval, moving

from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.scene.check import load_scene

ROUNDS = 4
"""How often annealing begins anew at what the integer program chose."""

PARTS = ("beyond", "failure", "hiding", "planning")


def bound(layout: Layout, bends: int, steps: int) -> Row:
    """Of one table what each kind of strokes needs."""
    nearest = list(nearest_pushes(layout))
    free = [*nearest, *straight_pushes(layout)]
    covers = {"nearest": clean_cover(nearest, layout), "free": clean_cover(free, layout)}
    covers["bending"] = bending(covers["free"], free, layout, bends, steps)
    return {kind: _told(cover, layout) for kind, cover in covers.items()}


def bending(cover: Cover, straight: Sequence[Stroke], layout: Layout, bends: int, steps: int) -> Cover:
    """Strokes that may bend, by annealing in rounds of so many steps, from straight ones on."""
    annealing = Annealing(layout, straight, bends, np.random.default_rng(layout.seed))
    for _ in range(ROUNDS if layout.places.size else 0):
        annealing.run(cover.strokes, steps)
        cover = clean_cover([*straight, *annealing.seen], layout)
    return cover


def clean_cover(strokes: Iterable[Stroke], layout: Layout) -> Cover:
    """The quickest of the strokes that truly clean the table on the stand-in: those that lose something at a
    bend are left out, and others chosen, until nothing is left over."""
    offered = list(strokes)
    while True:
        cover = quickest(undominated(offered), len(layout.places))
        left = carried_out(cover.strokes, layout)[1]
        unsound = {one.corners for one in cover.strokes if left and not is_sound(one, layout)}
        if not unsound:
            return cover
        offered = [one for one in offered if one.corners not in unsound]


def _told(cover: Cover, layout: Layout) -> Row:
    seconds, left = carried_out(cover.strokes, layout)
    strokes = [one.corners for one in cover.strokes]
    return {"least": cover.least, "seconds": seconds, "left": left, "strokes": strokes}


def bounds(tables: Iterable[tuple[str, int]], bends: int, steps: int, kept: Kept) -> Iterator[Row]:
    """The rows of all tables; those that are kept are not made again."""
    known = {tuple(row["table"]): dict(row) for row in kept.rows() if "table" in row}
    for scene, seed in tables:
        row = known.get((scene, seed, bends, steps))
        if row is None:
            layout = layout_of(load_scene(read_source(find(scene, "problems"))), seed)
            row = {"table": [scene, seed, bends, steps], **bound(layout, bends, steps)}
            kept.add(row)
        yield row


def with_physics(found: Iterable[Row], kept: Kept) -> Iterator[Row]:
    """The rows of tables, with what their bending strokes come to on the simulated table."""
    known = {tuple(row["physics"]): dict(row) for row in kept.rows() if "physics" in row}
    for row in found:
        scene, seed, *_ = row["table"]
        told = known.get(tuple(row["table"]))
        if told is None:
            place, strokes = load_scene(read_source(find(scene, "problems"))), row["bending"]["strokes"]
            corners = [[(x, y) for x, y in stroke] for stroke in strokes]
            seconds, left = carried_out_in_physics(corners, place, seed)
            told = {"physics": row["table"], "seconds": seconds, "left": left}
            kept.add(told)
        yield {**row, "in_physics": told}


def variants(jobs: Iterable[Job], kept: Kept) -> Iterator[Row]:
    """The episodes of each job on the stand-in, one for each variant; those kept are not played again."""
    known = {(*row["job"], row["variant"]): dict(row) for row in kept.rows() if "variant" in row}
    for job in jobs:
        for variant in VARIANTS:
            row = known.get((*job, variant))
            if row is None:
                row = {**episode(job, variant), "variant": variant}
                kept.add(row)
            yield row


def parts(moving: float, played: Sequence[float], least: float) -> dict[str, float]:
    """How an episode's moving time differs from the bound, by what makes it longer; `played` are the moving
    times of the variants."""
    steps = (moving, *played, least)
    return {part: more - less for part, more, less in zip(PARTS, steps[:-1], steps[1:], strict=True)}


def bound_lines(found: Sequence[Row]) -> Iterator[str]:
    """A table of the bounds, a row a table."""
    kinds = ("nearest: least", "carried out", "free: least", "carried out", "bending: carried out")
    yield f"| table | {' | '.join(kinds)} | strokes | in the physics | left there |"
    yield "|---" * (4 + len(kinds)) + "|"
    for row in found:
        near, free, bent, there = (row[kind] for kind in ("nearest", "free", "bending", "in_physics"))
        name = f"{row['table'][0]}, {row['table'][1]}"
        yield (
            f"| {name} | {near['least']:.1f} | {near['seconds']:.1f} | {free['least']:.1f}"
            f" | {free['seconds']:.1f} | {bent['seconds']:.1f} | {len(bent['strokes'])}"
            f" | {there['seconds']:.1f} | {there['left']} |"
        )


def gap_lines(episodes: Sequence[Row], played: Sequence[Row], found: Sequence[Row]) -> Iterator[str]:
    """A table of the gaps: a row an episode, and one for the means of each strategy."""
    yield "| domain, strategy | table | moving | bound | " + " | ".join(PARTS) + " |"
    yield "|---" * (4 + len(PARTS)) + "|"
    best = {tuple(row["table"][:2]): float(row["bending"]["seconds"]) for row in found}
    gaps: dict[str, list[Mapping[str, float]]] = {}
    for row in episodes:
        domain, scene, strategy, seed = row["job"]
        own = [other for other in played if other["job"] == row["job"]]
        name, least = f"{domain}, {strategy}", best[scene, seed]
        if not all(one["clean"] for one in (row, *own)):
            yield f"| {name} | {scene}, {seed} | not clean |" + " |" * (1 + len(PARTS))
            continue
        gap = parts(moving(row), [moving(one) for one in own], least)
        gaps.setdefault(f"{name} | {scene}", []).append({"moving": moving(row), "bound": least, **gap})
        yield f"| {name} | {scene}, {seed} | {moving(row):.1f} | {least:.1f} | {_cells(gap)} |"
    for title, some in gaps.items():
        columns = (interval([gap[column] for gap in some]) for column in ("moving", "bound", *PARTS))
        yield f"| {title}, {len(some)} | " + " | ".join(columns) + " |"


def _cells(gap: Mapping[str, float]) -> str:
    return " | ".join(f"{gap[part]:.1f}" for part in PARTS)


def main() -> None:
    """Print the bounds, and the gaps of the episodes given."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scene", nargs="+", default=["scattered_40"])
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3])
    parser.add_argument("--bends", type=int, default=3, help="of a stroke, at most")
    parser.add_argument("--steps", type=int, default=5000, help=f"of annealing, in each of {ROUNDS} rounds")
    parser.add_argument("--episodes", type=Path, metavar="FILE", help="rows that strategies.py has kept")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="what was found before is in it")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.scene, options.seeds, options.steps = ["two_groups"], [1], 500
    tables = [(scene, seed) for scene in options.scene for seed in options.seeds]
    kept, found = Kept(options.keep), []
    for row in with_physics(bounds(tables, options.bends, options.steps, kept), kept):
        found.append(row)
        print(f"{len(found)} of {len(tables)}: {row['bending']['seconds']:.1f} s", flush=True)
    print("", *bound_lines(found), sep="\n")
    if options.episodes is None:
        return
    episodes = [dict(row) for row in Kept(options.episodes).rows() if "variant" not in row]
    episodes = [row for row in episodes if (row["job"][1], row["job"][3]) in set(tables)]
    print(flush=True)
    played: list[Any] = []
    for row in variants([tuple(row["job"]) for row in episodes], kept):
        played.append(row)
        print(
            f"{len(played)} of {len(episodes) * len(VARIANTS)}: {' '.join(map(str, row['job']))},"
            f" {row['variant']}: {moving(row):.1f} s, {row['left']} left",
            flush=True,
        )
    print("", *gap_lines(episodes, played, found), sep="\n")


if __name__ == "__main__":
    main()
