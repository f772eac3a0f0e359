"""Perception on tables as a real camera takes them: `python benchmarks/real_tables.py [--pairs 100]`.

Each pair is a calibration on one frame of a clean table and another frame of the same camera and table, under
other light: exposure 0.7 to 1.4 times, a gradient up to 45 %, soft shadows (tests/support/real_camera.py,
whose noise is fitted to a real camera). Of the second it tells false areas while it is clean, and recall and
precision with 30 particles of each shade on it. 100 pairs take about 3 minutes.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from cleancli.array_types import Floats
from cleancli.geometry.rgbd import Frame
from cleancli.perception import geometry
from cleancli.perception.calibrate import calibrate
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.surface import NoSurface
from cleancli.scene.model import Scene
from support import real_camera, synthetic

PARTICLES = 30
FOUND = 0.004
"""Metres from a particle's middle to a dirty pixel up to which it is found."""
FALSE = 0.008
"""Metres from all particles beyond which a patch is false."""
WHOLE = 0.5
"""Share of the surface above which an area is a whole table."""


@dataclass(frozen=True)
class Seen:
    """Of one frame: what was looked for, how much of it is found, false patches, and whether the whole table
    was taken for dirt, or no background was found and that was said."""

    surface: str
    kind: str
    particles: int = 0
    found: int = 0
    false: int = 0
    whole: bool = False
    refused: bool = False


def compared(observation: Observation, places: Floats) -> tuple[int, int]:
    """How many of the particles at `places` (n, 2) are found, and how many patches are false."""
    mask = observation.steps.believed
    count, labels = cv2.connectedComponents(mask.view(np.uint8), connectivity=8)
    rows, columns = np.nonzero(mask)
    if not len(rows):
        return 0, 0
    camera = observation.camera
    level = geometry.Plane.below(np.zeros(3), np.array([0.0, 0, 1]), 0.0, np.array([1.0, 0, 0]))
    dirty = geometry.on_plane(camera, level, np.column_stack([columns, rows]).astype(float))
    if not len(places):
        return 0, count - 1
    apart = np.linalg.norm(places[:, None] - dirty[None], axis=2)
    nearest = np.full(count, np.inf)
    np.minimum.at(nearest, np.asarray(labels, np.int64)[rows, columns], apart.min(axis=0))
    return int((apart.min(axis=1) < FOUND).sum()), int((nearest[1:] > FALSE).sum())


def pair(seed: int, calibrates: bool) -> Iterator[Seen]:
    """What is seen on the second frame of a pair, clean and with each shade of particles."""
    rng = np.random.default_rng(seed)
    name = str(rng.choice(list(real_camera.SURFACES)))
    colour = real_camera.SURFACES[name]
    scene = synthetic.scene()
    first = real_camera.taken(2 * seed, colour, replace(real_camera.drawn_light(rng), exposure=1.0))
    if calibrates:
        scene = replace(scene, calibration=calibrate([first], scene, "drawn", rng).calibration)
    light = real_camera.drawn_light(rng)
    for kind, shade in ((("clean", None)), *real_camera.SHADES.items()):
        places = np.zeros((0, 2)) if shade is None else synthetic.scattered(rng, PARTICLES)
        frame = real_camera.taken(2 * seed + 1, colour, light, places, shade or (1, 1, 1))
        yield seen(frame, scene, places, name, kind, rng)


def seen(frame: Frame, scene: Scene, places: Floats, name: str, kind: str, rng: np.random.Generator) -> Seen:
    try:
        observation = perceive([frame], scene, rng)
    except NoSurface:
        return Seen(name, kind, len(places), refused=True)
    found, false = compared(observation, places)
    surface = scene.surface.width * scene.surface.depth
    whole = any(area.covered > WHOLE * surface for area in observation.areas)
    return Seen(name, kind, len(places), found, false, whole)


def report(results: Iterable[Seen]) -> None:
    results = list(results)
    clean = [each for each in results if each.kind == "clean"]
    print(
        f"clean frames: {len(clean)}, with false dirt {sum(each.false > 0 for each in clean)}, "
        f"false patches {sum(each.false for each in clean)}, "
        f"whole tables {sum(each.whole for each in clean)}, refused {sum(each.refused for each in clean)}"
    )
    print(f"{'kind':8}{'surface':10}{'particles':>10}{'recall':>8}{'precision':>11}")
    for kind in dict.fromkeys(each.kind for each in results if each.kind != "clean"):
        for surface in ("all", *sorted({each.surface for each in results})):
            these = [e for e in results if e.kind == kind and surface in ("all", e.surface)]
            total = Counter[str]()
            for e in these:
                total.update(particles=e.particles, found=e.found, false=e.false)
            recall = total["found"] / max(total["particles"], 1)
            precision = total["found"] / max(total["found"] + total["false"], 1)
            print(f"{kind:8}{surface:10}{total['particles']:10}{recall:8.4f}{precision:11.4f}")


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--pairs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0, help="the first pair's")
    parser.add_argument("--defaults", action="store_true", help="without a calibration")
    asked = parser.parse_args()
    cv2.setNumThreads(1)
    report(e for n in range(asked.pairs) for e in pair(asked.seed + n, not asked.defaults))


if __name__ == "__main__":
    main()
