"""What the arms reach and can follow: python benchmarks/arms.py [--strokes N] [--areas N] [--seed N]

- reach: the share of tool poses, over a grid of places on the surface and eight directions;
- strokes: of random actions of the WAM, how many it can follow, and how long planning and timing one takes;
- bow: how far its fast pushes leave the straight line;
- picking up: of random areas near the middle of REEM's surface, how many both arms can work at, with the
  dustpan on the left, and in all ways, whatever the errors of the tool.

Nothing moves: motions are planned only. About two minutes of CPU, a line each time something is known;
`--quick` half a minute.
"""

from __future__ import annotations

import argparse
import time
from contextlib import closing
from dataclasses import replace
from math import pi

import numpy as np
from physics import BENCH, DESK, bow

from cleancli.array_types import Floats
from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import PICK_UP, SKILLS, tool_path, tool_paths
from cleancli.motion.path import Unreachable
from cleancli.scene.model import Scene
from cleancli.world.robots.registry import ROBOTS
from cleancli.world.table import PybulletTable

GRID = 13, 12
DIRECTIONS = 8
PLACES = (-0.25, -0.22), (0.22, 0.22)
"""Areas of the strokes lie between these corners of the WAM's surface, metres."""
PICK_RADIUS = 0.11
"""Areas to be picked up lie so far from the middle of REEM's, at most."""


def reach(scene: Scene) -> float:
    """The share of poses that the scene's robot takes with its tool on the surface."""
    x, y = (np.linspace(-side / 2, side / 2, n) for side, n in zip(_sides(scene), GRID, strict=True))
    yaws = np.arange(DIRECTIONS) * 2 * pi / DIRECTIONS
    poses = np.stack(np.meshgrid(x, y, [0.0], yaws), axis=-1).reshape(-1, 4)
    return float(np.mean(ROBOTS[scene.robot].reaches(poses, scene)))


def _sides(scene: Scene) -> tuple[float, float]:
    return scene.surface.width, scene.surface.depth


def drawn(rng: np.random.Generator, low: tuple[float, float], high: tuple[float, float]) -> Ellipse:
    """An ellipse with its middle between two corners."""
    x, y = rng.uniform(low, high)
    short, long = np.sort(rng.uniform(0.01, 0.06, 2))
    return Ellipse((float(x), float(y)), (float(long), float(short)), float(rng.uniform(-1.5, 1.5)))


def strokes(scene: Scene, number: int, rng: np.random.Generator) -> tuple[int, list[float]]:
    """How many of so many random actions can be followed, and the seconds that planning each took."""
    possible, seconds = 0, []
    with closing(PybulletTable(scene, 1)) as table:
        for _ in range(number):
            action = str(rng.choice(sorted(SKILLS)))
            ellipses = tuple(drawn(rng, *PLACES) for _ in range(SKILLS[action].arity))
            path = tool_path(action, ellipses, scene)
            began = time.process_time()
            try:
                table._drive.follow(path, np.zeros(4))
            except Unreachable:
                continue
            finally:
                seconds.append(time.process_time() - began)
            possible += 1
    return possible, seconds


def bows(scene: Scene, number: int, rng: np.random.Generator) -> Floats:
    """Of so many fast pushes that can be followed, how far the tool leaves the line, metres."""
    found: list[float] = []
    while len(found) < number:
        path = tool_path("moveToContainerFast", (drawn(rng, *PLACES),), scene)
        try:
            found.append(bow(path, scene))
        except Unreachable:
            continue
    return np.array(found)


def picked(scene: Scene, number: int, rng: np.random.Generator) -> tuple[int, int]:
    """How many of so many random areas can be picked up from right to left, and how many in some way."""
    leftwards = somehow = 0
    with closing(PybulletTable(scene, 1)) as table:
        for _ in range(number):
            angle, away = rng.uniform(0, 2 * pi), PICK_RADIUS * np.sqrt(rng.uniform())
            middle = float(away * np.cos(angle)), float(away * np.sin(angle))
            area = replace(drawn(rng, (0, 0), (0, 0)), centre=middle, axes=(0.03, 0.025))
            best, *others = tool_paths(PICK_UP, (area,), scene)
            leftwards += table.can_follow(best)
            somehow += any(map(table.can_follow, (best, *others)))
    return leftwards, somehow


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--strokes", type=int, default=300)
    parser.add_argument("--areas", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    number, areas = (20, 4) if options.quick else (options.strokes, options.areas)
    rng = np.random.default_rng(options.seed)
    for scene in (BENCH, DESK):
        width, depth = _sides(scene)
        print(f"{scene.robot} takes {reach(scene):.1%} of poses on {width:.2f} x {depth:.2f} m", flush=True)
    possible, seconds = strokes(BENCH, number, rng)
    print(
        f"wam: {possible} of {number} random actions can be followed;"
        f" {1e3 * np.median(seconds):.0f} ms of CPU each in the median",
        flush=True,
    )
    low, middle, high = 1e3 * np.quantile(bows(BENCH, number, rng), (0.1, 0.5, 0.9))
    print(f"wam: {number} fast pushes bow by {middle:.0f} mm in the median, {low:.0f} and {high:.0f} mm for")
    print("    the lowest and the highest tenth", flush=True)
    leftwards, somehow = picked(DESK, areas, np.random.default_rng(options.seed))
    print(f"reem: of {areas} random areas {leftwards} can be picked up from right to left, {somehow} somehow")


if __name__ == "__main__":
    main()
