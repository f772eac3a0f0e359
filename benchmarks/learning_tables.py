"""What learning is worth on the table: python benchmarks/learning_tables.py [--part PART ...] ...

`harm`: on 40 scattered lentils with the grasp that the shipped rules are made for, rules are learned from ten
runs; twelve other tables are then cleaned with the shipped rules and with the learned ones, and compared pair
by pair. Learning should do no harm there.
`grasp`: a robot with another grasp (`folded`, `corner`) cleans thirty lentils, in small groups and scattered,
ten times (§6.3, Fig. 10): with the shipped rules; learning from them, by the decreasing m-estimate, by the
m-estimate and by `fitted-m`; learning from rules that were measured with the wide grasp; and with rules that
were measured with its own (docs/measurements/physics.md), about the best that can be learned. `--plot FILE`
draws actions and seconds by episode, as Fig. 10 does.

Each table is a minute of CPU: about half an hour for `harm`, and eight hours for `grasp`. With `--keep` every
episode is a line of FILE as soon as it is over, and a series that was stopped goes on behind its last one.
`--stand-in` uses the fast stand-in of the table (docs/world.md), where an episode takes a few seconds, and
which says nothing of grasps. `--quick`: two episodes of one series on it, in about twenty seconds.
"""

from __future__ import annotations

import argparse
import multiprocessing
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from itertools import chain
from pathlib import Path
from statistics import mean
from typing import Any

import msgspec
from episodes import on_table
from kept import Kept
from new_grasp import LATE, measured, true_rules
from strategies import compared, interval, moving

from cleancli.execution.believed import lesson_of
from cleancli.execution.events import Checkpoint, Ended, Looked, Purpose
from cleancli.execution.loop import clean
from cleancli.execution.setup import EpisodeOptions
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain
from cleancli.learning.estimate import FITTED
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.learn import revised
from cleancli.learning.method import DEFAULT, KNOWN, Method
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene

Row = dict[str, Any]
Series = tuple[str, str, str, int, int]
"""Part, grasp, kind, seed of the first table, and how many tables."""

KINDS = ("shipped", "learned", "m-estimate", "fitted", "from wide", "measured")
"""What a robot with another grasp goes by."""
LEARNING: Mapping[str, Method] = {
    "learned": DEFAULT,
    "m-estimate": Method("m"),
    "fitted": Method(FITTED),
    "from wide": DEFAULT,
    "taught": DEFAULT,
}
TAUGHT = 10
"""Runs that the rules of `harm` are learned from, on tables that are not compared."""

THIRTY = """
    group { count = 5  at = (-28 cm, 15 cm)  radius = 2 cm }
    group { count = 5  at = (-10 cm, -18 cm)  radius = 2 cm }
    group { count = 5  at = (5 cm, 14 cm)  radius = 2 cm }
    scattered { count = 15  from = (-38 cm, -28 cm)  to = (20 cm, 28 cm) }
"""


def scene(part: str, grasp: str) -> Scene:
    """Forty scattered lentils; or thirty, in small groups and scattered, with another grasp."""
    text = read_source(find("scattered_40", "problems")).text
    if part == "grasp":
        start = text.index("scattered {")
        end = text.index("}", start) + 1
        text = text[:start] + THIRTY + text[end:]
    return load_scene(Source("table.nid", text.replace("grasp = wide", f"grasp = {grasp}")))


def rules(kind: str, grasp: str, place: Scene) -> Domain:
    """What the robot goes by before it has learned anything."""
    shipped = load_domain(read_source(find("cleaning", "domains")))
    if kind in ("from wide", "measured"):
        return true_rules(shipped, measured(), "wide" if kind == "from wide" else grasp)
    return shipped


def series(job: Series, stand_in: bool, before: Sequence[Row], evidence: Evidence, kept: Kept) -> list[Row]:
    """The rows of a series' episodes, of which some were carried out `before`; each is kept. What was learned
    goes on from one to the next."""
    part, grasp, kind, first, tables = job
    place = scene(part, grasp)
    domain = rules(kind, grasp, place)
    if kind == "taught by others":
        domain = revised(domain, lesson_of(domain, evidence, DEFAULT))
    found = list(before)
    if found:
        evidence = msgspec.convert(found[-1]["evidence"], Evidence)
    for number in range(len(found), tables):
        row, evidence = episode(domain, place, LEARNING.get(kind), first + number, evidence, stand_in)
        found.append({"job": list(job), "number": number, "stand_in": stand_in, **row})
        kept.add(found[-1])
    return found


