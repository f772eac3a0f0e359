"""A killed study goes on: `python benchmarks/study_kills.py [--kills N] [--jobs N] [--seed N]`.

A study in the symbolic world is begun, and killed with KILL at a random moment, time after time; then it goes
on to its end. Its rows must be those of a study that nobody killed, but for real time, and each episode must
have one line. With several `--jobs` their processes must be gone soon after each kill. Exits with 1 if a row
is missing, other or twice, or a process is left.

About 20 seconds of CPU with ten kills; `--quick` (three) half of that.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import psutil

from cleancli.cli.main import run as cleancli
from cleancli.experiment.rows import PARQUET, read_rows
from cleancli.experiment.store import LINES, read_finished
from cleancli.study.row import Row, comparable

STUDY = """
study killed {
  scene     = three_areas
  strategy  = plan_1, plan_2
  estimator = none, decreasing_m
  samples   = 200
  runs      = 5
  episodes  = 2
}
"""

LEFT = 20.0
"""Seconds after which processes of a killed study must be gone."""


def carried_out(study: Path, folder: Path, jobs: int) -> int:
    """The process that carries a study out, or goes on with it; it has loaded what this one has."""
    process = os.fork()
    if process:
        return process
    os.setpgrp()
    with open(os.devnull, "w", encoding="utf-8") as null:
        os.dup2(null.fileno(), 1)
        os.dup2(null.fileno(), 2)
    words = ["experiment", str(study), "--jobs", str(jobs), "--output", str(folder), "--resume"]
    os._exit(cleancli(words))


def killed(study: Path, folder: Path, jobs: int, seconds: float) -> bool:
    """Whether a study was killed after so many seconds; else it has ended before. Waits until all that it
    began is gone."""
    process = carried_out(study, folder, jobs)
    time.sleep(seconds)
    try:
        begun = psutil.Process(process).children(recursive=True)
        os.kill(process, signal.SIGKILL)
    except psutil.NoSuchProcess:
        begun = []
    _, status = os.waitpid(process, 0)
    _, left = psutil.wait_procs(begun, LEFT)
    if left:
        raise SystemExit(f"{len(left)} processes are left of a killed study")
    return os.WIFSIGNALED(status)


def rows_of(study: Path, folder: Path, jobs: int) -> list[Row]:
    """The rows of a study that nobody kills from now on. Raises SystemExit for one whose lines are wrong."""
    _, status = os.waitpid(carried_out(study, folder, jobs), 0)
    if status:
        raise SystemExit(f"the study ended with status {status}")
    found = [comparable(row) for row in read_rows(folder / PARQUET)]
    lines = (folder / LINES).read_bytes().count(b"\n")
    if not len(read_finished(folder)) == lines == len(found):
        raise SystemExit(f"{lines} lines tell of {len(found)} episodes")
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Kill, go on, compare."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true", help="three kills")
    options = parser.parse_args(arguments)
    kills = 3 if options.quick else options.kills
    rng = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as place:
        study, whole, folder = (Path(place) / name for name in ("killed.nid", "whole", "killed"))
        study.write_text(STUDY, encoding="utf-8")
        began = time.monotonic()
        expected = rows_of(study, whole, options.jobs)
        took = time.monotonic() - began
        early, late = (0.0, took / 4) if options.jobs == 1 else (took / 3, took)
        done = tries = 0
        while done < kills:
            done += killed(study, folder, options.jobs, rng.uniform(early, late))
            tries += 1
            finished = len(read_finished(folder))
            print(f"killed {done} times, {finished} of {len(expected)} episodes finished", flush=True)
        same = rows_of(study, folder, options.jobs) == expected
    print(f"{done} kills in {tries} tries: {'the same rows' if same else 'OTHER ROWS'}")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
