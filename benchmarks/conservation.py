"""Nothing is lost, tunnels or flies: python benchmarks/conservation.py [actions] [--robot NAME] [--seed N]

Random actions upon random ellipses, some of them off the table, among lentils, rice and peas. After every
control period every particle must be on the table, in the container or on the floor (or falling there), not
inside the table, and not faster than anything here can make it. Exit code 1 where one is not.
"""

from __future__ import annotations

import argparse
import sys
import time
from contextlib import closing

import numpy as np
from numpy.typing import NDArray

from cleancli.language.diagnostics import Source
from cleancli.motion.actions import ARITIES, PICK_UP, can_execute, tool_path
from cleancli.perception.area import Ellipse
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world import parameters as par
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable

OFF = 0.10  # metres beyond the table's edges within which areas are drawn

ROUND = 20
"""Actions upon one table; the next ones get a new table, with the container at the next edge."""

SIZES = {"gantry": (90, 70), "wam": (60, 55), "reem": (50, 40)}
"""Surfaces that fit the robots' reach, in cm."""

KINDS = ("lentils", "rice", "peas")

FASTEST_ON_TABLE = (
    1.0  # m/s: five times the fastest stroke; a flap that springs back is what makes it so fast
)
FASTEST_FALL = 1.1 * float(np.sqrt(2 * 9.81 * (par.TABLE_HEIGHT + 0.05)))
LOWEST = -par.TABLE_HEIGHT - 0.02  # whoever falls on the floor at 3.7 m/s is within it for a step
# How deep a rag may press a particle's middle into the table while it goes over it. A dustpan ends above the
# surface: where it stands on a pea it presses half of it in, 3.3 mm.
PRESSED = 4e-3
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


def faults(
    before: NDArray[np.float64],
    now: NDArray[np.float64],
    half: NDArray[np.float64],
    pressed: float,
    carried: bool,
) -> list[str]:
    """What is wrong with particles at `now` (n, 3), which were at `before` a control period ago; they may be
    `pressed` so deep into the table, or `carried` by a dustpan."""
    speeds = np.linalg.norm(now - before, axis=1) / (par.STEPS_PER_PERIOD * par.STEP)
    above = (np.abs(now[:, :2]) < half).all(axis=1) & (now[:, 2] > 0)
    inside = (np.abs(now[:, :2]) < half - 0.005).all(axis=1)
    inside &= (now[:, 2] < -pressed) & (now[:, 2] > -par.TABLE_THICKNESS)
    wrong = {
        "not a number": ~np.isfinite(now).all(axis=1),
        "inside the table": inside,
        "below the floor": now[:, 2] < LOWEST,
        "flying": now[:, 2] > (CARRIED if carried else HIGHEST),
        "too fast on the table": above & (speeds > (FASTEST_CARRIED if carried else FASTEST_ON_TABLE)),
        "too fast in its fall": speeds > FASTEST_FALL,
    }
    return [
        f"{what}: {found.sum()} at {np.round(now[found][0], 4)}"
        for what, found in wrong.items()
        if found.any()
    ]


def random_action(rng: np.random.Generator, scene: Scene) -> tuple[str, tuple[Ellipse, ...]]:
    """An action that the robot has, and its ellipses, up to 10 cm off the table."""
    action = str(rng.choice(sorted(a for a, areas in ARITIES.items() if can_execute(a, areas, scene.robot))))
    corner = np.array((scene.surface.width, scene.surface.depth)) / 2 + OFF
    ellipses = []
    for _ in range(ARITIES[action]):
        x, y = rng.uniform(-corner, corner)
        short, long = np.sort(rng.uniform(0.005, 0.12, 2))
        ellipses.append(
            Ellipse((float(x), float(y)), (float(long), float(short)), float(rng.uniform(-1.5, 1.5)))
        )
    return action, tuple(ellipses)


def try_table(robot: str, number: int, actions: int, rng: np.random.Generator) -> tuple[list[str], int]:
    """Random actions upon one table; what went wrong, and how many actions failed (out of reach)."""
    edge = ("north", "east", "south", "west")[number % 4]
    scene = scene_for(robot, edge)
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    wrong, failed = [], 0
    with closing(PybulletTable(scene, number)) as table:
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
                carried = action == PICK_UP
                wrong += [f"{action}: {fault}" for fault in faults(before, now, half, PRESSED, carried)]
            wrong += [f"after {action}: {fault}" for fault in faults(now, now, half, 0.0, False)]
            if status is Status.FAILED:
                failed += 1
                table.stop()
                now = table.truth().positions
        where = f"on the table {truth.on_table}, in the container {truth.in_container}, on the floor"
        print(
            f"{robot}, table {number} ({edge}): {actions} actions, {failed} failed; {where} {truth.on_floor}"
        )
    return wrong, failed


def main() -> int:
    """Try them all; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("actions", type=int, nargs="?", default=200)
    parser.add_argument("--robot", choices=tuple(SIZES), default="gantry")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng, began = np.random.default_rng(options.seed), time.process_time()
    wrong: list[str] = []
    done = options.actions
    for number in range(-(-options.actions // ROUND)):
        more, failed = try_table(options.robot, number, min(ROUND, options.actions - number * ROUND), rng)
        wrong, done = wrong + more, done - failed
    for fault in wrong[:20]:
        print(fault)
    spent = time.process_time() - began
    print(
        f"{options.robot}: {len(wrong)} faults in {options.actions} actions, {done} of them carried out,"
        f" {spent:.0f} s of CPU"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
