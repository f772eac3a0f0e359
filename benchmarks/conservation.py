"""Nothing is lost, tunnels or flies, whatever a robot does: random actions, and after each step a count.

    python benchmarks/conservation.py [actions] [--robot NAME] [--seed N] [--keep FILE]

Random actions upon random ellipses, some of them off the table, among lentils, rice and peas. The seed
decides where these lie, the noise of the strokes, and the actions. After every control period every particle
must be on the table, in the container or on the floor (or falling there), not inside the table, and not
faster than anything here can make it. Exit code 1 where one is not. Each table of 20 actions has its own
line, and with --keep it is a line of FILE as well: those that stand there are not done again.

200 actions take about six minutes of CPU (REEM: three, since it reaches less).
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import asdict, dataclass, fields
from math import pi
from pathlib import Path

import numpy as np
from kept import Kept

from cleancli.array_types import Bools, Points
from cleancli.execution.seeds import Stream, derived
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.motion.actions import ARITIES, PICK_UPS, TO_ZONE, can_execute, tool_path
from cleancli.motion.pace import FAST_SPEED
from cleancli.scene.check import load_scene
from cleancli.scene.grasps import WIDE
from cleancli.scene.model import Scene
from cleancli.world import constants as par
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable

OFF = 0.10  # metres beyond the table's edges within which areas are drawn

ROUND = 20
"""Actions upon one table; the next ones get a new table, with the container at the next edge."""

SIZES = {"gantry": (90, 70), "wam": (60, 55), "reem": (50, 40)}
"""Surfaces that fit the robots' reach, in cm."""

EDGES = ("north", "east", "south", "west")
"""Where the container is, in turn."""

KINDS = ("lentils", "rice", "peas")

FLICKED = pi / 2 * WIDE.gain / par.STEP * par.FLAP_HEIGHT
"""m/s of the lower edge of a flap that was bent by a right angle, as it springs back: in each step its hinge
turns by `gain` of what it is off."""
FASTEST_ON_TABLE = FAST_SPEED + FLICKED
FASTEST_FALL = 1.1 * float(np.sqrt(2 * 9.81 * (par.TABLE_HEIGHT + 0.05)))
LOWEST = -par.TABLE_HEIGHT - 0.02  # whoever falls on the floor at 3.7 m/s is within it for a step
# How deep a rag or a dustpan may press a particle's middle into the table while it goes over it: half of the
# thickest one, below an edge that is pressed in itself.
PRESSED = max(par.PARTICLES[kind].size[2] for kind in KINDS) / 2 + par.PRESS
HIGHEST = 0.06  # metres above the surface: what is higher, and not on the dustpan, flies
CARRIED = 0.30  # how high, and
FASTEST_CARRIED = 3.0  # how fast (m/s) a particle may be that a dustpan carries, or that falls off it


def scene_for(robot: str, edge: str) -> Scene:
    """A table with 48 particles that the robot reaches."""
    width, depth = SIZES[robot]
    x, y = width / 2 - 5, depth / 2 - 5
    dirt = "".join(
        f"scattered {{ count = 12 of = {kind} from = (-{x} cm, -{y} cm) to = ({x} cm, {y} cm) }}"
        for kind in KINDS
    )
    text = f"""scene table {{
        surface {{ width = {width} cm depth = {depth} cm }}
        container {{ edge = {edge} }}
        robot {{ drive = {robot} }}
        dirt {{ {dirt} group {{ count = 12 at = (0 cm, 0 cm) radius = 2 cm }} }}
    }}"""
    return load_scene(Source("table", text))


@dataclass(frozen=True, slots=True)
class Result:
    """What became of the actions upon one table: what went wrong, how many `failed` (out of reach), where
    particles were at the end, and how fast the fastest ever was on the table, m/s."""

    wrong: list[str]
    actions: int
    failed: int
    on_table: int
    in_container: int
    on_floor: int
    fastest: float


def speeds(before: Points, now: Points) -> Points:
    """(n,) of particles at `now` (n, 3), which were at `before` a control period ago."""
    moved: Points = np.linalg.norm(now - before, axis=1)
    return moved / (par.STEPS_PER_PERIOD * par.STEP)


def above(places: Points, half: Points) -> Bools:
    """(n,) which are on or above the table's top."""
    return np.asarray((np.abs(places[:, :2]) < half).all(axis=1) & (places[:, 2] > 0))


