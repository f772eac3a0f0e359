"""What whole commands take from a cold start: `python benchmarks/cold_plan.py [rounds] [--seed N]`.

Each row is a process of its own, and all rows take turns, so that what else the machine does weighs on all of
them alike. Seconds of CPU, medians and least of all rounds but the first, which compiles what is not cached
yet. Beside them what `import numba` takes in the same run: a plan that needs no search is to take at most 1.2
times that, and one that does at most 2 times. The last rows plan for libPRADA's own files (n = 10,000, one
thread, and its reward of eq. 2); `theirs` is libPRADA's whole command on the same files, which was measured
before, on the same kind of machine: medians of 5 seeds, with static literals removed for it. 9 rounds take
about a minute.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

FILES = Path(__file__).with_name("libprada")
LIBPRADA = {10: 2.74, 14: 6.39}
"""CPU seconds of libPRADA's command, by the number of areas."""
BASE = "import numba"
CLEANCLI = (sys.executable, "-m", "cleancli.cli.main")
SHIPPED = ("cleaning", "three_areas")
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
"""An installed package is compiled to bytecode once, and so is what is measured."""


@dataclass(frozen=True, slots=True)
class Command:
    """A command, what it is called, and how long libPRADA takes for the same."""

    name: str
    words: tuple[str, ...]
    theirs: float | None = None

    @property
    def tells(self) -> bool:
        """Whether it says how long the parts of planning took."""
        return "--json" in self.words


def commands(folder: Path, seed: int) -> list[Command]:
    """All rows; libPRADA's files are converted into the folder."""
    plain = [(name, (sys.executable, "-c", name)) for name in ("pass", "import numpy", BASE)]
    found = [Command(name, words) for name, words in plain]
    found.append(Command("check cleaning three_areas", (*CLEANCLI, "check", *SHIPPED)))
    more = ("", " --planner exact", " --planner prada", " --option solve=0")
    for options in more:
        words = (*CLEANCLI, "plan", *SHIPPED, *options.split(), "--seed", str(seed), "--json")
        found.append(Command(f"plan cleaning three_areas{options}", words))
    for areas, theirs in LIBPRADA.items():
        files = [str(FILES / name) for name in ("rules.dat", f"d{areas}.state.dat", "symbols.dat")]
        converted = folder / f"d{areas}"
        convert = (*CLEANCLI, "convert", *files, "--out", str(converted))
        subprocess.run(convert, check=True, capture_output=True)
        texts = [str(converted / name) for name in ("domain.nid", "problem.nid")]
        for planner in ("prada", "prada+ --option runs=0", "prada+"):
            asked = ("--samples", "10000", "--threads", "1", "--seed", str(seed), "--json")
            words = (*CLEANCLI, "plan", *texts, "--planner", *planner.split(), *asked)
            found.append(Command(f"plan d{areas} --planner {planner}", words, theirs))
    return found


def measured(command: Command) -> tuple[float, Mapping[str, float]]:
    """Seconds of CPU of one process, and of the parts that it tells."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command.words, capture_output=True, text=True, check=True, env=ENVIRONMENT)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    parts = json.loads(done.stdout)["seconds"] if command.tells else {}
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, parts


def report(command: Command, spent: Sequence[tuple[float, Mapping[str, float]]], base: float) -> str:
    """The row of a command: what its rounds took, where `import numba` takes `base`."""
    seconds = statistics.median(each for each, _ in spent)
    least = min(each for each, _ in spent)
    theirs = "" if command.theirs is None else f"{command.theirs:.2f}, {command.theirs / seconds:.1f} times"
    parts = (f"{part} {statistics.median(told[part] for _, told in spent):.3f}" for part in spent[0][1])
    cells = (f"`{command.name}`", f"{seconds:.3f}", f"{least:.3f}", f"{seconds / base:.2f}", theirs)
    return f"| {' | '.join(cells)} | {', '.join(parts)} |"


def main() -> None:
    """Print a row for each command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rounds", type=int, nargs="?", default=9)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="+", default=[""], help="rows whose names have one of these words")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [
            row
            for row in commands(Path(folder), options.seed)
            if row.name == BASE or any(word in row.name for word in options.only)
        ]
        rounds = [[measured(row) for row in rows] for _ in range(options.rounds + 1)]
    spent = dict(zip((row.name for row in rows), zip(*rounds[1:], strict=True), strict=True))
    base = statistics.median(seconds for seconds, _ in spent[BASE])
    print(f"load {os.getloadavg()[0]:.1f}; CPU seconds, medians of {options.rounds} rounds")
    print("\n| command | median | least | of `import numba` | libPRADA's | of which, by the clock |")
    print("|---|---|---|---|---|---|")
    for row in rows:
        print(report(row, spent[row.name], base))


if __name__ == "__main__":
    main()
