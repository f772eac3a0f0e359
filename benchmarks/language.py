"""How fast .nid text is checked: `python benchmarks/language.py [rounds]`, as ratios of one run.

A generated domain of 4,000 rules in 20,000 lines: parse and check against lark's own bare parse of the same
text with the same grammar. Then `cleancli check` of the shipped domain from a cold start against importing
click and lark. Rounds take turns, so that whatever else the machine does weighs on both; medians are printed.
The first round of the cold starts fills the caches and is not counted. Nothing is drawn. 5 rounds take about
a minute on one core.
"""

from __future__ import annotations

import argparse
import gc
import itertools
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from lark import Lark

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.resources import shipped

ACTIONS, RULES_EACH = 500, 8
COLD = {
    "import click, lark": "import click, lark",
    "cleancli check cleaning": "from cleancli.cli.main import main; main(['check', 'cleaning'])",
}
"""What the interpreter runs; the second is what the installed command runs."""


def large_domain(actions: int = ACTIONS) -> str:
    """A domain with `actions` actions of eight rules each, no two of which overlap."""
    lines = [
        "domain large {",
        "  types      { place; area - place; container - place }",
        "  constants  { bin - container }",
        "  predicates {",
        "    dirt(?a - area)             # seen on the surface",
        "    wet(?a - area)",
        "    near(?a ?b - area) [symmetric]",
        "    traversal(?a - area, ?e - place, ?m - area)",
        "  }",
        "  functions  { size(?a - area): tiny < small < medium < big }",
        "  derived    { dirty_areas := count ?a - area: dirt(?a) }",
        "  actions {",
        *(f"    act{number}(?a ?b - area) [duration = 7.5 s]" for number in range(actions)),
        "  }",
    ]
    for number in range(actions):
        cases = itertools.product(("tiny", "small", "medium", "big"), ("", "not "))
        for size, sign in cases:
            lines += [
                f"  rule act{number}_{size}_{'dry' if sign else 'wet'}: act{number}(?a, ?b) {{",
                f"    when dirt(?a), size(?a) = {size}, {sign}wet(?a), near(?a, ?b)",
                "    then 0.55: not dirt(?a), forall ?m - area: traversal(?a, bin, ?m) => not dirt(?m)",
                f"         1/4 [prior 0.3, seen 12]: size(?b) := {size}, wet(?b)   rest: noise",
                "  }",
            ]
    lines += ["  default { 0.9: nothing  0.1: noise }", "  reward  { decrease(dirty_areas) }", "}", ""]
    return "\n".join(lines)


def _seconds(work: Callable[[], object]) -> float:
    gc.collect()
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def parse_and_check(rounds: int) -> tuple[float, float]:
    """Median seconds of lark's bare parse, and of our parse and check, of the large domain."""
    text = large_domain()
    bare = Lark((shipped("grammar") / "nid.lark").read_text(encoding="utf-8"), parser="lalr")
    load_domain(Source("small", large_domain(1)))
    theirs, ours = [], []
    for _ in range(rounds):
        theirs.append(_seconds(lambda: bare.parse(text)))
        ours.append(_seconds(lambda: load_domain(Source("large", text))))
    return statistics.median(theirs), statistics.median(ours)


def cold_start(rounds: int) -> dict[str, float]:
    """Median seconds of each command from a cold start, its imports included.

    Compiled modules and the parser are kept in a folder of their own, as they are for an installed program.
    """
    sources = str(Path(__file__).parents[1] / "src")
    times: dict[str, list[float]] = {name: [] for name in COLD}
    with tempfile.TemporaryDirectory() as folder:
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        environment |= {"PYTHONPATH": sources, "PYTHONPYCACHEPREFIX": folder, "XDG_CACHE_HOME": folder}
        for _ in range(rounds + 1):
            for name, code in COLD.items():
                command = [sys.executable, "-c", code]
                started = time.perf_counter()
                subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
                times[name].append(time.perf_counter() - started)
    return {name: statistics.median(seconds[1:]) for name, seconds in times.items()}


def main() -> None:
    """Print times and ratios."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rounds", type=int, nargs="?", default=5)
    rounds = parser.parse_args().rounds
    bare, ours = parse_and_check(rounds)
    lines = large_domain().count("\n")
    print(f"{ACTIONS * RULES_EACH} rules in {lines} lines, medians of {rounds} rounds")
    print(f"lark's bare parse         {bare:6.2f} s", flush=True)
    print(f"our parse and check       {ours:6.2f} s   {ours / bare:.2f} times (goal: at most 4)")
    starts = cold_start(3 * rounds)
    base = starts["import click, lark"]
    for name, seconds in starts.items():
        print(f"{name:<25} {seconds:6.3f} s   {seconds / base:.2f} times")
    print("(goal for the check: at most 2.5 times)")


if __name__ == "__main__":
    main()