def faults(before: Points, now: Points, half: Points, pressed: float, carried: bool) -> list[str]:
    """What is wrong with particles at `now` (n, 3), which were at `before` a control period ago; they may be
    `pressed` so deep into the table, or `carried` by a dustpan."""
    fast = speeds(before, now)
    inside = (np.abs(now[:, :2]) < half - 0.005).all(axis=1)
    inside &= (now[:, 2] < -pressed) & (now[:, 2] > -par.TABLE_THICKNESS)
    wrong = {
        "not a number": ~np.isfinite(now).all(axis=1),
        "inside the table": inside,
        "below the floor": now[:, 2] < LOWEST,
        "flying": now[:, 2] > (CARRIED if carried else HIGHEST),
        "too fast on the table": above(now, half)
        & (fast > (FASTEST_CARRIED if carried else FASTEST_ON_TABLE)),
        "too fast in its fall": fast > FASTEST_FALL,
    }
    return [
        f"{what}: {found.sum()} at {np.round(now[found][0], 4)}, {fast[found].max():.2f} m/s"
        for what, found in wrong.items()
        if found.any()
    ]


def random_action(rng: np.random.Generator, scene: Scene) -> tuple[str, tuple[Ellipse, ...]]:
    """An action that the robot has, and its ellipses, up to 10 cm off the table."""
    able = [a for a, areas in ARITIES.items() if a not in TO_ZONE and can_execute(a, areas, scene.arms)]
    action = str(rng.choice(sorted(able)))
    corner = np.array((scene.surface.width, scene.surface.depth)) / 2 + OFF
    ellipses = []
    for _ in range(ARITIES[action]):
        x, y = rng.uniform(-corner, corner)
        short, long = np.sort(rng.uniform(0.005, 0.12, 2))
        ellipses.append(
            Ellipse((float(x), float(y)), (float(long), float(short)), float(rng.uniform(-1.5, 1.5)))
        )
    return action, tuple(ellipses)


def try_table(robot: str, seed: int, number: int, actions: int) -> Result:
    """Random actions upon one table."""
    scene = scene_for(robot, EDGES[number % len(EDGES)])
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    rng = np.random.default_rng((seed, number))
    wrong, failed, fastest = [], 0, 0.0
    with closing(PybulletTable(scene, derived(seed, Stream.WORLD) + number)) as table:
        now = table.truth().positions
        for _ in range(actions):
            action, ellipses = random_action(rng, scene)
            table.start(tool_path(action, ellipses, scene))
            status = Status.RUNNING
            while status is Status.RUNNING:
                status, before = table.poll(), now
                truth = table.truth()
                now = truth.positions
                if truth.on_table + truth.in_container + truth.in_dustpan + truth.on_floor != len(now):
                    wrong.append(f"{action}: not every particle is anywhere")
                carried = action in PICK_UPS
                wrong += [f"{action}: {fault}" for fault in faults(before, now, half, PRESSED, carried)]
                if not carried:
                    fastest = max(fastest, speeds(before, now)[above(now, half)].max(initial=0))
            wrong += [f"after {action}: {fault}" for fault in faults(now, now, half, 0.0, False)]
            if status is Status.FAILED:
                failed += 1
                table.stop()
                now = table.truth().positions
    return Result(
        wrong, actions, failed, truth.on_table, truth.in_container, truth.on_floor, round(float(fastest), 2)
    )


def results(robot: str, seed: int, actions: int, kept: Kept) -> Iterator[Result]:
    """Those of all tables; a line is printed for each."""
    known = {(row["robot"], row["seed"], row["table"], row["actions"]): row for row in kept.rows()}
    for number in range(-(-actions // ROUND)):
        tried = min(ROUND, actions - number * ROUND)
        row = known.get((robot, seed, number, tried))
        if row is None:
            what = {"robot": robot, "seed": seed, "table": number, "actions": tried}
            row = {**what, **asdict(try_table(robot, seed, number, tried))}
            kept.add(row)
        one = Result(**{field.name: row[field.name] for field in fields(Result)})
        where = (
            f"on the table {one.on_table}, in the container {one.in_container}, on the floor {one.on_floor}"
        )
        print(
            f"{robot}, seed {seed}, table {number}: {one.actions} actions, {one.failed} failed; {where};"
            f" the fastest {one.fastest:.2f} m/s, {len(one.wrong)} faults",
            flush=True,
        )
        yield one


def main() -> int:
    """Try them all; the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("actions", type=int, nargs="?", default=200)
    parser.add_argument("--robot", choices=tuple(SIZES), default="gantry")
    parser.add_argument("--seed", type=int, default=1, help="of tables, strokes and actions")
    parser.add_argument(
        "--keep", type=Path, metavar="FILE", help="tables done before are in it, others are added"
    )
    options = parser.parse_args()
    began = time.process_time()
    found = list(results(options.robot, options.seed, options.actions, Kept(options.keep)))
    wrong = [fault for one in found for fault in one.wrong]
    for fault in wrong[:20]:
        print(fault)
    done = sum(one.actions - one.failed for one in found)
    print(
        f"{options.robot}, seed {options.seed}: {len(wrong)} faults in {options.actions} actions,"
        f" {done} of them carried out; the fastest {max(one.fastest for one in found):.2f} of"
        f" {FASTEST_ON_TABLE:.2f} m/s; {time.process_time() - began:.0f} s of CPU"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
