"""How long `cleancli plan` takes from a cold start: `python benchmarks/cold_plan.py [rounds] [--seed N]`.

The problem is that of planning.py with 14 areas; the seed decides where they lie. The first run compiles
where nothing is cached yet, and is not counted. Seconds by the clock, medians and least; the part of the
planner is what the command itself says of it. 9 rounds take about half a minute.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from cleancli.language.printing.printer import print_problem
from planning import DOMAIN, layout

AREAS = 14
RULES = Path(__file__).with_name("planning.nid")


def main() -> None:
    """Print the medians."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rounds", type=int, nargs="?", default=9)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        problem = Path(folder) / "areas.nid"
        named = replace(layout(AREAS, options.seed), name="areas")
        problem.write_text(print_problem(named, DOMAIN), encoding="utf-8")
        command = [sys.executable, "-m", "cleancli.cli.main", "plan", str(RULES), str(problem), "--json"]
        spent, parts = [], []
        for _ in range(options.rounds + 1):
            started = time.perf_counter()
            done = subprocess.run(command, capture_output=True, text=True, check=True)
            spent.append(time.perf_counter() - started)
            parts.append(json.loads(done.stdout)["seconds"])
    median, least = statistics.median(spent[1:]), min(spent[1:])
    print(
        f"{AREAS} areas, load {os.getloadavg()[0]:.1f}: {median:.2f} s (least {least:.2f}) in all; of which"
    )
    for phase in parts[0]:
        print(f"  {phase:8} {statistics.median(part[phase] for part in parts[1:]):.3f} s")


if __name__ == "__main__":
    main()
