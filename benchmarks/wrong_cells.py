"""Cells that are not as they are believed to be: python benchmarks/wrong_cells.py [--keep FILE].

The simulated table of two groups, whose camera stands elsewhere than its pictures say (east of it, above it,
turned about the table's middle), or whose tool is higher than the robot believes. Prints what `cleancli cell
check` measures and reports, of three frames of the clean table and of nine touches with 1 mm of noise; and
how many episodes of `cleancli execute` end clean, how many lentils are truly left or fell on the floor, with
how many actions. An episode ends after 20 actions. Each is a line of FILE as soon as it is over; those that
FILE holds are not run again.

About 20 minutes of CPU; with `--checks` (no episodes) a few seconds.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from math import cos, radians, sin
from pathlib import Path
from statistics import mean

import numpy as np
from kept import Kept, Row

from cleancli.array_types import Floats
from cleancli.cell.board import BOARDS
from cleancli.cell.camera import Laid
from cleancli.cell.faults import faults_felt, faults_seen, felt, seen
from cleancli.cell.touches import Touch
from cleancli.execution.events import Ended
from cleancli.execution.loop import clean
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, discounts_time, usual_job, within_reach
from cleancli.execution.table_cell import TableCell
from cleancli.geometry.rgbd import Frame
from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.motion.path import ToolPath
from cleancli.perception.surface import NoSurface
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.robot import Status, finish
from cleancli.world.table import PybulletTable

DOMAIN, SCENE = "cleaning", "two_groups"
SEEDS = (1, 2, 3)
MOST_ACTIONS = 20
TOUCH_NOISE = 0.001
"""Metres."""
TOUCHED = [(x, y) for x in (-0.3, 0.0, 0.3) for y in (-0.25, 0.0, 0.25)]


@dataclass(frozen=True, slots=True)
class Wrong:
    """What is not as it is believed: the camera's place east of and above its own (metres), and turned about
    the table's middle (degrees); how much higher the tool is (metres)."""

    east: float = 0.0
    above: float = 0.0
    turned: float = 0.0
    tool: float = 0.0

    @property
    def camera(self) -> Floats:
        """(4, 4): from where the camera stands to where it is believed to."""
        a = radians(self.turned)
        return np.array(
            [[cos(a), -sin(a), 0, self.east], [sin(a), cos(a), 0, 0], [0, 0, 1, self.above], [0, 0, 0, 1.0]]
        )


CELLS: Mapping[str, Wrong] = {
    "as believed": Wrong(),
    "camera 20 mm east": Wrong(east=0.02),
    "camera 40 mm east": Wrong(east=0.04),
    "camera 200 mm east": Wrong(east=0.2),
    "camera 20 mm up": Wrong(above=0.02),
    "camera 40 mm up": Wrong(above=0.04),
    "camera 200 mm up": Wrong(above=0.2),
    "camera turned by 3 degrees": Wrong(turned=3.0),
    "tool 2 mm high": Wrong(tool=0.002),
    "tool 4 mm high": Wrong(tool=0.004),
}


class Misplaced:
    """A table (`Robot`) that is believed to be otherwise than it is."""

    def __init__(self, table: PybulletTable, wrong: Wrong) -> None:
        self._table, self._wrong = table, wrong

    @property
    def clock(self) -> float:
        """As the table's."""
        return self._table.clock

    @property
    def failure(self) -> str:
        """As the table's."""
        return self._table.failure

    @property
    def tool(self) -> tuple[float, float, float]:
        """Where the robot believes it."""
        x, y, z = self._table.tool
        return x, y, z - self._wrong.tool

    def observe(self) -> Frame:
        """A frame that says that its camera stands elsewhere."""
        return believed(self._table.observe(), self._wrong)

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """Whether the table can follow what is truly meant."""
        return self._table.can_follow(self._raised(path), errors)

    def start(self, path: ToolPath) -> None:
        """Begin what is truly meant."""
        self._table.start(self._raised(path))

    def withdraw(self) -> None:
        """As the table does."""
        self._table.withdraw()

    def poll(self) -> Status:
        """As the table does."""
        return self._table.poll()

    def stop(self) -> None:
        """As the table does."""
        self._table.stop()

    def _raised(self, path: ToolPath) -> ToolPath:
        by = self._wrong.tool
        return replace(path, waypoints=tuple(replace(each, z=each.z + by) for each in path.waypoints))


def believed(frame: Frame, wrong: Wrong) -> Frame:
    """A frame of the camera where it is believed to stand."""
    return replace(frame, camera=replace(frame.camera, pose=wrong.camera @ frame.camera.pose))


