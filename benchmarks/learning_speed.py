"""How fast `cleancli learn` is: python benchmarks/learning_speed.py [--structure] [--seed N] [--quick]

Draws 1,000 transitions of `cleaning` on walks from random tables, as benchmarks/learning.py does, and writes
them as lines of experience over and over, each time as of another seed, up to N lines (100,000). Measures the
CPU seconds and the memory of a process that learns from a tenth of them, and from all, up to the diff.
With `--structure` it learns whole rules from the vocabulary alone, also from a hundredth of the lines. All
are drawn then: by copies chance would look like rules.

About twenty seconds of CPU, with `--structure` three minutes, most of which draw. `--quick` has 2,000 lines,
in about eight.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from cleancli.learning.experience import encode
from learning import DRAW, draw

DRAWN = 1000
"""Transitions that differ by more than where they came from, where probabilities alone are learned."""


def lines(seed: int, most: int) -> list[tuple[int, str]]:
    """Of transitions that are drawn: the number of each, and its line without the end that names its
    seed."""
    rng = np.random.default_rng(seed)
    domain, _ = DRAW["cleaning"](rng)
    drawn = islice(draw("cleaning", domain, rng), most)
    timed = {"transit": 1.5, "planner": "prada+"}
    return [
        (number, encode(each.transition, timed | {"seconds": round(float(rng.uniform(4, 12)), 3)}))
        for number, each in enumerate(drawn, start=1)
    ]


def write(path: Path, drawn: Sequence[tuple[int, str]], transitions: int) -> None:
    """So many lines, each by its seed and number another one."""
    with path.open("w", encoding="utf-8") as file:
        for index in range(transitions):
            number, line = drawn[index % len(drawn)]
            file.write(f'{line[:-1]}, "seed": {index // len(drawn) + 1}, "number": {number}}}\n')


LEARN = """
import resource, sys
from cleancli.cli.main import run
code = run(["learn", *sys.argv[1:]])
used = resource.getrusage(resource.RUSAGE_SELF)
own = [line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM")]
print(code, used.ru_utime + used.ru_stime, int(own[0]) / 1024, file=sys.stderr)
"""
"""The most memory is asked of the system's table, since that of `resource` begins with that of who started
the process."""


NUMBERS, RULES = ("cleaning",), ("--structure", "--jobs", "1", "--vocabulary", "cleaning")
"""What is learned: the probabilities of the shipped rules, or whole rules."""


def measured(path: Path, options: Sequence[str]) -> tuple[float, float]:
    """CPU seconds and MiB of a process that learns from a file."""
    command = [sys.executable, "-c", LEARN, *options, str(path)]
    done = subprocess.run(command, capture_output=True, text=True)
    code, seconds, memory = done.stderr.split()[-3:]
    if code != "0":
        raise SystemExit(f"cleancli learn ended with {code}")
    return float(seconds), float(memory)


def main() -> None:
    """Write the files, learn from them, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--transitions", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1, help="of the transitions that are drawn")
    parser.add_argument("--structure", action="store_true", help="whole rules")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    most = 2000 if options.quick else options.transitions
    drawn = lines(options.seed, most if options.structure else DRAWN)
    shares, learn = ((100, 10, 1), RULES) if options.structure else ((10, 1), NUMBERS)
    print("| transitions | seconds of CPU | memory |\n|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for number in (most // share for share in shares):
            path = Path(folder) / f"{number}.jsonl"
            write(path, drawn, number)
            seconds, memory = measured(path, learn)
            print(f"| {number:,} | {seconds:.1f} | {memory:.0f} MiB |", flush=True)


if __name__ == "__main__":
    main()
