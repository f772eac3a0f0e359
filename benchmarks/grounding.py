"""How fast and small grounding is: `python benchmarks/grounding.py [--areas N ...] [--beside FOLDER]`.

Tables with dirty areas at random places, as of planning.py: seconds of CPU for grounding, for lowering for
beliefs (`lower`) and for states (`process`), and for the search of 10,000 samples by prada on one core; the
`whole` is without `process`, which prada does not need. Then the most memory that the process took, and by
how much that is more than Python and its libraries take. Each row is a process of its own, printed as soon as
it is known. About 20 seconds of CPU; with `--quick` 3.

`--sweep` measures sweeping.nid with strokes over up to four areas instead, on tables where each stroke goes
towards the container. `--beside` takes the `src` folder of another version: its rows stand below ours.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from cleancli.compiler.ground import ground
from cleancli.compiler.lowering.state_tables import lower_process
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Fact, Problem
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS
from planning import CONTAINER, DOMAIN, SURFACE, layout

AREAS = (10, 20, 40, 60, 100)
SWEEPING = Path(__file__).parents[1] / "domains" / "sweeping.nid"
FOUR = """
  rule sweep_four: sweep4(?a, ?b, ?c, ?d) {
    when dirt(?a), dirt(?b), dirt(?c), dirt(?d), onward(?a, ?b), onward(?b, ?c), onward(?c, ?d),
         ?a != ?c, ?a != ?d, ?b != ?d
    then 0.92: not dirt(?a), not dirt(?b), not dirt(?c), not dirt(?d),
             forall ?m - area: traversal(?a, ?b, ?m) => not dirt(?m),
             forall ?m - area: traversal(?b, ?c, ?m) => not dirt(?m),
             forall ?m - area: traversal(?c, ?d, ?m) => not dirt(?m),
             forall ?m - area: traversal(?d, bin, ?m) => not dirt(?m)
         0.04: not dirt(?a), not dirt(?b), not dirt(?c), size(?d) := small
         rest: noise
  }
"""
PLACES = dict.fromkeys(("ground", "lower", "process", "search", "whole"), 3)
COLUMNS = ("actions", "rules", *PLACES, "peak MB", "more MB")


def sweeping() -> Domain:
    """sweeping.nid with an action more, over four areas."""
    text = SWEEPING.read_text(encoding="utf-8")
    text = text.replace("actions {", "actions {\n    sweep4(?a ?b ?c ?d - area)", 1)
    return load_domain(Source("sweeping.nid", text.replace("  default {", f"{FOUR}  default {{", 1)))


def towards(areas: int, seed: int) -> Problem:
    """A table with a fact for each stroke from one area over another that turns away from the container by
    less than a right angle."""
    table = layout(areas, seed)
    names = [each.name for each in table.objects]
    rng = np.random.default_rng([areas, seed])
    place = dict(zip(names, rng.random((areas, 2)) * SURFACE, strict=True))
    facts = {fact for fact in table.state if fact.symbol in ("dirt", "size", "traversal")}
    for one, other in itertools.permutations(names, 2):
        if (place[other] - place[one]) @ (CONTAINER - place[other]) > 0:
            facts.add(Fact("onward", (one, other)))
    return Problem(table.name, "sweeping", table.objects, frozenset(facts))


def measured(areas: int, seed: int, sweep: bool) -> Mapping[str, float]:
    """One row; what is compiled or loaded once was so before."""
    domain, table = (sweeping(), towards) if sweep else (DOMAIN, layout)
    small = ground(domain, table(2, seed))
    lower_process(small)
    PLANNERS["prada"](prepare(small), Options(10))
    problem = table(areas, seed)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    times = [time.process_time()]
    task = ground(domain, problem)
    times.append(time.process_time())
    prepared = prepare(task)
    assert prepared.tables
    times.append(time.process_time())
    PLANNERS["prada"](prepared, Options(10_000, seed, threads=1))
    times.append(time.process_time())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    lower_process(task)
    times.append(time.process_time())
    grounding, lowering, search, process = (after - early for early, after in itertools.pairwise(times))
    whole = grounding + lowering + search
    found = (len(task.actions), len(task.rules), grounding, lowering, process, search, whole)
    return dict(zip(COLUMNS, (*found, peak / 1024, (peak - before) / 1024), strict=True))


def row(areas: int, asked: argparse.Namespace, source: Path | None) -> str:
    """A row that another process measures, with our modules or with those of a folder."""
    command = [sys.executable, __file__, "--one", str(areas), "--seed", str(asked.seed)]
    path = {} if source is None else {"PYTHONPATH": str(source)}
    result = subprocess.run(
        [*command, *(["--sweep"] if asked.sweep else [])],
        env={**os.environ, **path},
        stdout=subprocess.PIPE,
        text=True,
    )
    if result.returncode:
        return f"{areas:5}  refused, or stopped"
    found = json.loads(result.stdout)
    return f"{areas:5}  " + "  ".join(f"{found[name]:7.{PLACES.get(name, 0)}f}" for name in COLUMNS)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--areas", nargs="+", type=int, default=AREAS)
    parser.add_argument("--seed", type=int, default=0, help="where the areas lie")
    parser.add_argument("--sweep", action="store_true", help="strokes over up to four areas")
    parser.add_argument("--beside", type=Path, help="the `src` folder of another version")
    parser.add_argument("--quick", action="store_true", help="tables of 10 and 20 areas alone")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.one:
        print(json.dumps(measured(asked.one, asked.seed, asked.sweep)))
        return
    print("areas  " + "  ".join(f"{name:>7}" for name in COLUMNS))
    for areas in AREAS[:2] if asked.quick else asked.areas:
        for source in (None, asked.beside) if asked.beside else (None,):
            print(row(areas, asked, source), flush=True)


if __name__ == "__main__":
    main()
