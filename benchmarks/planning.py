"""How fast PRADA plans: `python benchmarks/planning.py [--samples N] [--seed N] [--areas N ...]`.

Medians of 7 seeds; a row as soon as it is known. About two minutes of CPU.

The tasks are tables with dirty areas at random places, made from the rules of planning.nid. Two areas nearer
than 0.18 m are near, one within 4 cm of the line between two places lies between them. The folder libprada
has states of libPRADA's for the same rules; what it needs for them on one core is in `LIBPRADA`.

Compared with: the slow reference of the tests, which values drawn sequences and does not even draw them; and
the multiply-adds that samples need, at one a cycle, if nothing else took time: those of the rules of the
actions that are done, up to where a sample that knows the best value gives up.
"""

from __future__ import annotations

import argparse
import itertools
import os
import re
import statistics
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cleancli.compiler.ground import ground
from cleancli.compiler.lowering.belief_tables import Tables, lower
from cleancli.compiler.task import Task
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Fact, Object, Problem
from cleancli.planning.compiled_task import prepare
from cleancli.planning.kernels import belief as kernel
from cleancli.planning.kernels import belief_search
from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from support import reference_prada

DOMAIN = load_domain(read_source(Path(__file__).with_suffix(".nid")))
PRADA = PLANNERS["prada"]
SURFACE = np.array([0.60, 0.50])
CONTAINER = np.array([0.30, 0.55])
NEAR, STRIP = 0.18, 0.04
SEEDS = range(7)
AREAS = (2, 4, 6, 8, 10, 14, 20)
LIBPRADA = {2: 0.115, 4: 0.304, 6: 0.711, 8: 1.40, 10: 2.66, 14: 7.54}
"""User seconds for 10,000 samples on one core, its fastest build, static literals removed by hand."""
STATES = Path(__file__).parent / "libprada"
COUNTED = 300
"""Samples whose arithmetic is counted."""


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


def peers() -> Iterator[tuple[int, Problem]]:
    """The tables of libPRADA's files; their rules are those of planning.nid under other names."""
    for areas in LIBPRADA:
        text = (STATES / f"d{areas}.state.dat").read_text()
        atoms = [(m[1], m[2].split()) for m in re.finditer(r"(\w+)\(([^)]*)\)", text)]
        (container,) = (terms[0] for name, terms in atoms if name == "container")
        facts = set()
        for name, terms in atoms:
            places = tuple("bin" if term == container else f"a{term}" for term in terms)
            if name.endswith("Size"):
                facts.add(Fact("size", places, name.removesuffix("Size")))
            elif name == "near":
                facts.add(Fact("near", tuple(sorted(places))))
            elif name != "container":
                facts.add(Fact(name, places))
        objects = tuple(sorted(fact.objects[0] for fact in facts if fact.symbol == "dirt"))
        areas_of = tuple(Object(name, "area") for name in objects)
        yield areas, Problem(f"d{areas}", DOMAIN.name, areas_of, frozenset(facts))


@dataclass(frozen=True, slots=True)
class Figures:
    """Of one task; times in seconds, of all samples; all but that on two cores is CPU time, as libPRADA's
    are."""

    task: Task
    grounding: float
    lowering: float
    one_core: float
    two_cores: float
    value: float
    reference: float
    floor: float


def measured(problem: Problem, samples: int) -> Figures:
    started = time.process_time()
    task = ground(DOMAIN, problem)
    grounded = time.process_time()
    tables = lower(task)
    lowered = time.process_time()
    prepared = prepare(task)
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    busy, plans = [], []
    for seed in SEEDS:
        before = time.process_time()
        plans.append(PRADA(prepared, Options(samples, seed, threads=1)))
        busy.append(time.process_time() - before)
    slow = _reference(task, tables, plans[0].value)
    os.sched_setaffinity(0, cores)
    both = [PRADA(prepared, Options(samples, seed, threads=2)) for seed in SEEDS]
    value = statistics.median(plan.value for plan in plans)
    return Figures(
        task,
        grounded - started,
        lowered - grounded,
        statistics.median(busy),
        statistics.median(plan.seconds["search"] for plan in both),
        value,
        samples * slow,
        samples * _operations(task, tables, value) / (_clock() * 1e6),
    )


def _reference(task: Task, tables: Tables, best: float) -> float:
    """Seconds in which the reference values one sequence."""
    sequences = [actions for actions, _ in itertools.islice(_drawn(task, tables, best), 5)]
    started = time.process_time()
    for actions in sequences:
        reference_prada.value(task, actions)
    return (time.process_time() - started) / len(sequences)


