"""Plans for libPRADA's files against its figures: `python benchmarks/libprada.py [samples] [seeds]`.

The folder libprada beside this file holds rules and symbols in libPRADA's form, and states with 2 to 14 dirty
areas, on which the library was run. The reward is eq. 2, the horizon
1 and the number of dirty areas, the discount 0.95. Values are means over the seeds, with the standard error
for libPRADA's way; true values are of 20,000 runs by the rules. Seconds are CPU time of a plan for a task
that is grounded and lowered, on one core, medians; libPRADA's were measured before, on the same kind of
machine, with n = 10,000: medians of 5 seeds, so with an error of half the spread of single plans, and more.
A row each as soon as it is known; about five minutes of CPU.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task
from cleancli.conversion.convert import Wishes, convert
from cleancli.language.load import checked_domain, load_problem, read_source
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.kernels import annealing
from cleancli.planning.plan import Options
from cleancli.planning.planner import Planner
from cleancli.planning.registry import PLANNERS

FOLDER = Path(__file__).parent / "libprada"
WORDS = 20_000 // 64
FEW = 2_000
"""The sequences that prada+ may try where it is to need a hundredth of libPRADA's time."""


@dataclass(frozen=True, slots=True)
class Figures:
    """What libPRADA was measured to do: ground rules, actions, its plan's value, its true value, seconds."""

    rules: int
    actions: int
    value: float
    true: float
    seconds: float


LIBPRADA = {
    2: Figures(44, 15, 1.402, 1.596, 0.115),
    4: Figures(70, 23, 2.359, 2.589, 0.304),
    6: Figures(120, 39, 3.108, 3.256, 0.711),
    8: Figures(212, 79, 4.746, 5.190, 1.40),
    10: Figures(318, 123, 6.036, 6.393, 2.66),
    14: Figures(474, 188, 7.758, 8.084, 7.54),
}


@dataclass(frozen=True, slots=True)
class Result:
    """One planner over all seeds: values by its own measure and true ones, and median seconds of search."""

    values: tuple[float, ...]
    true: float
    seconds: float

    @property
    def value(self) -> float:
        return statistics.fmean(self.values)

    @property
    def error(self) -> float:
        return statistics.stdev(self.values) / len(self.values) ** 0.5 if len(self.values) > 1 else 0.0


def tasks(areas: int) -> Iterator[Task]:
    """The task of the converted problem with so many areas, and the same with libPRADA's own predicates,
    grounded as it does."""
    names = "rules.dat", f"d{areas}.state.dat", "symbols.dat"
    rules, state, symbols = (read_source(FOLDER / name) for name in names)
    for compat in (False, True):
        wishes = Wishes(predicates=compat)
        converted = convert(rules, state, symbols, wishes, ("domain.nid", "problem.nid"))
        domain = checked_domain(converted.sources[0], compat=compat).get()
        yield ground(domain, load_problem(converted.sources[1], domain), compat=compat)


def planned(planner: Planner[Any], task: Task, truth: Prepared, seeds: range, options: Options) -> Result:
    """Plans of all seeds; `truth` is the task by which they are carried out, whatever happens."""
    prepared, values, true, seconds = prepare(task), [], [], []
    planner(prepared, Options(1, compat=options.compat))  # loads what will run
    for seed in seeds:
        chosen = replace(options, seed=seed, threads=1)
        started = time.process_time()
        plan = planner(prepared, chosen)
        seconds.append(time.process_time() - started)
        actions = [truth.task.actions.index(action) for action in plan.actions]
        values.append(plan.value)
        true.append(annealing.value(truth, actions, WORDS, 10**6))
    return Result(tuple(values), float(np.mean(true)), statistics.median(seconds))


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("samples", type=int, nargs="?", default=10_000)
    parser.add_argument("seeds", type=int, nargs="?", default=20)
    parser.add_argument("--seed", type=int, default=0, help="the first")
    options = parser.parse_args()
    samples, seeds = options.samples, range(options.seed, options.seed + options.seeds)
    print(f"n = {samples}, {len(seeds)} seeds, load {os.getloadavg()[0]:.1f}; libPRADA's own in parentheses")
    print(
        "as libPRADA computes:  areas  rules      actions    prada: value ± error (its)  spread  true (its)"
        "       aprada: value ± error"
    )
    rows = []
    for areas, theirs in LIBPRADA.items():
        task, compat = tasks(areas)
        truth = prepare(task)
        literal, shortened = (
            planned(PLANNERS[planner], compat, truth, seeds, Options(samples, compat=True))
            for planner in ("prada", "aprada")
        )
        spread = literal.error * len(seeds) ** 0.5
        print(
            f"                       {areas:5}  {len(compat.rules):3} ({theirs.rules:3})"
            f"  {len(compat.actions):3} ({theirs.actions:3})"
            f"  {literal.value:12.3f} ± {literal.error:.3f} ({theirs.value:.3f})  {spread:.3f}"
            f"  {literal.true:.3f} ({theirs.true:.3f})  {shortened.value:12.3f} ± {shortened.error:.3f}",
            flush=True,
        )
        own = planned(PLANNERS["prada"], task, truth, seeds, Options(samples))
        # Without exact solutions of small problems: the search is what is compared.
        searching = PLANNERS["prada+"].having(solve=0)
        few, many = (planned(searching, task, truth, seeds, Options(n)) for n in (FEW, samples))
        rows.append((areas, theirs, own, few, many))
    print()
    print(
        f"true value, and seconds of search (libPRADA's time divided by them); prada+ ({FEW}) and ({samples})"
    )
    print("areas  libPRADA        prada                  prada+, few            prada+")
    for areas, theirs, *results in rows:
        cells = (f"{r.true:.3f} {r.seconds:.4f} {theirs.seconds / r.seconds:5.0f}" for r in results)
        print(f"{areas:5}  {theirs.true:.3f} {theirs.seconds:5.3f}  " + "   ".join(cells))


if __name__ == "__main__":
    main()
