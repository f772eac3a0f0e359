"""How near to the surface's rim dirt is seen: python benchmarks/rim.py [--tables N] [--seed N] [--frames N]

Lentils lie within a centimetre of the rim of the default table, and a bit farther in. By their distance from
it, the share is counted that is found where so many pixels beside the surface's outline are removed
(`surface_edge`), and with it the pixels that show dirt where none lies. A lentil is found if the middle of a
dirty pixel lies within 4 mm of its footprint. About half a minute of CPU.
"""

from __future__ import annotations

import argparse
from contextlib import closing
from dataclasses import replace

import numpy as np
from perception_tables import look, withdrawn
from perception_truth import FOUND, dirty, footprints
from scipy.spatial.distance import cdist

from cleancli.array_types import Bools, Points
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.perception.perceive import perceive
from cleancli.scene.calibration import Appearance, Calibration, Thresholds
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.table import PybulletTable

EDGES = (2, 3, 4)
BANDS = ((0.002, 0.004), (0.004, 0.006), (0.006, 0.008), (0.008, 0.010))
"""Distances from the rim, metres."""
EACH = 30
"""Lentils along each of two opposite sides."""
FAR = 0.008
"""Metres from the nearest footprint beyond which a dirty pixel is false."""

UNKNOWN = Appearance(1, 1, ((0.0, 0.0, 0.0),), 0.0)


def table(side: str) -> Scene:
    """A table with lentils along its west and east, or its south and north."""
    strips = {
        "west": ("(-44.8 cm, -33 cm)", "(-43.6 cm, 33 cm)"),
        "east": ("(43.6 cm, -33 cm)", "(44.8 cm, 33 cm)"),
        "south": ("(-43 cm, -34.8 cm)", "(43 cm, -33.6 cm)"),
        "north": ("(-43 cm, 33.6 cm)", "(43 cm, 34.8 cm)"),
    }
    pair = ("west", "east") if side == "across" else ("south", "north")
    dirt = "".join(f"scattered {{ count = {EACH} from = {strips[s][0]} to = {strips[s][1]} }}" for s in pair)
    return load_scene(Source("rim", f"scene rim {{ dirt {{ {dirt} }} }}"))


def seen(number: int, seed: int, frames: int) -> tuple[Points, dict[int, tuple[Bools, int]]]:
    """Of one table the distances (n,) of lentils from the rim, and for each number of pixels removed which of
    them are found, and how many pixels are false."""
    scene = table("across" if number % 2 == 0 else "along")
    rng = np.random.default_rng((seed, number))
    with closing(PybulletTable(scene, int(rng.integers(2**31)))) as there:
        withdrawn(there)
        pictures = look(there, scene, frames, 0.0, rng)
        pieces = footprints(there)
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    away = np.array([(half - np.abs(piece.mean(axis=0))).min() for piece in pieces])
    found = {}
    for edge in EDGES:
        thresholds = Thresholds(surface_edge=edge, object_edge=max(edge + 2, Thresholds().object_edge))
        calibrated = replace(scene, calibration=Calibration("", thresholds, UNKNOWN))
        middles, _ = dirty(perceive(pictures, calibrated, np.random.default_rng(seed)))
        distances = [cdist(piece, middles).min(initial=1.0) for piece in pieces]
        nearest = cdist(middles, np.concatenate(pieces)).min(axis=1, initial=1.0)
        found[edge] = np.array(distances) < FOUND, int((nearest > FAR).sum())
    return away, found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tables", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--frames", type=int, default=1, help="in a look")
    options = parser.parse_args()
    looks = [seen(number, options.seed, options.frames) for number in range(options.tables)]
    away = np.concatenate([distances for distances, _ in looks])
    print("| distance from the rim | lentils | " + " | ".join(f"{e} pixels removed" for e in EDGES) + " |")
    print("|---" * (len(EDGES) + 2) + "|")
    for low, high in BANDS:
        inside = (away >= low) & (away < high)
        shares = [
            f"{np.concatenate([found[edge][0] for _, found in looks])[inside].mean():.0%}" for edge in EDGES
        ]
        print(f"| {1e3 * low:.0f}-{1e3 * high:.0f} mm | {inside.sum()} | {' | '.join(shares)} |")
    false = {edge: sum(found[edge][1] for _, found in looks) for edge in EDGES}
    print("false pixels: " + ", ".join(f"{count} with {edge}" for edge, count in false.items()))


if __name__ == "__main__":
    main()
