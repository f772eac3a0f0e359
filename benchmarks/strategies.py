"""All strategies on equal terms (§6.1): python benchmarks/strategies.py [--jobs N] [--keep FILE]

Runs every strategy on two groups and on 40 scattered lentils with three seeds, and prints seconds, actions
and lentils left, with Student's t intervals of 95 %, and what share of reactive's time each takes: of all
that is waited for, and of the robot's moving alone, which a busy machine does not lengthen. Every episode is
a line of FILE as soon as it is over; those that FILE holds are not run again, so that a run that was stopped
goes on. About 25 minutes of CPU. `--quick`: two strategies, two groups, one seed.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import closing
from pathlib import Path
from statistics import mean, stdev
from typing import Any

from scipy.stats import t

from cleancli.execution.events import Ended, Looked
from cleancli.execution.loop import clean
from cleancli.execution.setup import EpisodeOptions
from cleancli.execution.site import table_site
from cleancli.execution.strategies import STRATEGIES
from cleancli.language.edit import replace_file
from cleancli.language.load import load_domain, read_source
from cleancli.scene.check import load_scene
from cleancli.shipped import find

SCENES = ("two_groups", "scattered_40")
SEEDS = (1, 2, 3)
COLUMNS = (
    *("strategy", "seconds", "of reactive's", "moving", "of reactive's", "actions", "left", "not clean"),
    *("planning", "perceiving", "extra", "transits", "acting"),
)

Job = tuple[str, str, str, int]
"""Domain, scene, strategy, seed."""
Row = dict[str, Any]


def run(job: Job) -> Row:
    """One episode: what it took, by kind of time, and what is truly left."""
    domain_name, scene_name, strategy, seed = job
    domain = load_domain(read_source(find(domain_name, "domains")))
    scene = load_scene(read_source(find(scene_name, "problems")))
    with closing(table_site(domain, scene, EpisodeOptions(strategy, seed=seed, by_time=True))) as site:
        looks = 0
        for event in clean(site.setup, site.cell):
            looks += isinstance(event, Looked)
        assert isinstance(event, Ended)
        truth = site.truth()
    return {
        "job": list(job),
        "clean": event.clean,
        "reason": event.reason,
        "actions": event.actions,
        "looks": looks,
        "seconds": event.spent.by_kind(),
        "total": event.spent.total,
        "left": truth["on_table"],
        "lost": truth["on_floor"],
    }


def rows(jobs: Sequence[Job], processes: int, kept: Path | None) -> Iterator[Row]:
    """The rows of all jobs, those that `kept` holds first; others are added to it."""
    known = _kept(kept)
    yield from (known[job] for job in jobs if job in known)
    due = [job for job in jobs if job not in known]
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, context) as pool:
        for done in as_completed([pool.submit(run, job) for job in due]):
            if kept is not None:
                with kept.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(done.result()) + "\n")
            yield done.result()


def _kept(path: Path | None) -> dict[Job, Row]:
    """What a file holds; a last line that was cut short is taken out."""
    if path is None or not path.exists():
        return {}
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    whole = [line for line in lines if line.endswith("\n")]
    if whole != lines:
        replace_file(path, "".join(whole))
    return {tuple(row["job"]): row for row in map(json.loads, whole)}


def table(found: Sequence[Row], scene: str, strategies: Sequence[str]) -> Iterator[str]:
    """Lines of a table, a row a strategy."""
    by_strategy = {s: [r for r in found if r["job"][1:3] == [scene, s]] for s in strategies}
    yield f"{scene}\n"
    yield f"| {' | '.join(COLUMNS)} |"
    yield "|---" * len(COLUMNS) + "|"
    reactive = by_strategy.get("reactive", [])
    for strategy, own in by_strategy.items():
        totals = [row["total"] for row in own]
        if not totals:
            continue
        kinds = ("planning", "perceiving", "extra_perceptions", "transits", "actions")
        spent = " | ".join(f"{mean(row['seconds'][kind] for row in own):.1f}" for kind in kinds)
        moving = mean(_moving(row) for row in own)
        share = f"{mean(totals) / mean(row['total'] for row in reactive):.2f}" if reactive else ""
        of_moving = f"{moving / mean(_moving(row) for row in reactive):.2f}" if reactive else ""
        left = sum(row["left"] + row["lost"] for row in own)
        dirty = sum(not row["clean"] for row in own)
        actions = interval([row["actions"] for row in own])
        took = f"{interval(totals)} | {share} | {moving:.1f} | {of_moving}"
        yield f"| {strategy} | {took} | {actions} | {left} | {dirty} | {spent} |"


def _moving(row: Row) -> float:
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
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--domain", default="cleaning")
    parser.add_argument("--scene", nargs="+", default=SCENES)
    parser.add_argument("--strategy", nargs="+", choices=list(STRATEGIES), default=list(STRATEGIES))
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.scene, options.strategy, options.seeds = ["two_groups"], ["plan-2", "reactive"], [1]
    jobs = [(options.domain, c, s, n) for n in options.seeds for c in options.scene for s in options.strategy]
    found = []
    for row in rows(jobs, options.jobs, options.keep):
        found.append(row)
        print(
            f"{len(found)} of {len(jobs)}: {' '.join(map(str, row['job']))}: {row['total']:.1f} s,", end=" "
        )
        print(f"{row['actions']} actions, {row['left']} left; {row['reason']}", flush=True)
    for scene in options.scene:
        print("", *table(found, scene, options.strategy), sep="\n")


if __name__ == "__main__":
    main()
