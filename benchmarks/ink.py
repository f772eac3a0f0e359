"""A board of ink, wiped and pushed at: python benchmarks/ink.py [--seeds N ...] [--keep FILE].

Carries out `cleancli execute` on the whiteboard with the domain `wiping_ink`, whose strokes wipe areas away
where they are, and with `cleaning`, whose pushes and joins are for lentils. Prints seconds of robot time,
with Student's t interval of 95 %, what share of those of `cleaning` they are, actions, and how much ink is
left. Every episode is a line of FILE as soon as it is over; those that FILE holds are not run again.

About 15 minutes of CPU; with `--quick` (one seed of `wiping_ink`) about a minute.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import mean

from kept import Kept
from strategies import Row, interval, moving, rows

DOMAINS = ("cleaning", "wiping_ink")
SCENE = "whiteboard"
SEEDS = (1, 2, 3, 4, 5)


def table(found: Sequence[Row]) -> Iterator[str]:
    """A row a domain; their time is that of all runs, and whether they ended clean is told."""
    yield "| domain | strategy | runs | not clean | actions | moving | of cleaning's | ink left | at most |"
    yield "|---" * 9 + "|"
    kinds = sorted({(row["job"][0], row["job"][2]) for row in found})
    for domain, strategy in kinds:
        own = [row for row in found if (row["job"][0], row["job"][2]) == (domain, strategy)]
        base = [row for row in found if (row["job"][0], row["job"][2]) == ("cleaning", strategy)]
        took = mean(map(moving, own))
        share = f"{took / mean(map(moving, base)):.2f}" if base else ""
        left = [row["ink_left"] for row in own]
        yield (
            f"| {domain} | {strategy} | {len(own)} | {sum(not row['clean'] for row in own)}"
            f" | {interval([row['actions'] for row in own])} | {interval(list(map(moving, own)))} | {share}"
            f" | {mean(left):.1%} | {max(left):.1%} |"
        )


def main() -> None:
    """Run what is missing, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--domain", nargs="+", default=DOMAINS)
    parser.add_argument("--strategy", nargs="+", default=("plan-2",))
    parser.add_argument("--seeds", "--seed", nargs="+", type=int, default=SEEDS)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path, metavar="FILE", help="episodes run before are in it")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.domain, options.seeds = ["wiping_ink"], [1]
    jobs = [(d, SCENE, s, n) for n in options.seeds for d in options.domain for s in options.strategy]
    found = []
    for row in rows(jobs, options.jobs, Kept(options.keep)):
        found.append(row)
        print(
            f"{len(found)} of {len(jobs)}: {' '.join(map(str, row['job']))}: moving {moving(row):.1f} s,"
            f" {row['actions']} actions, {row['ink_left']:.1%} of the ink left; {row['reason']}",
            flush=True,
        )
    print("", *table(found), sep="\n")


if __name__ == "__main__":
    main()
