"""Planners side by side: python benchmarks/planners.py [--areas N ...] [--planner NAME:OPTION=VALUE ...]

The tasks are the tables of planning.py. For each number of areas and each planner: what its plan is worth by
the planner's own measure, what its sequence is truly worth when it is carried out whatever happens (by drawn
runs), both as means over the seeds, and the median milliseconds of search, CPU time on one core. A planner
that refuses a task has a row that says why. The usual planners and areas take about two minutes of CPU; a row
is printed as soon as it is known.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Sequence
from dataclasses import replace

from written import planner_of

from cleancli.compiler.ground import ground
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.kernels import annealing
from cleancli.planning.plan import Options, Plan, PlanningRefused
from planning import DOMAIN, layout

USUAL = (
    "prada",
    "prada+:samples=2000,solve=0,runs=0",
    "prada+:solve=0,runs=0",
    "prada+:solve=0",
    "exact",
    "uct:samples=1000",
    "sst",
    "likeliest",
    "all-outcomes",
)
AREAS = (2, 4, 6, 10, 14)
RUNS = 32_000
WARM = 50
"""Samples of the plan that loads what will run."""


def plans(written: str, prepared: Prepared, seeds: Sequence[int]) -> tuple[list[Plan], float]:
    """Those of all seeds, and the median seconds of CPU that one took, each as if it were the first of an
    episode. Raises PlanningRefused."""
    planner, options = planner_of(written, Options(threads=1))
    planner(prepared, replace(options, samples=WARM))
    found, spent = [], []
    for seed in seeds:
        prepared.solutions.clear()
        began = time.process_time()
        found.append(planner(prepared, replace(options, seed=seed)))
        spent.append(time.process_time() - began)
    return found, statistics.median(spent)


def worth(plan: Plan, prepared: Prepared) -> float:
    """Of its sequence, by drawn runs; the draws are the same for all plans."""
    actions = [prepared.task.actions.index(action) for action in plan.actions]
    return annealing.value(prepared, actions, RUNS // 64, 10**6)


def main() -> None:
    """Print the rows."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--areas", nargs="+", type=int, default=AREAS)
    parser.add_argument("--planner", nargs="+", default=USUAL)
    parser.add_argument("--seeds", type=int, default=5, help="plans of each planner")
    parser.add_argument("--seed", type=int, default=0, help="where the areas lie")
    options = parser.parse_args()
    print(f"{options.seeds} seeds, {RUNS:,} runs, load {os.getloadavg()[0]:.1f}")
    print("| areas | actions | rules | planner | value | sequence, truly | ms |")
    print("|---|---|---|---|---|---|---|")
    for areas in options.areas:
        task = ground(DOMAIN, layout(areas, options.seed))
        prepared = prepare(task)
        for written in options.planner:
            head = f"| {areas} | {len(task.actions)} | {len(task.rules)} | {written} |"
            try:
                found, seconds = plans(written, prepared, range(options.seeds))
            except PlanningRefused as refused:
                print(f"{head} {refused} | | |", flush=True)
                continue
            value = statistics.fmean(plan.value for plan in found)
            truly = statistics.fmean(worth(plan, prepared) for plan in found)
            print(f"{head} {value:.2f} | {truly:.2f} | {1e3 * seconds:.1f} |", flush=True)


if __name__ == "__main__":
    main()
