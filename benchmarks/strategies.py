"""All strategies on equal terms (§6.1): python benchmarks/strategies.py [--seeds N ...] [--keep FILE] ...

Carries out `cleancli execute` for every strategy on two groups and on 40 scattered lentils with three seeds,
and prints seconds, actions and lentils left, with Student's t intervals of 95 %, and what share of reactive's
time each takes: of all that is waited for, and of the robot's moving alone, which a busy machine does not
lengthen. `more`: by how much longer the robot moves than with the first strategy named, seed by seed where
both ended clean, and `p` of Wilcoxon's signed-rank test of that. A strategy is named [DOMAIN/]NAME[:PLANNER].
Times and actions are of clean runs only; how many were not clean has a column of its own. Every episode is a
line of FILE as soon as it is over; those that FILE holds are not run again, so that a run that was stopped
goes on. With `--stand-in` the fast stand-in takes the place of the physics (docs/world.md): an episode is
then a few seconds.

About 25 minutes of CPU; with `--quick` (two strategies, two groups, one seed) about half a minute.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import math
import multiprocessing
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from statistics import mean, stdev
from typing import Any

from episodes import Job, opened, planning
from kept import Kept
from scipy.stats import t, wilcoxon

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run as cleancli
from cleancli.execution.events import Ended
from cleancli.execution.loop import clean
from cleancli.execution.strategies import STRATEGIES
from cleancli.world.kinematic import KinematicTable

SCENES = ("two_groups", "scattered_40")
SEEDS = (1, 2, 3)
KINDS = ("planning", "perceiving", "extra_perceptions", "transits", "actions")
COLUMNS = (
    *("strategy", "seconds", "of reactive's", "moving", "of reactive's", "more", "p", "actions", "left"),
    *("not clean", "planning", "perceiving", "extra", "transits", "acting"),
)

Row = dict[str, Any]


def run(job: Job) -> Row:
    """One episode, by the command itself: what it took, by kind of time, and what is truly left."""
    domain, scene, named, seed = job
    strategy, planner = planning(named)
    with tempfile.TemporaryDirectory() as folder:
        words = ["execute", domain, scene, "--strategy", strategy, "--seed", str(seed)]
        words += ["--planner", planner] if planner else []
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            code = cleancli([*words, "--runs", folder, "--no-video", "--json"])
        if code not in (ExitCode.DONE, ExitCode.NOT_CLEAN):
            raise RuntimeError(f"cleancli {' '.join(words)} ended with exit code {code}")
    told = json.loads(printed.getvalue())
    episode, truth = told["episode"], told["truth"]
    return {
        "job": list(job),
        "clean": episode["clean"],
        "reason": episode["reason"],
        "actions": episode["actions"],
        "seconds": episode["seconds"],
        "left": truth["on_table"],
        "lost": truth["on_floor"],
        "ink_left": truth["ink_left"],
    }


def run_stand_in(job: Job, table: type[KinematicTable] = KinematicTable) -> Row:
    """One episode on the fast stand-in, or on another `table` like it, told in the same way."""
    setup, cell, world = opened(job, table)
    ended = next(e for e in clean(setup, cell) if isinstance(e, Ended))
    truth = world.truth()
    return {
        "job": list(job),
        "stand_in": True,
        "clean": ended.clean,
        "reason": ended.reason,
        "actions": ended.actions,
        "seconds": {**ended.spent.by_kind(), "total": ended.spent.total},
        "left": truth.on_table,
        "lost": truth.on_floor,
    }


def rows(jobs: Sequence[Job], processes: int, kept: Kept, stand_in: bool = False) -> Iterator[Row]:
    """The rows of all jobs, those that are kept first; others are added to them."""
    known = {tuple(row["job"]): row for row in kept.rows() if row.get("stand_in", False) == stand_in}
    yield from (dict(known[job]) for job in jobs if job in known)
    due = [job for job in jobs if job not in known]
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, context) as pool:
        for done in as_completed([pool.submit(run_stand_in if stand_in else run, job) for job in due]):
            kept.add(done.result())
            yield done.result()


def table(by_name: Mapping[str, Sequence[Row]]) -> Iterator[str]:
    """Lines of a table, a row a strategy; the last of each job says its seed."""
    yield f"| {' | '.join(COLUMNS)} |"
    yield "|---" * len(COLUMNS) + "|"
    rows = {name: own for name, own in by_name.items() if own}
    first = next(iter(rows.values()), ())
    reactive = [own for name, own in rows.items() if name.rpartition("/")[2] == "reactive"]
    for name, own in rows.items():
        yield _line(name, own, _clean(reactive[0]) if reactive else (), first)


def _line(name: str, own: Sequence[Row], reactive: Sequence[Row], first: Sequence[Row]) -> str:
    """A strategy's row: means over its clean runs, beside those of `reactive` and of the `first` strategy;
    what is left, over all."""
    left = sum(row["left"] + row["lost"] for row in own)
    clean = _clean(own)
    dirty = f"{len(own) - len(clean)} of {len(own)}"
    if not clean:
        return f"| {name} | | | | | | | | {left} | {dirty} |" + " |" * len(KINDS)
    totals, times = [_total(row) for row in clean], [moving(row) for row in clean]
    share = f"{mean(totals) / mean(map(_total, reactive)):.2f}" if reactive else ""
    of_moving = f"{mean(times) / mean(map(moving, reactive)):.2f}" if reactive else ""
    before = {row["job"][-1]: moving(row) for row in _clean(first)}
    paired = [moving(row) - before[row["job"][-1]] for row in clean if row["job"][-1] in before]
    took = f"{interval(totals)} | {share} | {interval(times)} | {of_moving} | {compared(paired)}"
    spent = " | ".join(f"{mean(row['seconds'][kind] for row in clean):.1f}" for kind in KINDS)
    return f"| {name} | {took} | {interval([row['actions'] for row in clean])} | {left} | {dirty} | {spent} |"


def compared(more: Sequence[float]) -> str:
    """The mean of differences, and how likely chance makes them so."""
    if not any(more):
        return "0 | " if more else " | "
    return f"{interval(more)} | {wilcoxon(more).pvalue:.1g}"


def _clean(own: Sequence[Row]) -> list[Row]:
    return [row for row in own if row["clean"]]


def _total(row: Row) -> float:
    return float(row["seconds"]["total"])


def moving(row: Row) -> float:
    """Seconds of robot time in transits and actions, which do not depend on how busy the machine is."""
    return float(row["seconds"]["transits"] + row["seconds"]["actions"])


def interval(values: Sequence[float]) -> str:
    """The mean, and how far the 95 % interval of Student's t reaches to each side."""
    if len(values) < 2:
        return f"{mean(values):.1f}"
    reach = t.ppf(0.975, len(values) - 1) * stdev(values) / math.sqrt(len(values))
    return f"{mean(values):.1f} ± {reach:.1f}"


