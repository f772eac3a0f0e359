"""How fast the simulated table is: python benchmarks/world.py [seeds] [--seed N]

Cleans 40 scattered lentils by a script that knows where they are, with each robot: it pushes the lentil
farthest from the container, and what lies near it, until few are left. Prints simulated seconds per CPU
second, and what an image costs. The libraries load before the clock starts. Two seeds take about two minutes
of CPU; each has a line of its own.
"""

from __future__ import annotations

import argparse
import time
from contextlib import closing
from dataclasses import replace

import numpy as np

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path
from cleancli.scene.grasps import WIDE
from cleancli.scene.model import (
    CameraSetup,
    Container,
    Rag,
    Scattered,
    Scene,
    Surface,
    SymbolThresholds,
)
from cleancli.world.robot import finish
from cleancli.world.robots.registry import ROBOTS
from cleancli.world.table import PybulletTable

SCENE = Scene(
    name="forty",
    surface=Surface(0.90, 0.70, 0.45, (205, 198, 184)),
    container=Container("east", 0.0, 0.32, 0.16),
    robot="gantry",
    rag=Rag(WIDE, 0.12),
    camera=CameraSetup(0.9, 640, 480, 525),
    dirt=(Scattered(40, (-0.28, -0.22), (0.28, 0.22)),),
    symbols=SymbolThresholds(0.035, 0.05, 0.10, 0.3, 0.2, 0.06),
    seed=1,
)
# The arms reach smaller tables.
SMALL = replace(
    SCENE,
    surface=Surface(0.60, 0.55, 0.45, (205, 198, 184)),
    dirt=(Scattered(40, (-0.26, -0.22), (0.26, 0.22)),),
)
DESK = replace(
    SCENE,
    surface=Surface(0.50, 0.40, 0.45, (205, 198, 184)),
    container=Container("south", 0.0, 0.32, 0.16),
    dirt=(Scattered(40, (-0.06, -0.16), (0.20, 0.06)),),
)
SCENES = {
    robot: replace(scene, robot=robot) for robot, scene in (("gantry", SCENE), ("wam", SMALL), ("reem", DESK))
}
assert SCENES.keys() == ROBOTS.keys()
LEFT_OVER = 2
MOST_STROKES = 40


def clean(table: PybulletTable, scene: Scene) -> int:
    """Push until at most two lentils are left; the number of strokes."""
    for stroke in range(MOST_STROKES):
        places = table.truth().positions
        on_table = places[places[:, 2] > -0.01, :2]
        if len(on_table) <= LEFT_OVER:
            return stroke
        out = (1, 0) if scene.container.edge == "east" else (0, -1)
        target = on_table[np.argmin(on_table @ out)]
        area = Ellipse((float(target[0]), float(target[1])), (0.02, 0.02), 0.0)
        table.start(tool_path("moveToContainerStraight", (area,), scene))
        finish(table)
        if table.failure:
            print(table.failure)
            table.stop()
    return MOST_STROKES


def main() -> None:
    """Print one line per seed, then the cameras."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("seeds", type=int, nargs="?", default=2)
    parser.add_argument("--seed", type=int, default=0, help="the first")
    options = parser.parse_args()
    print("robot seed strokes robot_s cpu_s robot_s/cpu_s on_table in_container on_floor")
    for robot, scene in SCENES.items():
        with closing(PybulletTable(scene, 0)) as table:
            table.start(tool_path("groupScattered", (Ellipse((0, 0), (0.05, 0.05), 0),), scene))
        for seed in range(options.seed, options.seed + options.seeds):
            began = time.process_time()
            with closing(PybulletTable(scene, seed)) as table:
                strokes = clean(table, scene)
                spent, truth = time.process_time() - began, table.truth()
                rates = f"{table.clock:7.1f} {spent:5.1f} {table.clock / spent:13.1f}"
                places = f"{truth.on_table:8} {truth.in_container:12} {truth.on_floor:8}"
                print(f"{robot:6} {seed:4} {strokes:7} {rates} {places}", flush=True)
    with closing(PybulletTable(SCENE, 0)) as table:
        for name, shot in (
            ("frame", table.observe),
            ("picture", table.picture),
            ("small picture", lambda: table.picture(320, 240)),
        ):
            began = time.process_time()
            for _ in range(5):
                shot()
            print(f"{name}: {(time.process_time() - began) / 5 * 1e3:.0f} ms")


if __name__ == "__main__":
    main()
