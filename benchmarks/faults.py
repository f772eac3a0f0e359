"""Runs killed at random moments: `python benchmarks/faults.py [--symbolic N] [--tables N] [--seed N]`.

Each run is killed (SIGKILL) at a moment drawn evenly over the time that a whole one takes from the first
line of its journal to its end, and once more with probability one half after it was resumed; then it goes on
to its end. After each kill every file must be readable: run.json, all whole lines of journal and experience,
the checkpoint. Exits with 1 if one is not, or a run does not end. A line each ten runs; the usual 100 and 10
take about ten minutes.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from cleancli.recording import checkpoint
from cleancli.recording.folder import EXPERIENCE, JOURNAL, checkpoints
from cleancli.recording.journal import Ended, read_journal

POLL = 2e-3  # seconds between looks at the journal
PROBLEMS = {"symbolic": "three_areas", "tables": "two_groups"}


def command(*words: str) -> list[str]:
    return [sys.executable, "-m", "cleancli.cli.main", "execute", *words, "--quiet"]


def unreadable(folder: Path) -> str:
    """Why a file of a run that was cut short cannot be read; nothing if all can."""
    try:
        json.loads((folder / "run.json").read_text(encoding="utf-8"))
        if (folder / JOURNAL).exists():
            read_journal(folder)
        experience = folder / EXPERIENCE
        for line in experience.read_text(encoding="utf-8").split("\n")[:-1] if experience.exists() else ():
            json.loads(line)
        for path in checkpoints(folder)[-1:]:
            checkpoint.read(folder, path)
    except Exception as error:
        return repr(error)
    return ""


def at_work(words: list[str], folder: Path, cwd: Path) -> subprocess.Popen[bytes] | None:
    """A process that has added to the run's journal, or None where it ended before it did."""
    journal = folder / JOURNAL
    before = journal.stat().st_size if journal.exists() else 0
    process = subprocess.Popen(command(*words), cwd=cwd, stderr=subprocess.DEVNULL)
    while not journal.exists() or journal.stat().st_size <= before:
        if process.poll() is not None:
            return None
        time.sleep(POLL)
    return process


def killed(words: list[str], seconds: float, folder: Path, cwd: Path) -> bool:
    """Whether the process was still at work so many seconds after its first line, and was killed."""
    process = at_work(words, folder, cwd)
    if process is None:
        return False
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return True
    return False


def working_time(problem: str, seed: int, cwd: Path) -> float:
    """Seconds from the first line of a whole run's journal to its end."""
    folder = cwd / "whole" / f"{problem}-seed{seed}-001"
    words = ["cleaning", problem, "--seed", str(seed), "--no-video", "--runs", "whole"]
    process = at_work(words, folder, cwd)
    assert process is not None, "a run that nobody kills writes a journal"
    started = time.perf_counter()
    process.wait()
    return time.perf_counter() - started


def survived(problem: str, seed: int, whole: float, rng: random.Random, cwd: Path) -> tuple[int, str]:
    """How often a run was killed, and what went wrong, if anything did."""
    words = ["cleaning", problem, "--seed", str(seed), "--no-video"]
    folder = cwd / "runs" / f"{problem}-seed{seed}-001"
    kills = 0
    while killed(words, rng.uniform(0, whole), folder, cwd):
        kills += 1
        why = unreadable(folder)
        if why:
            return kills, why
        words = ["--resume", str(folder)]
        if rng.random() < 0.5:
            break
    if json.loads((folder / "run.json").read_text(encoding="utf-8")).get("episode") is None:
        ended = subprocess.run(command("--resume", str(folder)), cwd=cwd, capture_output=True, text=True)
        if ended.returncode not in (0, 3):
            return kills, f"resume: exit code {ended.returncode}: {ended.stderr}"
    last = read_journal(folder).records[-1]
    return kills, "" if isinstance(last, Ended) else f"the last line is {last}"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--symbolic", type=int, default=100)
    parser.add_argument("--tables", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    failures = 0
    for kind, problem in PROBLEMS.items():
        rng, kills, number = random.Random(asked.seed), 0, getattr(asked, kind)
        with tempfile.TemporaryDirectory() as temporary:
            cwd = Path(temporary)
            started = time.perf_counter()
            whole = working_time(problem, asked.seed, cwd) if number else 0.0
            for seed in range(asked.seed, asked.seed + number):
                died, wrong = survived(problem, seed, whole, rng, cwd)
                kills += died
                if wrong:
                    failures += 1
                    print(f"{kind} {seed}: {wrong}", flush=True)
                if (seed - asked.seed) % 10 == 9:
                    print(f"{kind}: {seed - asked.seed + 1} of {number} runs", flush=True)
        spent = time.perf_counter() - started
        print(f"{kind}: {number} runs, {kills} kills, {failures} failures so far; {spent:.0f} s", flush=True)
    print(f"load {os.getloadavg()[0]:.1f}")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