def episode(
    domain: Domain, place: Scene, method: Method | None, seed: int, evidence: Evidence, stand_in: bool
) -> tuple[Row, Evidence]:
    """One table: what it took by kind of time, and what there is to learn from after it."""
    known = 0 if method is None else KNOWN
    options = EpisodeOptions(seed=seed, by_time=True, known=known, learning=method)
    unknown = 0
    with on_table(domain, place, options, stand_in) as (setup, cell, world):
        for event in clean(replace(setup, evidence=evidence), cell):
            if isinstance(event, Looked):
                unknown += event.purpose is Purpose.LEARNING
            elif isinstance(event, Checkpoint):
                evidence = event.state.evidence
            elif isinstance(event, Ended):
                ended = event
        truth = world.truth()
    return {
        "clean": ended.clean,
        "actions": ended.actions,
        "unknown": unknown,
        "seconds": {**ended.spent.by_kind(), "total": ended.spent.total},
        "left": truth.on_table + truth.on_floor,
        "evidence": msgspec.to_builtins(evidence),
    }, evidence


# ---- the parts


def harm(found: Mapping[Series, Sequence[Row]]) -> Iterator[str]:
    """The learned rules against the shipped ones, table by table."""
    by_kind = {job[2]: rows for job, rows in found.items()}
    pairs = list(zip(by_kind["shipped"], by_kind["taught by others"], strict=True))
    both = [(one, other) for one, other in pairs if one["clean"] and other["clean"]]
    yield "| rules | moving | total | actions | not clean |"
    yield "|---|---|---|---|---|"
    for index, name in enumerate(("shipped", "learned")):
        rows = [pair[index] for pair in both]
        cells = [interval(list(map(moving, rows))), interval([row["seconds"]["total"] for row in rows])]
        dirty = sum(not pair[index]["clean"] for pair in pairs)
        yield f"| {name} | {' | '.join(cells)} | {interval([row['actions'] for row in rows])} | {dirty} |"
    more = [moving(other) - moving(one) for one, other in both]
    yield f"learned less shipped, moving, and p of Wilcoxon's test: {compared(more)}"


def grasps(found: Mapping[Series, Sequence[Row]]) -> Iterator[str]:
    """Of each grasp and kind seconds by episode, and what it comes to late."""
    for grasp in dict.fromkeys(job[1] for job in found):
        yield from ("", f"{grasp}\n")
        yield "| rules | moving by episode | actions by episode | unknown | late | learning | not clean |"
        yield "|---|---|---|---|---|---|---|"
        for kind in dict.fromkeys(job[2] for job in found if job[1] == grasp):
            runs = [rows for job, rows in found.items() if job[1:3] == (grasp, kind)]
            yield f"| {kind} | {' | '.join(_cells(runs))} |"


def _cells(runs: Sequence[Sequence[Row]]) -> Iterator[str]:
    by_episode = list(zip(*runs, strict=True))
    yield " ".join(f"{mean(map(moving, rows)):.0f}" for rows in by_episode)
    yield " ".join(f"{mean(row['actions'] for row in rows):.0f}" for rows in by_episode)
    yield " ".join(f"{mean(row['unknown'] for row in rows):.0f}" for rows in by_episode)
    late = min(LATE, len(by_episode)) - 1
    yield interval([mean(map(moving, rows[late:])) for rows in runs])
    yield interval([sum(row["seconds"]["learning"] for row in rows) for rows in runs])
    yield str(sum(not row["clean"] for row in chain.from_iterable(runs)))


