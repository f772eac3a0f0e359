"""How long each step of perception takes, on one core: medians over single frames and over looks of three.

Run from the repository's root: `python benchmarks/perception.py`. It needs pybullet for the frames.
"""

from __future__ import annotations

from pathlib import Path
from statistics import median

import cv2
import numpy as np

from cleancli.language.load import read_source
from cleancli.perception.frame import Frame
from cleancli.perception.perceive import Observation, perceive
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable

PROBLEMS = Path(__file__).parent.parent / "problems"
LAYOUTS = ("two_groups", "scattered_40")
SEEDS = 10


def main() -> None:
    """Print one table for each number of frames a look takes."""
    cv2.setNumThreads(1)
    looks = [look for name in LAYOUTS for look in photographed(name)]
    for count in (1, 3):
        seen = [perceive(frames[:count], scene, np.random.default_rng(0)) for scene, frames in looks]
        report(count, seen)


def photographed(name: str) -> list[tuple[Scene, list[Frame]]]:
    """Three frames of each of a layout's variants, with the tool at rest."""
    scene = load_scene(read_source(PROBLEMS / f"{name}.nid"))
    looks = []
    for seed in range(1, SEEDS + 1):
        with PybulletTable(scene, seed) as table:
            table.withdraw()
            while table.poll() is Status.RUNNING:
                pass
            looks.append((scene, [table.observe() for _ in range(3)]))
    return looks


def report(count: int, seen: list[Observation]) -> None:
    """Milliseconds a look, step by step."""
    print(f"{count} frame{'s' if count > 1 else ''} a look, {len(seen)} looks: median and largest ms")
    for step in seen[0].seconds:
        values = [1e3 * observation.seconds[step] for observation in seen]
        print(f"  {step:<12}{median(values):8.1f}{max(values):8.1f}")
    totals = [1e3 * sum(observation.seconds.values()) for observation in seen]
    print(f"  {'total':<12}{median(totals):8.1f}{max(totals):8.1f}")


if __name__ == "__main__":
    main()
