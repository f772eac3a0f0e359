"""Pictures of strokes over true positions: python benchmarks/strokes.py [--seeds N ...] [--stand-in] ...

Carries out an episode for every strategy and seed, and draws what each stroke did: where the rag went, which
particles it took along, which it went over or passed by, and how long it took. `index.html` in the folder
shows the strategies side by side. Prints what looks silly: strokes in vain, strokes for one to three
particles, and particles that a stroke passed by and a later one had to come for. Strategies that plan are
drawn once for every `--domain`, the others once, with the scene's own. Every episode is a line of FILE as
soon as it is over; those that FILE holds are not run again, but drawn again. Needs matplotlib.

About a minute of CPU for an episode; with `--stand-in` about ten seconds, or forty where it plans; with
`--quick` (two strategies, two groups, one seed, on the stand-in) about half a minute.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

import msgspec
from episodes import Job
from kept import Kept
from stroke_pictures import MissingMatplotlib, draw, new_figure, sheet
from stroke_record import Episode, recorded, silliness

from cleancli.execution.strategies import STRATEGIES
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene

RIVALS = ("plan-2", "reactive", "wipe", "tsp")
"""The strategies that are drawn unless others are asked for."""

COLUMNS = (
    *("episode", "moving", "strokes", "left", "in vain", "seconds", "for 1 to 3", "seconds"),
    *("repeated", "gone over", "passed by"),
)


def jobs(
    scenes: Sequence[str], domains: Sequence[str], strategies: Sequence[str], seeds: Sequence[int]
) -> Iterator[Job]:
    """All episodes, those of a table one after the other."""
    for seed in seeds:
        for scene in scenes:
            for strategy in strategies:
                plans = STRATEGIES[strategy].planner is not None
                for domain in domains if plans else (scene_of(scene).domain,):
                    yield domain, scene, strategy, seed


def episodes(due: Sequence[Job], kept: Kept, stand_in: bool) -> Iterator[Episode]:
    """The episodes, in order; those that are kept are not run again."""
    known = {(e.job, e.stand_in): e for e in (msgspec.convert(row, Episode) for row in kept.rows())}
    for job in due:
        episode = known.get((job, stand_in))
        if episode is None:
            episode = recorded(job, stand_in)
            kept.add(asdict(episode))
        yield episode


def line(episode: Episode) -> str:
    """An episode's row of the table."""
    domain, scene, strategy, seed = episode.job
    found = silliness(episode, scene_of(scene).rag.width)
    cells = (
        f"{scene} {seed} {strategy} {domain}",
        f"{episode.moving:.1f}",
        len(episode.strokes),
        episode.left + episode.lost,
        found.vain,
        f"{found.vain_seconds:.1f}",
        found.few,
        f"{found.few_seconds:.1f}",
        found.repeated,
        found.over,
        found.beside,
    )
    return f"| {' | '.join(map(str, cells))} |"


def scene_of(name: str) -> Scene:
    """The scene of that name or file."""
    return load_scene(read_source(find(name, "problems")))


def asked() -> argparse.Namespace:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--domain", nargs="+", default=["sweeping"], help="what strategies plan with")
    parser.add_argument("--scene", nargs="+", default=["scattered_40"])
    parser.add_argument("--strategy", nargs="+", choices=list(STRATEGIES), default=RIVALS)
    parser.add_argument("--seeds", nargs="+", type=int, default=[1])
    parser.add_argument("--keep", type=Path, metavar="FILE", help="episodes run before are in it")
    parser.add_argument("--out", type=Path, metavar="FOLDER", default=Path("strokes"), help="for pictures")
    parser.add_argument("--stand-in", action="store_true", help="without physics")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.scene, options.strategy, options.seeds = ["two_groups"], ["plan-2", "reactive"], [1]
        options.stand_in = True
    return options


def main() -> int:
    """Run what is missing, draw all, and print the table."""
    options = asked()
    try:
        new_figure(1, 1)
    except MissingMatplotlib as error:
        print(error, file=sys.stderr)
        return 1
    options.out.mkdir(parents=True, exist_ok=True)
    print(f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|", sep="\n", flush=True)
    due = list(jobs(options.scene, options.domain, options.strategy, options.seeds))
    pictures = []
    for episode in episodes(due, Kept(options.keep), options.stand_in):
        domain, scene, strategy, seed = episode.job
        path = options.out / f"{Path(scene).stem}-{seed}-{strategy}-{Path(domain).stem}.png"
        draw(episode, scene_of(scene), path)
        pictures.append((episode, path))
        (options.out / "index.html").write_text(sheet(pictures), encoding="utf-8")
        print(line(episode), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
