"""A learner's curve beside a planner: python benchmarks/learner.py [--keep ROWS] [--episodes N] [--seed N]

Tells, from the rows of `python examples/train_symbolic.py --keep ROWS`, what MaskablePPO returns after how
many seconds of training, and beside it actions drawn at random and a planner in the same problem. What the
planner returns is added to the rows where it is not in them, which takes two minutes.
benchmarks/pictures.py draws it.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

import cleancli

ROOT = Path(__file__).parent.parent
ROWS = ROOT / "benchmarks" / "results" / "learner.jsonl"
PROBLEM = ROOT / "examples" / "forty_lentils.nid"
LEARNER, RANDOM, PLANNER = "MaskablePPO", "random", "prada+"
COLOURS = {LEARNER: "#0072b2", RANDOM: "#777777", PLANNER: "#d55e00"}

Row = Mapping[str, Any]
"""`policy`, `seed`, `seconds` of training, `steps` until then, and of so many `episodes` the mean `return`
and its standard deviation `sd`."""


def read(path: Path) -> list[Row]:
    """The rows of a file."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def planned(episodes: int, seed: int) -> Row:
    """What the planner returns: in each episode it plans anew after each action."""
    found = cleancli.simulate("sweeping", PROBLEM, planner=PLANNER, episodes=episodes, seed=seed)
    returns = [episode.plain for episode in found.episodes[0]]
    row = {"problem": PROBLEM.stem, "policy": PLANNER, "seed": seed, "seconds": 0.0, "steps": 0}
    return row | {"episodes": episodes, "return": round(fmean(returns), 3), "sd": round(stdev(returns), 3)}


def curves(rows: Iterable[Row]) -> dict[int, list[Row]]:
    """The learner's rows by seed, in the order of time."""
    found = defaultdict(list)
    for row in sorted(rows, key=lambda row: float(row["seconds"])):
        if row["policy"] == LEARNER:
            found[int(row["seed"])].append(row)
    return dict(sorted(found.items()))


def half_width(row: Row) -> float:
    """Of the mean's interval of 95 %, by the normal distribution: there are a hundred episodes or more."""
    return float(1.96 * row["sd"] / row["episodes"] ** 0.5)


def draw(path: Path, rows: Sequence[Row]) -> None:
    """The curves of all seeds, and a line for each of the other two with its interval."""
    from matplotlib.figure import Figure  # an extra, and slow to load

    figure = Figure(figsize=(8.0, 4.6), dpi=100, layout="constrained")
    axes = figure.subplots()
    for number, curve in enumerate(curves(rows).values()):
        label = f"{LEARNER}, {len(curves(rows))} seeds" if not number else None
        minutes = [row["seconds"] / 60 for row in curve]
        axes.plot(minutes, [row["return"] for row in curve], "o-", ms=3, color=COLOURS[LEARNER], label=label)
    for policy in (PLANNER, RANDOM):
        row = next(row for row in rows if row["policy"] == policy)
        mean, half = row["return"], half_width(row)
        axes.axhline(mean, color=COLOURS[policy], ls="--" if policy != RANDOM else ":", label=policy)
        axes.axhspan(mean - half, mean + half, color=COLOURS[policy], alpha=0.15, lw=0)
    axes.set(xlabel="minutes of training on one core", ylabel="mean return of an episode", xlim=(0, None))
    axes.legend(loc="center right")
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, metadata={"Software": None})


def table(rows: Sequence[Row]) -> str:
    """In Markdown: the learner after some times in the mean of its seeds, and the other two."""
    lines = ["| policy | seconds of training | seeds | steps | return |", "|---|---|---|---|---|"]
    for at in (30, 60, 120, 300, 600):
        near = [min(curve, key=lambda row: abs(row["seconds"] - at)) for curve in curves(rows).values()]
        near = [row for row in near if abs(row["seconds"] - at) < 10]
        if near:
            steps, mean = fmean(row["steps"] for row in near), fmean(row["return"] for row in near)
            lines.append(f"| {LEARNER} | {at} | {len(near)} | {steps:,.0f} | {mean:.2f} |")
    for policy in (PLANNER, RANDOM):
        row = next(row for row in rows if row["policy"] == policy)
        lines.append(f"| {policy} | | | | {row['return']:.2f} ± {half_width(row):.2f} |")
    return "\n".join(lines)


def main() -> None:
    """Complete the rows and print them as a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--keep", type=Path, default=ROWS, help="the rows (%(default)s)")
    parser.add_argument("--episodes", type=int, default=100, help="of the planner (%(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rows = read(options.keep)
    if not any(row["policy"] == PLANNER for row in rows):
        rows.append(planned(options.episodes, options.seed))
        with options.keep.open("a", encoding="utf-8") as file:
            file.write(json.dumps(rows[-1]) + "\n")
    print(table(rows))


if __name__ == "__main__":
    main()
