"""Plans for libPRADA's files against its figures: `python benchmarks/libprada.py FOLDER [samples] [seeds]`.

FOLDER holds d2, d4 ... d14, each with rules.dat, state.dat and symbols.dat. The reward is eq. 2, the horizon
1 and the number of dirty areas, the discount 0.95. True values are means over the seeds' plans, each executed
500 times by the rules.
"""

from __future__ import annotations

import statistics
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task
from cleancli.compiler.transition import payment, reward, sample, standing
from cleancli.conversion.convert import Wishes, convert
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.planning.plan import Options, Plan
from cleancli.planning.prada import prada
from cleancli.planning.prepared import prepare

FILES = ("rules.dat", "state.dat", "symbols.dat")
RUNS = 500


@dataclass(frozen=True, slots=True)
class Figures:
    """What libPRADA was measured to do: ground rules and actions, its value of its plan, and the true one."""

    rules: int
    actions: int
    value: float
    true: float


LIBPRADA = {
    2: Figures(44, 15, 1.402, 1.596),
    4: Figures(70, 23, 2.359, 2.589),
    6: Figures(120, 39, 3.108, 3.256),
    8: Figures(212, 79, 4.746, 5.190),
    10: Figures(318, 123, 6.036, 6.393),
    14: Figures(474, 188, 7.758, 8.084),
}


def tasks(folder: Path) -> tuple[Task, Task]:
    """The converted problem's task, and the same grounded as libPRADA does."""
    rules, state, symbols = (read_source(folder / name) for name in FILES)
    converted = convert(rules, state, symbols, Wishes(), ("domain.nid", "problem.nid"))
    domain = load_domain(converted.sources[0])
    problem = load_problem(converted.sources[1], domain)
    return ground(domain, problem), ground(domain, problem, compat=True)


def executed(task: Task, plan: Plan, rng: np.random.Generator) -> float:
    """The mean discounted reward of executing the plan by the rules, whatever happens."""
    actions = [task.actions.index(action) for action in plan.actions]
    total = 0.0
    for _ in range(RUNS):
        state, factor = task.initial, 1.0
        for action in actions:
            _, after = sample(task, state, action, rng)
            total += factor * payment(task, action) * reward(task, state, action, after)
            state, factor = after, factor * task.discounts[action]
        for _ in range(task.horizon - len(actions)):
            total += factor * standing(task, state)
            factor *= task.discount
    return total / RUNS


def main() -> None:
    folder = Path(sys.argv[1])
    samples = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
    seeds = range(int(sys.argv[3]) if len(sys.argv) > 3 else 20)
    print(f"n = {samples}, means over {len(seeds)} seeds; what libPRADA was measured to give in parentheses")
    print("areas  ground rules  actions    as libPRADA: value    true             prada: value  true")
    for areas, theirs in LIBPRADA.items():
        task, compat_task = tasks(folder / f"d{areas}")
        prepared, compat = prepare(task), prepare(compat_task)
        rng = np.random.default_rng(areas)
        literal = [prada(compat, Options(samples, seed, compat=True)) for seed in seeds]
        own = [prada(prepared, Options(samples, seed)) for seed in seeds]
        values = [statistics.fmean(plan.value for plan in plans) for plans in (literal, own)]
        true = [statistics.fmean(executed(task, plan, rng) for plan in plans) for plans in (literal, own)]
        print(
            f"{areas:5}  {len(compat_task.rules):5} ({theirs.rules:3})"
            f"  {len(compat_task.actions):4} ({theirs.actions:3})"
            f"     {values[0]:.3f} ({theirs.value:.3f})  {true[0]:.3f} ({theirs.true:.3f})"
            f"            {values[1]:.3f}  {true[1]:.3f}"
        )


if __name__ == "__main__":
    main()