def draw(found: Mapping[Series, Sequence[Row]], file: Path) -> None:
    """Actions by episode and those that were unknown; time by kind while learning; time by estimator."""
    from matplotlib.figure import Figure

    names = list(dict.fromkeys(job[1] for job in found))
    figure = Figure(figsize=(12, 3.6 * len(names)), layout="constrained")
    axes = figure.subplots(len(names), 3, squeeze=False)
    for (first, second, third), grasp in zip(axes, names, strict=True):
        by_kind: dict[str, list[Sequence[Row]]] = {}
        for job, rows in found.items():
            if job[1] == grasp:
                by_kind.setdefault(job[2], []).append(rows)
        learned = list(zip(*by_kind["learned"], strict=True))
        episodes = range(1, len(learned) + 1)
        for key in ("actions", "unknown"):
            first.plot(episodes, [mean(row[key] for row in rows) for rows in learned], marker="o", label=key)
        bottom = [0.0] * len(learned)
        for key in (key for key in learned[0][0]["seconds"] if key != "total"):
            heights = [mean(row["seconds"][key] for row in rows) for rows in learned]
            second.bar(episodes, heights, bottom=bottom, label=key.replace("_", " "))
            bottom = [low + height for low, height in zip(bottom, heights, strict=True)]
        for kind, runs in by_kind.items():
            totals = [mean(row["seconds"]["total"] for row in rows) for rows in zip(*runs, strict=True)]
            third.plot(episodes, totals, marker="o", label=kind)
        first.set(title=f"{grasp}: actions", ylim=(0, None))
        second.set(title=f"{grasp}: seconds while learning")
        third.set(title=f"{grasp}: seconds", ylim=(0, None))
        for each in (first, second, third):
            each.set_xlabel("episode")
            each.legend(fontsize="small")
    figure.savefig(file)


# ---- all of it


def carried_out(
    jobs: Sequence[Series], options: argparse.Namespace, evidence: Evidence
) -> dict[Series, list[Row]]:
    """The rows of all series; what is missing is carried out, some series at a time."""
    kept = Kept(options.keep)
    before: dict[Series, list[Row]] = {job: [] for job in jobs}
    for row in kept.rows():
        own = before.get(tuple(row["job"]))
        if own is not None and row["stand_in"] == options.stand_in and row["number"] == len(own):
            own.append(dict(row))
    found: dict[Series, list[Row]] = {}
    with ProcessPoolExecutor(options.jobs, multiprocessing.get_context("spawn")) as pool:
        todo = {pool.submit(series, job, options.stand_in, before[job], evidence, kept): job for job in jobs}
        for done in as_completed(todo):
            job = todo[done]
            found[job] = done.result()
            seconds = " ".join(f"{moving(row):.0f}" for row in found[job])
            print(f"{len(found)} of {len(jobs)}: {' '.join(map(str, job))}: {seconds}", flush=True)
    return {job: found[job] for job in jobs}


def main() -> None:
    """Carry out what is missing, and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--part", nargs="+", choices=["harm", "grasp"], default=["harm", "grasp"])
    parser.add_argument("--grasp", nargs="+", choices=["folded", "corner"], default=["folded", "corner"])
    parser.add_argument("--kind", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--seed", type=int, default=1, help="what all tables are drawn from")
    parser.add_argument("--seeds", type=int, default=5, help="series of each kind")
    parser.add_argument("--episodes", type=int, default=10)
    parser.add_argument("--tables", type=int, default=12, help="that are compared in `harm`")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path, metavar="FILE", help="episodes carried out before are in it")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw Fig. 10 of `grasp`; needs matplotlib")
    parser.add_argument("--stand-in", action="store_true")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.stand_in, options.part, options.kind = True, ["grasp"], ["learned"]
        options.grasp, options.seeds, options.episodes = ["folded"], 1, 2
    start = 1000 * options.seed
    if "harm" in options.part:
        (teaching,) = carried_out([("harm", "wide", "taught", start, TAUGHT)], options, NO_EVIDENCE).values()
        evidence = msgspec.convert(teaching[-1]["evidence"], Evidence)
        kinds = ("shipped", "taught by others")
        jobs = [("harm", "wide", kind, start + 100, options.tables) for kind in kinds]
        print(*harm(carried_out(jobs, options, evidence)), sep="\n")
    if "grasp" in options.part:
        seeds = [start + 200 + 20 * number for number in range(options.seeds)]
        jobs = [
            ("grasp", grasp, kind, seed, options.episodes)
            for seed in seeds
            for grasp in options.grasp
            for kind in options.kind
        ]
        found = carried_out(jobs, options, NO_EVIDENCE)
        print(*grasps(found), sep="\n")
        if options.plot is not None:
            draw(found, options.plot)


if __name__ == "__main__":
    main()