def place() -> Scene:
    """The scene of the episodes."""
    return load_scene(read_source(find(SCENE, "problems")))


def pictures(scene: Scene, seed: int) -> tuple[Frame, ...]:
    """Three of the clean table, without the tool."""
    with closing(PybulletTable(replace(scene, dirt=()), derived(seed, Stream.WORLD))) as table:
        table.withdraw()
        finish(table)
        return tuple(table.observe() for _ in range(3))


def checked(name: str, frames: Sequence[Frame], scene: Scene, seed: int) -> tuple[str, tuple[str, ...]]:
    """What `cell check` measures of a cell, in words for a table, and what it reports."""
    wrong = CELLS[name]
    rng = np.random.default_rng(seed)
    # Told to be at z, the tool is higher: it touches the table when it is told to be below it.
    places = np.column_stack([TOUCHED, np.full(len(TOUCHED), -wrong.tool)])
    noisy = places + rng.normal(0, TOUCH_NOISE, places.shape)
    touches = [Touch((float(x), float(y), float(z))) for x, y, z in noisy]
    feeling = felt(touches, BOARDS["a3"], Laid(), np.eye(4))
    tool = f"{1000 * feeling.higher:+.1f}"
    try:
        found = seen([believed(frame, wrong) for frame in frames], scene.surface, rng)
    except NoSurface as error:
        return f"not found | | {tool}", (str(error), *faults_felt(feeling))
    shift = (
        "not known"
        if found.shifted is None
        else "{:+.1f}, {:+.1f}".format(*(1000 * s for s in found.shifted))
    )
    turn = "not known" if found.turned is None else f"{found.turned:+.2f}"
    told = f"{1000 * found.higher:+.1f} | {shift} | {turn} | {tool}"
    return told, (*faults_seen(found), *faults_felt(feeling))


def episode(name: str, seed: int) -> Row:
    """One episode in a cell, and what is truly left of its dirt."""
    model, scene = load_domain(read_source(find(DOMAIN, "domains"))), place()
    options = EpisodeOptions(seed=seed, max_actions=MOST_ACTIONS, by_time=discounts_time(model))
    way = usual_job(model, scene.arms)
    setup = EpisodeSetup(model, within_reach(model, scene.arms, way), scene, way, options)
    with closing(PybulletTable(scene, derived(seed, Stream.WORLD))) as table:
        cell = TableCell(model, scene, Misplaced(table, CELLS[name]), seed)
        ended = next(event for event in clean(setup, cell) if isinstance(event, Ended))
        truth = table.truth()
    told = {"clean": ended.clean, "reason": ended.reason, "actions": ended.actions}
    return {"job": [name, seed], **told, "left": truth.on_table, "lost": truth.on_floor}


def row(name: str, told: str, faults: Sequence[str], episodes: Sequence[Row]) -> str:
    """Of one cell, for the table."""
    done = "| | | |"
    if episodes:
        ended = sum(each["clean"] for each in episodes)
        means = [mean(each[of] for each in episodes) for of in ("left", "lost", "actions")]
        done = f"| {ended} of {len(episodes)} | {means[0]:.1f} | {means[1]:.1f} | {means[2]:.1f} |"
    return f"| {name} | {told} | {'yes' if faults else 'no'} {done}"


def table(options: argparse.Namespace) -> Iterator[str]:
    """Lines, a row a cell."""
    yield (
        "| cell | seen higher, mm | shifted, mm | turned, degrees | touched higher, mm | reported | clean | "
        "left | on the floor | actions |"
    )
    yield "|---" * 10 + "|"
    scene, kept = place(), Kept(options.keep)
    frames = pictures(scene, options.seeds[0])
    known = {tuple(each["job"]): each for each in kept.rows()}
    for name in options.cells:
        done = []
        for seed in () if options.checks else options.seeds:
            if (name, seed) not in known:
                kept.add(known.setdefault((name, seed), episode(name, seed)))
            done.append(known[name, seed])
        yield row(name, *checked(name, frames, scene, options.seeds[0]), done)


def main() -> None:
    """Run what is missing, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", nargs="+", choices=list(CELLS), default=list(CELLS), metavar="NAME")
    parser.add_argument("--seeds", "--seed", nargs="+", type=int, default=SEEDS)
    parser.add_argument("--checks", action="store_true", help="what is reported alone")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="episodes run before are in it")
    for line in table(parser.parse_args()):
        print(line, flush=True)


if __name__ == "__main__":
    main()
