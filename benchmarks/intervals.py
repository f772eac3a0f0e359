"""How often intervals hold the probability: python benchmarks/intervals.py [--seed N] [--keep FILE] ...

Transitions are drawn from hidden rules as by benchmarks/learning.py: those of `cleaning`, and of
benchmarks/domains/coins.nid. Of every outcome of which something was learned, does the interval hold its
hidden probability? That should be so for 95 in 100, whatever the prior. `width`: of the intervals, in the
mean. `as if known`: the same for intervals that take every example for known to be one outcome's.

About two minutes of CPU for ten seeds. With --keep each seed is a line of FILE, and not drawn again.
`--quick` draws 60 transitions of one seed, in about five seconds.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
from kept import Kept, Row

from cleancli.language.model import Domain
from cleancli.learning.evidence import Evidence, collected, weights
from cleancli.learning.intervals import Interval, interval, intervals
from cleancli.learning.learn import learned_from
from cleancli.learning.match import Matcher
from cleancli.learning.method import DEFAULT
from learning import DRAW, draw, hidden

NUMBERS = (60, 300, 2000)
"""Transitions, of all rules together."""


def held(name: str, seed: int, numbers: list[int]) -> Row:
    """By the number of transitions: of how many outcomes something was learned, how many intervals hold the
    hidden probability, how many would that take examples for known, and the sum of the widths."""
    rng = np.random.default_rng([seed, 9])
    given = DRAW[name](rng)[0]
    truth = hidden(given, rng)
    drawn = [each.transition for each in islice(draw(name, truth, rng), numbers[-1])]
    matcher, found = Matcher(given), {}
    for number in numbers:
        evidence = collected(matcher, drawn[:number])
        rows = list(_outcomes(given, truth, evidence))
        found[str(number)] = [len(rows), *(float(sum(column)) for column in zip(*rows, strict=True))]
    return found


def _outcomes(given: Domain, truth: Domain, evidence: Evidence) -> Iterator[tuple[bool, bool, float]]:
    """Of each outcome: whether the interval holds, whether the other one would, and the width."""
    lesson = learned_from(given, evidence, DEFAULT)
    sure = intervals(given, weights(evidence, DEFAULT.forgetting), lesson)
    for learned in lesson.rules:
        if learned.rule is None:
            continue
        examples = float(sum(learned.seen))
        for outcome, seen, found in zip(
            truth.rules[learned.rule].outcomes, learned.seen, sure[learned.rule], strict=True
        ):
            chance = float(outcome.probability)
            yield _holds(found, chance), _holds(interval(float(seen), examples), chance), found[1] - found[0]


def _holds(found: Interval, chance: float) -> bool:
    return found[0] <= chance <= found[1]


def main() -> None:
    """Draw what is missing, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1, help="the first of the seeds")
    parser.add_argument("--seeds", type=int, default=10, help="how many")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="what was drawn before is in it")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    numbers = list(NUMBERS[:1] if options.quick else NUMBERS)
    seeds = range(options.seed, options.seed + (1 if options.quick else options.seeds))
    kept = Kept(options.keep)
    found = {(name, seed): _row(kept, name, seed, numbers) for name in DRAW for seed in seeds}
    print("| domain | transitions | outcomes | held | width | as if known |")
    print("|---|---|---|---|---|---|")
    for name in DRAW:
        for number in numbers:
            rows = np.array([found[name, seed][str(number)] for seed in seeds])
            outcomes, holds, others, width = rows.sum(axis=0)
            print(
                f"| {name} | {number} | {outcomes:.0f} | {holds / outcomes:.1%} | {width / outcomes:.2f}"
                f" | {others / outcomes:.1%} |"
            )


def _row(kept: Kept, name: str, seed: int, numbers: list[int]) -> Row:
    job = [name, seed, numbers]
    for row in kept.rows():
        if row["job"] == job:
            found: Row = row["found"]
            return found
    found = held(name, seed, numbers)
    kept.add({"job": job, "found": found})
    print(f"{name}, seed {seed}", flush=True)
    return found


if __name__ == "__main__":
    main()
