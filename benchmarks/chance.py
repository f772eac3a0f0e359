"""Plans beside plans that think away chance, where it matters: python benchmarks/chance.py [--keep FILE] ...

Two layouts, each with a domain whose probabilities were measured there by `cleancli act`
(benchmarks/domains): on `wam_bow` the quick push of the WAM passes by a part of each group, on `rim` strokes
that come from the inside push dirt over the edge. `determinized` plans as if outcomes could be chosen,
`determinized:likeliest` as if always the likeliest came about. Prints moving time, and particles that are
left or lost on the floor; and, paired by seed, how much more that is than with the first strategy, with
intervals of Student's t and p-values of Wilcoxon's signed-rank test. Time is compared whether or not a run
ended clean.

About 20 minutes of CPU for 20 seeds of both layouts. With --keep every episode is a line of FILE as soon as
it is over; those that FILE holds are not run again. With `--stand-in` the fast stand-in takes the place of
the physics: `rim` only. `--quick` runs one seed of it so, in about ten seconds.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import mean

from kept import Kept
from strategies import Row, compared, interval, moving, rows

DOMAINS: Mapping[str, Path] = {
    scene: Path(__file__).parent / "domains" / f"{domain}.nid"
    for scene, domain in (("wam_bow", "bow"), ("rim", "rim"))
}
"""The domain that was measured on each scene."""

STRATEGIES = ("plan-2", "determinized", "determinized:likeliest")


def table(
    found: Mapping[tuple[str, int], Row], strategies: Sequence[str], seeds: Sequence[int]
) -> Iterator[str]:
    """Lines of a table, a row a strategy."""
    yield "| strategy | runs | moving | more | p | left or lost | more | p | actions | not clean |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    first = [found[strategies[0], seed] for seed in seeds]
    for strategy in strategies:
        own = [found[strategy, seed] for seed in seeds]
        moved, dirt = (beside(list(map(of, own)), list(map(of, first))) for of in (moving, _dirt))
        actions = f"{mean(row['actions'] for row in own):.1f}"
        dirty = sum(not row["clean"] for row in own)
        yield f"| {strategy} | {len(own)} | {moved} | {dirt} | {actions} | {dirty} |"


def beside(own: Sequence[float], first: Sequence[float]) -> str:
    """The mean; how much more it is than that of the first strategy, and how likely chance makes it so."""
    return f"{interval(own)} | {compared([a - b for a, b in zip(own, first, strict=True)])}"


def _dirt(row: Row) -> float:
    return float(row["left"] + row["lost"])


def main() -> None:
    """Run what is missing, and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scene", nargs="+", choices=list(DOMAINS), default=list(DOMAINS))
    parser.add_argument(
        "--strategy", nargs="+", default=list(STRATEGIES), help="each a name, or NAME:PLANNER"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the first episode of each strategy")
    parser.add_argument("--episodes", type=int, default=20, help="of each strategy")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path, metavar="FILE", help="episodes run before are in it")
    parser.add_argument("--stand-in", action="store_true", help="without physics: a few seconds an episode")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.scene, options.episodes, options.stand_in = ["rim"], 1, True
    seeds = range(options.seed, options.seed + options.episodes)
    for scene in options.scene:
        jobs = [(str(DOMAINS[scene]), scene, s, n) for n in seeds for s in options.strategy]
        found: dict[tuple[str, int], Row] = {}
        for row in rows(jobs, options.jobs, Kept(options.keep), options.stand_in):
            _, _, strategy, seed = row["job"]
            found[strategy, seed] = row
            told = f"{moving(row):.1f} s moving, {row['actions']} actions, {_dirt(row):.0f} left or lost"
            print(f"{len(found)} of {len(jobs)}: {scene} {strategy} {seed}: {told}", flush=True)
        print("", scene, "", *table(found, options.strategy, seeds), "", sep="\n", flush=True)


if __name__ == "__main__":
    main()
