"""How fast PRADA plans: `python benchmarks/planning.py [samples]`, on one core, medians of 5 seeds.

The tasks are tables with dirty areas at random places, made from the rules of planning.nid. Two areas nearer
than 0.18 m are near, one within 4 cm of the line between two places lies between them.
"""

from __future__ import annotations

import itertools
import statistics
import sys
import time
from pathlib import Path

import numpy as np

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Fact, Object, Problem
from cleancli.planning.plan import Options
from cleancli.planning.prada import prada
from cleancli.planning.prepared import prepare

DOMAIN = load_domain(read_source(Path(__file__).with_suffix(".nid")))
SURFACE = np.array([0.60, 0.50])
CONTAINER = np.array([0.30, 0.55])
NEAR, STRIP = 0.18, 0.04
SEEDS = range(5)


def layout(areas: int, seed: int) -> Problem:
    """Dirty areas at random places, of random size and density, and what lies near and between them."""
    rng = np.random.default_rng([areas, seed])
    names = [f"a{index:02d}" for index in range(areas)]
    place = dict(zip(names, rng.random((areas, 2)) * SURFACE, strict=True))
    facts = {Fact("dirt", (name,)) for name in names}
    facts |= {Fact("size", (name,), str(rng.choice(["small", "medium", "big"]))) for name in names}
    facts |= {Fact("scattered", (name,)) for name in names if rng.random() < 0.5}
    facts |= {
        Fact("near", (a, b))
        for a, b in itertools.combinations(names, 2)
        if np.linalg.norm(place[a] - place[b]) < NEAR
    }
    place["bin"] = CONTAINER
    for a, end, m in itertools.product(names, place, names):
        if len({a, end, m}) == 3 and _lies_between(place[m], place[a], place[end]):
            aligned = Fact("aligned", (a,))
            if end == "bin" and aligned not in facts:
                facts |= {aligned, Fact("traversal", (a, end, m))}
            elif end != "bin":
                facts.add(Fact("traversal", (a, end, m)))
    return Problem(f"{areas} areas", DOMAIN.name, tuple(Object(n, "area") for n in names), frozenset(facts))


def _lies_between(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> bool:
    along = end - start
    share = float((point - start) @ along / (along @ along))
    return 0 < share < 1 and float(np.linalg.norm(start + share * along - point)) < STRIP


def _timed(areas: int, samples: int, seed: int) -> tuple[Task, float, float, float]:
    """The task, CPU seconds of grounding, seconds of the search, and the plan's value."""
    problem = layout(areas, 0)
    started = time.process_time()
    task = ground(DOMAIN, problem)
    grounding = time.process_time() - started
    plan = prada(prepare(task), Options(samples, seed))
    return task, grounding, plan.seconds["search"], plan.value


def main() -> None:
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    print(f"{samples} samples, horizon 1 + areas, medians of {len(SEEDS)} seeds")
    print("areas  actions  rules  ground s  search s  samples/s  value")
    prada(prepare(ground(DOMAIN, layout(2, 0))), Options(10))
    for areas in (2, 4, 6, 8, 10, 14, 20):
        runs = [_timed(areas, samples, seed) for seed in SEEDS]
        task = runs[0][0]
        grounding, search, value = (statistics.median(column) for column in list(zip(*runs, strict=True))[1:])
        print(
            f"{areas:5}  {len(task.actions):7}  {len(task.rules):5}  {grounding:8.4f}  {search:8.4f}"
            f"  {samples / search:9.0f}  {value:5.3f}"
        )


if __name__ == "__main__":
    main()
