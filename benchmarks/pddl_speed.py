"""How fast a large PDDL problem is read: `python benchmarks/pddl_speed.py [rounds] [--parsers PYTHON]`.

A domain of 30 schemas and a problem of 1,000 objects and 2,000 facts are parsed, converted and checked, and
what parsers of PDDL on PyPI take to parse them: pyperplan, pddl, unified-planning, tarski. PYTHON is the
interpreter that has some of them (`pip install pyperplan pddl unified-planning tarski`); those that it lacks
are left out. Each is a process of its own, in which the files were read once before; rounds take turns, and
the medians of CPU seconds are printed. `--seed` draws other facts. 9 rounds take about a minute on one core.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from random import Random

SCHEMAS, OBJECTS = 30, 1000

_TIMED = """
import gc, sys, time
{load}
def read():
    {read}
read()
gc.collect()
started = time.process_time()
read()
print("seconds", time.process_time() - started)
"""

OURS = "cleancli"
PARSERS = {
    OURS: (
        "from cleancli.conversion.pddl.models import models_of\n"
        "from cleancli.language.parsing.read import read_source",
        "models_of(read_source(sys.argv[1]), read_source(sys.argv[2]))",
    ),
    "pyperplan": (
        "from pyperplan.pddl.parser import Parser",
        "found = Parser(sys.argv[1], sys.argv[2]); found.parse_problem(found.parse_domain())",
    ),
    "pddl": (
        "from pddl import parse_domain, parse_problem",
        "parse_domain(sys.argv[1]); parse_problem(sys.argv[2])",
    ),
    "unified-planning": (
        "from unified_planning.io import PDDLReader",
        "PDDLReader().parse_problem(sys.argv[1], sys.argv[2])",
    ),
    "tarski": (
        "from tarski.io import PDDLReader",
        "PDDLReader(raise_on_error=True).read_problem(sys.argv[1], sys.argv[2])",
    ),
}
"""What loads each parser, and what reads the files `sys.argv[1]` and `sys.argv[2]` with it."""


def domain_text(schemas: int = SCHEMAS) -> str:
    """Deliveries: each schema moves one kind of parcel with one kind of vehicle."""
    lines = [
        "(define (domain deliveries)",
        "  (:requirements :strips :typing)",
        "  (:types place thing - object parcel vehicle - thing)",
        "  (:predicates (road ?from ?to - place) (at ?x - thing ?p - place) (in ?x - parcel ?v - vehicle)",
        *(f"    (fits{n} ?x - parcel ?v - vehicle)" for n in range(schemas)),
        "    (empty ?v - vehicle))",
    ]
    for n in range(0, schemas, 3):
        lines += [
            f"  (:action load{n}",
            "    :parameters (?x - parcel ?v - vehicle ?p - place)",
            f"    :precondition (and (at ?x ?p) (at ?v ?p) (empty ?v) (fits{n} ?x ?v))",
            "    :effect (and (in ?x ?v) (not (at ?x ?p)) (not (empty ?v))))",
            f"  (:action drive{n}",
            "    :parameters (?v - vehicle ?from ?to - place)",
            "    :precondition (and (at ?v ?from) (road ?from ?to))",
            "    :effect (and (at ?v ?to) (not (at ?v ?from))))",
            f"  (:action unload{n}",
            "    :parameters (?x - parcel ?v - vehicle ?p - place)",
            f"    :precondition (and (in ?x ?v) (at ?v ?p) (fits{n + 1} ?x ?v))",
            "    :effect (and (at ?x ?p) (empty ?v) (not (in ?x ?v))))",
        ]
    return "\n".join([*lines, ")", ""])


def problem_text(objects: int, rng: Random, schemas: int = SCHEMAS) -> str:
    """A problem with twice as many facts as objects."""
    places = [f"place{n}" for n in range(objects // 2)]
    vehicles = [f"vehicle{n}" for n in range(objects // 10)]
    parcels = [f"parcel{n}" for n in range(objects - len(places) - len(vehicles))]
    facts = dict.fromkeys(f"(at {thing} {rng.choice(places)})" for thing in (*vehicles, *parcels))
    facts |= dict.fromkeys(f"(empty {vehicle})" for vehicle in vehicles)
    while len(facts) < 2 * objects:
        kind, (one, other) = rng.randrange(schemas), rng.sample(places, 2)
        facts[f"(road {one} {other})"] = None
        facts[f"(fits{kind} {rng.choice(parcels)} {rng.choice(vehicles)})"] = None
    goal = [f"(at {parcel} {rng.choice(places)})" for parcel in parcels[:20]]
    return "\n".join(
        [
            "(define (problem many) (:domain deliveries)",
            "  (:objects",
            *(
                f"    {' '.join(names)} - {kind}"
                for names, kind in ((places, "place"), (vehicles, "vehicle"), (parcels, "parcel"))
            ),
            "  )",
            "  (:init",
            *(f"    {fact}" for fact in facts),
            "  )",
            f"  (:goal (and {' '.join(goal)})))",
            "",
        ]
    )


def seconds(python: str, parser: str, files: tuple[Path, Path]) -> float | None:
    """CPU seconds that a parser takes for the files; None where the interpreter does not have it."""
    load, read = PARSERS[parser]
    command = [python, "-c", _TIMED.format(load=load, read=read), *map(str, files)]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode != 0 and "ModuleNotFoundError" not in done.stderr:
        print(f"{parser} failed: {done.stderr.strip().splitlines()[-1]}")
    return float(done.stdout.split()[-1]) if done.returncode == 0 else None


def main() -> None:
    """Print times and ratios."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rounds", type=int, nargs="?", default=9)
    parser.add_argument("--objects", type=int, default=OBJECTS)
    parser.add_argument("--parsers", default=sys.executable, metavar="PYTHON")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    times: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        files = Path(folder) / "domain.pddl", Path(folder) / "problem.pddl"
        files[0].write_text(domain_text(), encoding="utf-8")
        files[1].write_text(problem_text(options.objects, Random(options.seed)), encoding="utf-8")
        for number in range(options.rounds):
            for name in PARSERS:
                if number == 0 or name in times:
                    took = seconds(sys.executable if name == OURS else options.parsers, name, files)
                    if took is not None:
                        times.setdefault(name, []).append(took)
    print(
        f"{SCHEMAS} schemas, {options.objects} objects, {2 * options.objects} facts: medians of CPU seconds"
    )
    fastest = min((statistics.median(found) for name, found in times.items() if name != OURS), default=None)
    for name, found in times.items():
        median = statistics.median(found)
        ratio = "" if fastest is None else f"   {median / fastest:6.2f} times the fastest of others"
        print(f"{name:<18}{median:8.4f} s{ratio}")


if __name__ == "__main__":
    main()