def main() -> None:
    """Run what is missing, and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--domain", default="cleaning", help="of strategies that name none")
    parser.add_argument("--scene", nargs="+", default=SCENES)
    parser.add_argument("--strategy", nargs="+", default=list(STRATEGIES), metavar="[DOMAIN/]NAME[:PLANNER]")
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path, metavar="FILE", help="episodes run before are in it")
    parser.add_argument("--stand-in", action="store_true", help="without physics: a few seconds an episode")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.scene, options.strategy, options.seeds = ["two_groups"], ["plan-2", "reactive"], [1]
    names = {named: domain_of(named, options.domain) for named in options.strategy}
    for _, named in names.values():
        planning(named)
    jobs = [(d, c, s, n) for n in options.seeds for c in options.scene for d, s in names.values()]
    found = []
    for row in rows(jobs, options.jobs, Kept(options.keep), options.stand_in):
        found.append(row)
        print(
            f"{len(found)} of {len(jobs)}: {' '.join(map(str, row['job']))}: {_total(row):.1f} s,"
            f" {row['actions']} actions, {row['left']} left; {row['reason']}",
            flush=True,
        )
    for scene in options.scene:
        own = {
            name: [row for row in found if row["job"][:3] == [domain, scene, strategy]]
            for name, (domain, strategy) in names.items()
        }
        print("", f"{scene}\n", *table(own), sep="\n")


def domain_of(named: str, usual: str) -> tuple[str, str]:
    """The domain of a strategy that may be named with it, and its name without."""
    domain, _, strategy = named.rpartition("/")
    return domain or usual, strategy


if __name__ == "__main__":
    main()
