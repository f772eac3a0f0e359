"""How well durations are known after a few executions: python benchmarks/learned_durations.py [--tables N]

On the fast stand-in, on tables with forty scattered lentils, each area is pushed to the container once, fast
and straight, with the ways and the errors of real motions. So many executions are drawn from all of them,
two thousand times, and what is learned from them is compared with the mean over all tables: the duration of a
domain's text, whose prior is half of that or half as much again; and the correction of what the table
expects, of a robot that is as quick as expected or takes twice as long. Beside it stand the mean of those
that were drawn, which no learner betters, and by how much the learned duration misses that mean. Shown are
the median and the 95th percentile of what that is off.

About half a minute of CPU. `--quick` has two tables.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from instances import Rng

from cleancli.compiler.task import GroundAction
from cleancli.execution.episode_state import Move
from cleancli.execution.kinematic_cell import KinematicCell
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.workcell import Motion, Motions
from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.learning.durations import PRIOR_WEIGHT, learn_corrections
from cleancli.learning.estimate import decreasing_m_estimate
from cleancli.learning.experience import milliseconds
from cleancli.scene.check import load_scene
from cleancli.world.kinematic import KinematicTable

ACTIONS = ("moveToContainerFast", "moveToContainerStraight")
EXECUTIONS = (3, 12)
DRAWS = 2000
PRIORS = {"half": 0.5, "half as much again": 1.5}
ROBOTS = {"as expected": 1, "twice as long": 2}

Pair = tuple[int, int]
"""Milliseconds that a push took, and those that were expected."""


def pushes(action: str, seed: int) -> Iterator[Pair]:
    """A push of each area of a table in turn, as the first look sees them."""
    domain = load_domain(read_source(find("cleaning", "domains")))
    scene = load_scene(read_source(find("scattered_40", "problems")))
    cell = KinematicCell(domain, scene, KinematicTable(scene, derived(seed, Stream.WORLD)))
    _finished(cell.withdraw())
    situation = cell.look(None, None, 0, 0).situation
    for number, area in enumerate(situation.areas, start=1):
        move = Move(action, (area.name,))
        (expected,) = cell.seconds(situation, [GroundAction(*move.key, None)]).values()
        motions = _finished(cell.carry_out(number, move, cell.path(move, situation)))
        yield milliseconds(motions.transit, motions.seconds), round(1000 * expected)


def _finished(motion: Motion) -> Motions:
    while True:
        try:
            next(motion)
        except StopIteration as ended:
            found: Motions = ended.value
            return found


def learned(found: Sequence[Pair], number: int, prior: float, rng: Rng) -> Iterator[tuple[float, float]]:
    """What is learned from so many executions with a prior that is such a part of the mean of all, and their
    own mean, both as parts of the mean of all."""
    took = np.array([pair[0] for pair in found], dtype=float)
    took /= took.mean()
    for _ in range(DRAWS):
        drawn = rng.choice(took, number, replace=False)
        yield decreasing_m_estimate(float(drawn.sum()), number, prior, PRIOR_WEIGHT), float(drawn.mean())


def durations_off(found: Sequence[Pair], number: int, prior: float, rng: Rng) -> Iterator[float]:
    """By which share of it the mean of all is missed."""
    return (abs(duration - 1) for duration, _ in learned(found, number, prior, rng))


def beside_means(found: Sequence[Pair], number: int, prior: float, rng: Rng) -> Iterator[float]:
    """By which share of it the mean of the same executions is missed: what the prior alone does."""
    return (abs(duration / own - 1) for duration, own in learned(found, number, prior, rng))


def means_off(found: Sequence[Pair], number: int, prior: float, rng: Rng) -> Iterator[float]:
    """By which share of it the mean of all is missed by the mean of so many, whatever the prior is."""
    return (abs(own - 1) for _, own in learned(found, number, prior, rng))


def corrections_off(found: Sequence[Pair], number: int, slower: int, rng: Rng) -> Iterator[float]:
    """The same of the mean ratio, of a robot that takes so many times as long."""
    pairs = [(slower * took, expected) for took, expected in found]
    mean = float(np.mean([took / expected for took, expected in pairs]))
    for _ in range(DRAWS):
        drawn = tuple(pairs[index] for index in rng.choice(len(pairs), number, replace=False))
        (correction,) = learn_corrections((("push", drawn),))
        yield abs(correction.factor / mean - 1)


def rows(found: dict[str, list[Pair]], rng: Rng) -> Iterator[str]:
    """A row of the table for each action, and each prior or robot."""
    kinds: tuple[tuple[str, Callable[..., Iterator[float]], dict[str, float] | dict[str, int]], ...] = (
        ("mean of these", means_off, {"itself": 1.0}),
        ("duration, prior", durations_off, PRIORS),
        ("the same beside the mean of these, prior", beside_means, PRIORS),
        ("correction, robot takes", corrections_off, ROBOTS),
    )
    for action, pairs in found.items():
        for what, off, cases in kinds:
            for case, value in cases.items():
                cells = (_shares(list(off(pairs, number, value, rng))) for number in EXECUTIONS)
                yield f"| {action} | {len(pairs)} | {what} {case} | {' | '.join(cells)} |"


def _shares(off: Sequence[float]) -> str:
    return f"{np.median(off):.1%}, {np.quantile(off, 0.95):.1%}"


def main() -> None:
    """Push, draw, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tables", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1, help="of the first table, and of the draws")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    tables = range(options.seed, options.seed + (2 if options.quick else options.tables))
    found = {action: [pair for seed in tables for pair in pushes(action, seed)] for action in ACTIONS}
    heads = " | ".join(f"off after {number}: median, 95 %" for number in EXECUTIONS)
    print(f"| action | executions | learned | {heads} |\n|---|---|---|---|---|")
    print(*rows(found, np.random.default_rng(options.seed)), sep="\n")


if __name__ == "__main__":
    main()