def _operations(task: Task, tables: Tables, best: float) -> float:
    """Multiply-adds that a sample needs, in the mean of some."""
    return statistics.mean(count for _, count in itertools.islice(_drawn(task, tables, best), COUNTED))


def _drawn(task: Task, t: Tables, best: float) -> Iterator[tuple[list[int], int]]:
    """Sequences as the search draws them, if it gave up where they cannot be worth the value, and how many
    multiply-adds they need."""
    state, rng = np.asarray(task.initial, dtype=np.int32), np.random.default_rng(0)
    weighing, belief = (belief_search.new_belief(t, Options().rule_threshold) for _ in range(2))
    ceiling = belief_search.ceiling(t, task.discount, task.horizon)
    while True:
        kernel.initialise(t, state, weighing)
        kernel.initialise(t, state, belief)
        actions: list[int] = []
        count, value, factor = 0, 0.0, 1.0
        while len(actions) < task.horizon and value + factor * ceiling[task.horizon - len(actions)] > best:
            action = kernel.draw(weighing.weight, rng.random())
            if action < 0:
                break
            actions.append(action)
            kernel.advance(t, weighing, action)
            paid, _ = kernel.follow(t, belief, action)
            value, factor = value + factor * paid, factor * task.discount
            count += _step(t, belief, action)
        yield actions, count


def _step(t: Tables, belief: kernel.Belief, action: int) -> int:
    """Multiply-adds of an update: conditions, effects of rules that may apply, slots, sums, rewards."""
    rules = range(t.rule_start[action], t.rule_start[action + 1])
    applying = [rule for rule in rules if belief.cover[rule] > 0]
    touched = t.touched_reward[t.touched_reward_start[action] : t.touched_reward_start[action + 1]]
    sums = t.touched_sum[t.touched_sum_start[action] : t.touched_sum_start[action + 1]]
    return int(
        _entries(t.guard_start, [action])
        + _entries(t.condition_start, [*rules, *(touched + len(t.useful))])
        + _entries(t.shift_start, applying)
        + 2 * _entries(t.loss_start, applying)
        + _entries(t.touched_slot_start, [action])
        + _entries(t.sum_start, sums)
        + len(touched)
        + 2
    )


def _entries(start: np.ndarray, items: Iterable[int]) -> int:
    return sum(int(start[item + 1] - start[item]) for item in items)


def _clock() -> float:
    """MHz of the machine as it says itself; not a number where it does not."""
    found = re.search(r"cpu MHz\s*:\s*([\d.]+)", Path("/proc/cpuinfo").read_text())
    return float(found[1]) if found else float("nan")


def row(areas: int, samples: int, f: Figures, libprada: float | None) -> str:
    """`libprada`: what it takes for the same samples, in seconds."""
    ratio = "-" if libprada is None else f"{libprada / f.one_core:.0f}"
    return (
        f"{areas:5}  {len(f.task.actions):7}  {len(f.task.rules):5}  {f.grounding:6.3f}  {f.lowering:5.3f}"
        f"  {f.one_core:8.4f}  {f.two_cores:9.4f}  {samples / f.one_core:9.0f}  {f.value:6.3f}  {ratio:>8}"
        f"  {f.reference / f.one_core:9.0f}  {f.one_core / f.floor:5.1f}"
    )


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0, help="where the areas lie")
    parser.add_argument("--areas", nargs="+", type=int, default=AREAS)
    asked = parser.parse_args()
    PRADA(prepare(ground(DOMAIN, layout(2, 0))), Options(10))
    print(
        f"{asked.samples} samples, horizon 1 + areas, medians of {len(SEEDS)} seeds,"
        f" load {os.getloadavg()[0]:.2f}"
    )
    print("times in seconds of CPU, on two cores by the clock")
    print("ratios: libPRADA's and the reference's time to ours on one core, ours to the floor")
    tasks = [("random tables", [(areas, layout(areas, asked.seed)) for areas in asked.areas])]
    tasks.append(
        ("libPRADA's states", [(areas, problem) for areas, problem in peers() if areas in asked.areas])
    )
    for name, problems in tasks:
        print(f"\n{name}")
        print(
            "areas  actions  rules  ground  lower  one core  two cores  samples/s   value  libPRADA"
            "  reference  floor"
        )
        for areas, problem in problems:
            theirs = LIBPRADA.get(areas) if problem.name == f"d{areas}" and asked.samples == 10_000 else None
            print(row(areas, asked.samples, measured(problem, asked.samples), theirs), flush=True)
    print(f"\nload {os.getloadavg()[0]:.2f}, {_clock():.0f} MHz")


if __name__ == "__main__":
    main()
