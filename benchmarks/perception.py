"""How well perception sees, against the truth of 300 simulated tables, and how long its steps take.

    python benchmarks/perception.py [--frames 300] [--clean 500] [--first 0] [--keep FILE] [--worst FOLDER]

Needs pybullet. Every table has a seed of its own, which draws what lies on it, how it looks, how it is lit,
from where the camera looks, and whether the tool is in view. Its thresholds are those of a calibration on the
same table without dirt, as §3.1 does it. docs/perception.md says what counts as visible, found and right.

300 tables and 500 clean frames take about 15 minutes of CPU. It says how many are done; with --keep each
table is a line of FILE, and those that stand there are not looked at again.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

import cv2
import msgspec
import numpy as np
from kept import Kept
from perception_tables import Condition, calibrated, drawn, in_view, look, withdrawn
from perception_truth import Comparison, compared, truth_of

from cleancli.geometry.rgbd import Frame
from cleancli.perception import geometry
from cleancli.perception.look import FRAMES_PER_LOOK
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.pictures import outline
from cleancli.world.table import PybulletTable

SYMBOLS = "size", "scattered", "near", "traversal"


@dataclass(frozen=True)
class Result:
    """What came of one table; seconds by step."""

    seed: int
    condition: Condition
    came: Comparison
    seconds: dict[str, float]


def main() -> None:
    """Measure, and print the tables; with --worst, write pictures of the 12 worst frames."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--clean", type=int, default=500)
    parser.add_argument("--first", "--seed", type=int, default=0, help="the seed of the first table")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="tables seen before are in it")
    parser.add_argument("--worst", type=Path)
    asked = parser.parse_args()
    cv2.setNumThreads(1)
    results = list(seen(range(asked.first, asked.first + asked.frames), Kept(asked.keep)))
    report(results)
    timing([each.seconds for each in results])
    if asked.clean:
        print(f"clean surfaces: {clean(asked.clean, asked.first)} areas in {asked.clean} frames")
    if asked.worst is not None:
        asked.worst.mkdir(parents=True, exist_ok=True)
        for number, result in enumerate(sorted(results, key=badness, reverse=True)[:12], start=1):
            one(result.seed, asked.worst / f"{number:02}-seed-{result.seed}.png")


def seen(seeds: Sequence[int], kept: Kept) -> Iterator[Result]:
    """What comes of each table, those that are kept first looked up."""
    known = {row["seed"]: row for row in kept.rows()}
    for number, seed in enumerate(seeds, start=1):
        if seed not in known:
            known[seed] = msgspec.to_builtins(one(seed, None), enc_hook=_plain)
            kept.add(known[seed])
        yield msgspec.convert(known[seed], Result, dec_hook=lambda kind, value: np.array(value))
        if number % 25 == 0:
            print(f"{number} of {len(seeds)} tables", file=sys.stderr, flush=True)


def _plain(value: object) -> object:
    """What JSON does not know, as something that it does."""
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def one(seed: int, picture: Path | None) -> Result:
    """Build, calibrate, look, compare."""
    scene, condition, extra = drawn(seed)
    rng = np.random.default_rng([seed, 1])
    scene = calibrated(scene, seed, extra, rng)
    with closing(PybulletTable(scene, seed)) as table:
        if condition.tool == "away":
            withdrawn(table)
        else:
            in_view(table, scene, rng)
        frames = look(table, scene, FRAMES_PER_LOOK, extra, rng)
        truth = truth_of(table, frames[0].camera, scene)
    seen = perceive(frames, scene, rng)
    came = compared(truth, seen, scene)
    if picture is not None:
        draw(picture, frames[-1], seen, came)
    return Result(seed, condition, came, dict(seen.seconds))


def report(results: Sequence[Result]) -> None:
    """A row for all tables and one for each value of each condition, then the symbols."""
    head = f"{'condition':22}{'tables':>7}{'visible':>8}{'missed':>7}{'false':>6}{'recall':>8}{'precis.':>8}"
    symbols = "".join(f"{name[:8]:>9}" for name in SYMBOLS)
    print(head + f"{'count±1':>8}{'median':>8}{'95 %':>8}  mm{symbols}")
    print(row("all", results))
    for name in Condition.__annotations__:
        for value in sorted({getattr(each.condition, name) for each in results}):
            print(row(f"{name} {value}", [r for r in results if getattr(r.condition, name) == value]))
    for symbol in results[0].came.symbols:
        same, asked = agreed(symbol, results)
        print(f"{symbol:16} {same:6} of {asked:6} agree: {same / max(asked, 1):.3f}")


