"""The product against another reading of the documents: `python benchmarks/differential.py`.

Draws domains with every construct and their problems, and compares what the product says of them with what
the interpreter in tests/support/differential says, which was written from docs/language.md and
docs/planning.md alone: transitions, rewards, values of sequences and of the best policy, plans, `explain`,
`plan --explain`, drawn frequencies, closed loops, learned numbers, `compare-rules` and the environment for
Gymnasium. Domains that the checker refuses are looked at (no state may contradict the refusal), and do not
count. The files of a domain with a difference are kept in FOLDER, and the exit code is 1. 5,000 domains take
about 15 minutes on two free cores, 30 some 20 seconds. A run that is started again with the same FOLDER and
seed goes on where it stopped.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import fields
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from support.differential.comparing import compare
from support.differential.comparison import Comparison, unlikely

APART = 1_000_000
"""Seeds of domains that belong to one `--seed`."""
RARE = 1e-6
EVERY = 10.0
"""Seconds between two lines of progress."""


def compared(seed: int) -> tuple[Comparison, dict[str, str]]:
    """The comparison of a seed, and the files of its domain where there is a difference."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            found = compare(seed, Path(folder))
        except Exception:
            found = Comparison(seed)
            found.differ("exception", traceback.format_exc(limit=-6))
        files = {path.name: path.read_text(encoding="utf-8") for path in Path(folder).iterdir()}
    return found, files if found.differences else {}


def kept(folder: Path, first: int) -> list[Comparison]:
    """What earlier runs of the same seed found; a last line that was cut short counts for nothing."""
    path = folder / "compared.jsonl"
    if not path.exists():
        return []
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    rows = [json.loads(line) for line in lines if line.endswith("\n")]
    path.write_text("".join(line for line in lines if line.endswith("\n")), encoding="utf-8")
    return [
        Comparison(**row | {"refused": tuple(row["refused"]), "compared": Counter(row["compared"])})
        for row in rows
        if first <= row["seed"] < first + APART
    ]


def keep(folder: Path, found: Comparison, files: dict[str, str]) -> None:
    """Adds a line, and for a difference the files with what differs."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "compared.jsonl").open("a", encoding="utf-8") as file:
        row = {each.name: getattr(found, each.name) for each in fields(found)}
        file.write(json.dumps(row) + "\n")
    if files:
        own = folder / f"seed-{found.seed}"
        shutil.rmtree(own, ignore_errors=True)
        own.mkdir()
        for name, text in files.items():
            (own / name).write_text(text, encoding="utf-8")
        (own / "differences.txt").write_text("\n".join([*found.differences, ""]), encoding="utf-8")


def comparisons(seeds: Sequence[int], jobs: int) -> Iterator[tuple[Comparison, dict[str, str]]]:
    if jobs == 1:
        yield from map(compared, seeds)
        return
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        yield from pool.imap_unordered(compared, seeds)


def run(domains: int, first: int, folder: Path, jobs: int) -> list[Comparison]:
    """Compares until so many domains were accepted; tells how far it is on standard error."""
    found = kept(folder, first)
    done = {each.seed for each in found}
    started = told = time.monotonic()
    seed = first
    while (missing := domains - sum(not each.refused for each in found)) > 0:
        batch = [each for each in range(seed, seed + missing + 2 * jobs) if each not in done]
        seed += missing + 2 * jobs
        for each, files in comparisons(batch, jobs):
            found.append(each)
            keep(folder, each, files)
            for text in each.differences:
                print(f"seed {each.seed}: {text[:300]}", flush=True)
            if time.monotonic() - told > EVERY:
                told = time.monotonic()
                accepted = sum(not each.refused for each in found)
                print(f"{accepted} of {domains} domains, {told - started:.0f} s", file=sys.stderr)
            if sum(not each.refused for each in found) == domains:
                break
    return found


def report(found: Sequence[Comparison]) -> bool:
    """Prints what was compared how often; true where nothing differs."""
    total, refusals = Counter[str](), Counter[str]()
    for each in found:
        total += each.compared
        refusals.update(code for code in each.refused)
    print("\n| compared | times |\n|---|---|")
    for what, number in sorted(total.items()):
        print(f"| {what} | {number} |")
    print("\nrefused: " + ", ".join(f"{number} {code}" for code, number in sorted(refusals.items())))
    chance = unlikely(found)
    print(f"all drawn frequencies together: p = {chance:.3g}")
    different = sum(bool(each.differences) for each in found)
    accepted = sum(not each.refused for each in found)
    print(
        f"{different} domains with a difference, of {accepted} accepted and {len(found) - accepted} refused"
    )
    return different == 0 and chance > RARE


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--domains", type=int, default=5000, help="so many that the checker accepts [5000]")
    parser.add_argument("--seed", type=int, default=1, help="another one draws other domains [1]")
    parser.add_argument("--jobs", type=int, default=2, help="processes [2]")
    parser.add_argument("--keep", type=Path, help="FOLDER for results and for domains with a difference")
    parser.add_argument("--only", type=int, help="compare the domain of this number alone, as tests print it")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        if options.only is not None:
            found, files = compared(options.only)
            keep(folder, found, files)
            print("\n".join([*files.values(), *found.differences]))
            sys.exit(1 if found.differences else 0)
        found_all = run(options.domains, options.seed * APART, folder, options.jobs)
        sys.exit(0 if report(found_all) else 1)


if __name__ == "__main__":
    main()
