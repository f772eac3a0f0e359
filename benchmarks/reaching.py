"""How fast goals without a horizon are solved, beside Storm: `python benchmarks/reaching.py --storm`.

Three families of growing problems (their functions say which): of each the states that are enumerated in a
second, the seconds that the policy takes (the greatest probability, and the least expected cost among those
that have it, both with bounds), and the memory of the process.

With --storm the same models, handed over once, are solved by Storm (`pip install stormpy`), which has 1e-10
as its precision too: the greatest probability, and, where the goal is reached for certain, the least expected
cost, each by its sound methods, of which the fastest counts. Seconds are those of CPU.

All sizes take about ten minutes, half an hour beside Storm, which reads models from texts of hundreds of
megabytes, --quick a minute. With --keep each problem is a line of FILE: those that
stand there are not solved again.
"""

from __future__ import annotations

import argparse
import itertools
import math
import multiprocessing
import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from kept import Kept

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.planning.compiled_task import prepare
from cleancli.planning.kernels import goal_policy
from cleancli.planning.planners.reaching import decisions, enumerated, policy_of

CORRIDOR = """
domain corridor {
  types { place }
  predicates { at(?p - place)  next(?p ?q - place) [symmetric, static]  dirt(?p - place)  torn() }
  actions { go(?p ?q - place) [cost = 1]  clean(?p - place) [cost = 2]  scrub(?p - place) [cost = 5] }
  rule go_on: go(?p, ?q) { when at(?p), next(?p, ?q) then 0.9: not at(?p), at(?q) MUD rest: nothing }
  rule clean_it: clean(?p) { when at(?p), dirt(?p), not torn() then 0.7: not dirt(?p) TEAR rest: nothing }
  rule scrub_it: scrub(?p) { when at(?p), dirt(?p), not torn() then 0.8: not dirt(?p) WEAR rest: nothing }
  reward { goal }
}
"""
LOCKS = """
domain locks {
  types { lock }
  predicates { open(?l - lock) }
  actions { pick(?l - lock) [cost = 1]  force(?l - lock) [cost = 3] }
  rule pick_it: pick(?l) { when not open(?l) then 0.4: open(?l) rest: nothing }
  rule force_it: force(?l) { when not open(?l) then 0.9: open(?l) rest: nothing }
  reward { goal }
}
"""


def corridor(size: int) -> Task:
    """Places in a row; the rag may tear, after which nothing can be cleaned: components of as many states as
    there are places."""
    return _row(
        size, CORRIDOR.replace("MUD", "").replace("TEAR", "0.05: torn()").replace("WEAR", "0.02: torn()")
    )


def mud(size: int) -> Task:
    """The same, but who goes may make the place behind him dirty: one component of nearly all states."""
    return _row(
        size,
        CORRIDOR.replace("MUD", "0.03: not at(?p), at(?q), dirt(?p)").replace("TEAR", "").replace("WEAR", ""),
    )


def locks(size: int) -> Task:
    """Locks to open in any order; nothing comes back: components of one state each."""
    number = min(round(math.log2(size)), 19)  # more would have more transitions than are kept
    names = " ".join(f"l{index}" for index in range(number))
    return _task(LOCKS, f"objects {{ {names} - lock }} goal {{ forall ?l - lock: open(?l) }}")


def _row(size: int, text: str) -> Task:
    number = next(n for n in range(2, 30) if (n + 1) * 2 ** (n + 1) > size)
    names = [f"p{index}" for index in range(number)]
    facts = [f"next({one}, {other})" for one, other in itertools.pairwise(names)]
    facts += [f"dirt({name})" for name in names] + [f"at({names[0]})"]
    goal = "forall ?p - place: not dirt(?p)"
    return _task(
        text, f"objects {{ {' '.join(names)} - place }} init {{ {', '.join(facts)} }} goal {{ {goal} }}"
    )


def _task(text: str, inside: str) -> Task:
    domain = load_domain(Source("domain.nid", text))
    problem = f"problem p {{ domain = {domain.name} {inside} horizon = unlimited }}"
    return ground(domain, load_problem(Source("problem.nid", problem), domain))


FAMILIES: dict[str, Callable[[int], Task]] = {"corridor": corridor, "locks": locks, "mud": mud}

SIZES = (10_000, 100_000, 500_000, 2_000_000)
QUICK = (1_000, 10_000)
ERROR = 1e-10
LIMIT = 10_000_000
METHODS = ("TOPOLOGICAL", "OPTIMISTIC_VALUE_ITERATION")
Row = dict[str, Any]