def row(name: str, results: Sequence[Result]) -> str:
    """Counts, errors of centres in mm, and shares of symbols that agree."""
    comes = [r.came for r in results]
    visible, found, false = (sum(getattr(c, key) for c in comes) for key in ("visible", "found", "false"))
    right = np.mean([c.miscounted <= 1 for c in comes])
    errors = np.sort([error for c in comes for error in c.centres])
    middle, high = (errors[int(share * (len(errors) - 1))] if len(errors) else 0.0 for share in (0.5, 0.95))
    recall, precision = found / max(visible, 1), found / max(found + false, 1)
    counts = f"{name:22}{len(results):7}{visible:8}{visible - found:7}{false:6}{recall:8.4f}{precision:8.4f}"
    shares = (same / asked if asked else 1.0 for same, asked in (agreed(s, results) for s in SYMBOLS))
    return f"{counts}{right:8.3f}{1e3 * middle:8.2f}{1e3 * high:8.2f}    " + "".join(
        f"{s:9.3f}" for s in shares
    )


def agreed(symbol: str, results: Sequence[Result]) -> tuple[int, int]:
    """How often both say the same of a symbol, and how often that was asked."""
    same, asked = (sum(r.came.symbols[symbol][i] for r in results) for i in (0, 1))
    return same, asked


def badness(result: Result) -> float:
    """How bad a table is seen: particles missed, patches made up, areas too many or too few, centres off."""
    came = result.came
    far = sum(min(error, 0.1) for error in came.centres)
    return len(came.missed) + 3 * came.false + 2 * came.miscounted + 20 * far


def timing(looks: Sequence[dict[str, float]]) -> None:
    """Milliseconds by step; steps that are done for every frame are given for one."""
    print(f"{'step':12}{'median':>8}{'95 %':>8}  ms a frame")
    each = {"surface", "edges", "background", "median"}
    totals = np.zeros(len(looks))
    for step in looks[0]:
        values = 1e3 * np.array([look[step] for look in looks]) / (FRAMES_PER_LOOK if step in each else 1)
        totals += values
        print(f"{step:12}{median(values):8.2f}{np.quantile(values, 0.95):8.2f}")
    print(f"{'total':12}{median(totals):8.2f}{np.quantile(totals, 0.95):8.2f}")


def clean(count: int, first: int) -> int:
    """How many areas are seen in frames of clean surfaces, 25 of each table, every frame by itself."""
    areas = 0
    for number in range(-(-count // 25)):
        scene, _, extra = drawn(first + 10_000 + number)
        rng = np.random.default_rng([first + number, 2])
        scene = calibrated(scene, first + number, extra, rng)
        with closing(PybulletTable(replace(scene, dirt=()), first + number + 1)) as table:
            withdrawn(table)
            for frame in look(table, scene, min(25, count - 25 * number), extra, rng):
                areas += len(perceive([frame], scene, rng).areas)
    return areas


def draw(path: Path, frame: Frame, seen: Observation, came: Comparison) -> None:
    """The frame with true ellipses in green, seen ones in red, and particles that were missed in yellow."""
    picture = cv2.cvtColor(frame.colour, cv2.COLOR_RGB2BGR)
    for areas, colour in ((came.true, (0, 160, 0)), (seen.areas, (0, 0, 220))):
        lines = [outline(area.ellipse, frame.camera) for area in areas]
        cv2.polylines(picture, lines, True, colour, 1, cv2.LINE_AA)
    for place in came.missed:
        column, line = np.rint(geometry.project(frame.camera, place[None]))[0].astype(int)
        cv2.circle(picture, (int(column), int(line)), 6, (0, 220, 255), 1, cv2.LINE_AA)
    cv2.imwrite(str(path), picture)


if __name__ == "__main__":
    main()