def measured(family: str, size: int, storm: bool) -> Row:
    """One problem: its states and transitions, CPU seconds, megabytes, and what both found."""
    prepared = prepare(FAMILIES[family](size))
    known = prepared.forgetful
    _ = known.process
    enumerated(prepare(FAMILIES[family](100)).forgetful, LIMIT)  # so that nothing is compiled below
    goal_policy.load()
    begun = time.process_time()
    _, graph, goal = enumerated(known, LIMIT)
    found = time.process_time()
    model = decisions(known.task, graph)
    policy, error = policy_of(model, goal, ERROR)
    done = time.process_time()
    row: Row = {
        "family": family,
        "size": size,
        "states": len(goal),
        "transitions": len(graph.edge_successor),
        "enumerating": found - begun,
        "solving": done - found,
        "megabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "probability": float(policy.probability[0, 0]),
        "cost": float(policy.cost[0, 0]),
        "error": error,
    }
    if storm:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "model.drn"
            write(model, goal, path)
            row |= by_storm(path, bool((policy.probability[0] == 1.0).all()))
    return row


def write(model: Any, goal: Any, path: Path) -> None:
    """The model as Storm reads one; states without choices stay where they are."""
    number = len(goal)
    idle = int((model.choice_start[1:] == model.choice_start[:-1]).sum())
    with path.open("w", encoding="ascii") as file:
        file.write("@type: MDP\n@parameters\n\n@reward_models\ncost\n@nr_states\n")
        file.write(f"{number}\n@nr_choices\n{len(model.cost) + idle}\n@model\n")
        for state in range(number):
            file.write(f"state {state} [0]{' init' if state == 0 else ''}{' goal' if goal[state] else ''}\n")
            first, last = model.choice_start[state], model.choice_start[state + 1]
            if first == last:
                file.write(f"\taction 0 [0]\n\t\t{state} : 1\n")
            for choice in range(first, last):
                file.write(f"\taction {choice - first} [{float(model.cost[choice])!r}]\n")
                edges = slice(model.edge_start[choice], model.edge_start[choice + 1])
                after = sorted(
                    zip(model.successor[edges].tolist(), model.probability[edges].tolist(), strict=True)
                )
                file.writelines(f"\t\t{to} : {chance!r}\n" for to, chance in after)


def by_storm(path: Path, certain: bool) -> Row:
    """What Storm finds, and the CPU seconds of its fastest sound method."""
    import stormpy  # for this alone, and GPL, so that nothing of the package rests on it
    from stormpy.developer import MinMaxMethod

    model = stormpy.build_model_from_drn(str(path))
    wanted = {"storm probability": 'Pmax=? [F "goal"]'}
    if certain:
        wanted["storm cost"] = 'R{"cost"}min=? [F "goal"]'
    best: Row = {"storm": math.inf}
    for method in METHODS:
        environment = stormpy.environments.sound()
        settings = environment.solver().min_max()
        settings.method = getattr(MinMaxMethod, method)
        settings.precision = stormpy.Rational("1/10000000000")
        settings.relative_termination_criterion = False
        row: Row = {"storm method": method}
        begun = time.process_time()
        for name, text in wanted.items():
            (asked,) = stormpy.parse_properties(text)
            row[name] = stormpy.model_checking(model, asked, environment=environment).get_value(0)
        row["storm"] = time.process_time() - begun
        best = min(best, row, key=lambda each: each["storm"])
    return best


HEAD = (
    "family     states  transitions  states/s  solving s  states/s     MB  probability          cost  error"
)


def shown(row: Row) -> str:
    """A line of the table."""
    states = row["states"]
    line = f"{row['family']:8} {states:8} {row['transitions']:12} {states / row['enumerating']:9.0f}"
    line += f" {row['solving']:10.3f} {states / row['solving']:9.0f} {row['megabytes']:6.0f}"
    line += f" {row['probability']:12.9f} {row['cost']:13.6f} {row['error']:6.0e}"
    if "storm" in row:
        method = row["storm method"].lower()
        line += f"  storm {row['storm']:.3f} s ({row['solving'] / row['storm']:.2f} of it), {method}:"
        line += f" {row['storm probability']:.9f} {row.get('storm cost', float('nan')):.6f}"
    return line


def main() -> list[Row]:
    """The table, a process for each problem so that its memory is its own."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small sizes: a minute")
    parser.add_argument("--storm", action="store_true", help="beside Storm (needs stormpy)")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="keep each problem's line in FILE")
    parser.add_argument("--families", nargs="+", choices=list(FAMILIES), default=list(FAMILIES))
    parser.add_argument("--sizes", nargs="+", type=int, help="states, about")
    asked = parser.parse_args()
    kept = Kept(asked.keep)
    known = {(row["family"], row["size"]): dict(row) for row in kept.rows()}
    sizes = asked.sizes or (QUICK if asked.quick else SIZES)
    rows: list[Row] = []
    print(HEAD)
    for family in asked.families:
        for size in sizes:
            row = known.get((family, size))
            if row is None:
                with multiprocessing.get_context("spawn").Pool(1) as pool:
                    row = pool.apply(measured, (family, size, asked.storm))
                kept.add(row)
            print(shown(row), flush=True)
            rows.append(row)
    return rows


if __name__ == "__main__":
    main()
