"""Perception on a user's own frames of clean tables: `python benchmarks/real_frames.py FOLDER`.

FOLDER is a recording as `cleancli perceive` reads them: looks, the TUM layout, a bag. Onto the parts of
each frame that show the clean surface it pastes particles at known places: round, 3 mm in radius, of the
surface's own colour there times a shade, as sharp as optics leave them, and 2.5 mm nearer to the camera. It
prints recall, precision, false patches on a frame without particles, and CPU milliseconds, for perception
with the scene's thresholds, and calibrated on the first frame. Beside it stand three simpler ways, which
perception tells where the surface is: OpenCV's adaptive threshold, the difference to a wide median, and the
difference to the first frame with its brightness matched. --pictures writes what was pasted. Ten frames
take 20 seconds.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from cleancli.array_types import Floats, Image, Mask, Singles
from cleancli.geometry.rgbd import Frame
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.perception.calibrate import NotClean, calibrate
from cleancli.perception.perceive import BadFrame, Observation, perceive
from cleancli.perception.reading import Reading
from cleancli.perception.sources import recorded_looks
from cleancli.perception.surface import NoSurface
from cleancli.scene.calibration import Thresholds
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from support import real_camera

PARTICLES = 40
APART = 0.03
"""Metres between particles."""
FOUND, FALSE = 0.004, 0.008
"""Metres from a particle's middle within which a dirty pixel finds it, and beyond which a patch is false."""
CLEAR = 12
"""Pixels that a particle keeps from whatever is no clean surface."""
WIDE = 31
"""Pixels of the windows of the simpler ways."""
LEAST = Thresholds().contrast
"""Share of the brightness by which dirt differs, of the simpler ways."""

Way = Callable[[Frame, Mask], Mask]
"""The dirty pixels of a frame, of those that may show the surface."""


@dataclass(frozen=True)
class Pasted:
    """A frame with particles at `pixels` (n, 2), as (column, row), where a metre is `scale` (n,) pixels long;
    `trusted` (height, width) shows the surface."""

    clean: Frame
    frame: Frame
    pixels: Floats
    scale: Floats
    trusted: Mask


@dataclass
class Count:
    """What one way made of all frames; `clean` frames had `false_clean` false patches."""

    particles: int = 0
    found: int = 0
    false: int = 0
    clean: int = 0
    false_clean: int = 0
    seconds: float = 0.0


def pasted(frame: Frame, seen: Observation, shade: Floats, rng: np.random.Generator) -> Pasted:
    """Particles on the clean parts of a frame."""
    trusted = seen.steps.without_edges
    clear = trusted & ~seen.steps.dirty
    room = cv2.erode(clear.view(np.uint8), np.ones((2 * CLEAR + 1, 2 * CLEAR + 1), np.uint8))
    # The image's border is no edge to erosion, but it cuts particles off.
    room[:CLEAR], room[-CLEAR:], room[:, :CLEAR], room[:, -CLEAR:] = 0, 0, 0, 0
    rows, columns = np.nonzero(room)
    chosen: list[int] = []
    for one in rng.permutation(len(rows))[: 40 * PARTICLES].tolist():
        away = float(frame.depth[rows[one], columns[one]])
        near = np.hypot(columns[chosen] - columns[one], rows[chosen] - rows[one]) * away
        if away > 0 and (near > APART * frame.camera.focal).all() and len(chosen) < PARTICLES:
            chosen.append(one)
    pixels = np.column_stack([columns[chosen], rows[chosen]]) + rng.uniform(-0.5, 0.5, (len(chosen), 2))
    scale = frame.camera.focal / frame.depth[rows[chosen], columns[chosen]].astype(float)
    size = (frame.camera.height, frame.camera.width)
    share = real_camera.covered(size, pixels, real_camera.RADIUS * scale)
    share = np.asarray(cv2.GaussianBlur(share, (0, 0), real_camera.SHARPNESS), np.float64)
    colour = frame.colour * (1 - share[:, :, None] * (1 - shade))
    depth = frame.depth - np.where(frame.depth > 0, real_camera.BUMP * share, 0)
    taken = replace(frame, colour=np.round(colour).astype(np.uint8), depth=depth.astype(np.float32))
    return Pasted(frame, taken, pixels, scale, trusted)


def adaptive(frame: Frame, trusted: Mask) -> Mask:
    """OpenCV's adaptive threshold of the brightness, darker or brighter."""
    grey = cv2.cvtColor(frame.colour, cv2.COLOR_RGB2GRAY)
    step = LEAST * float(np.median(grey[trusted]))
    dark, bright = (
        cv2.adaptiveThreshold(each, 255, cv2.ADAPTIVE_THRESH_MEAN_C, cv2.THRESH_BINARY_INV, WIDE, step)
        for each in (grey, cv2.bitwise_not(grey))
    )
    return np.asarray((cv2.bitwise_or(dark, bright) > 0) & trusted)


def to_median(frame: Frame, trusted: Mask) -> Mask:
    """The difference of colour to the median around it."""
    return _differs(frame.colour, np.asarray(cv2.medianBlur(frame.colour, WIDE), np.float32)) & trusted


def to_clean(clean: Frame) -> Way:
    """The difference to a picture of the clean surface, as bright as the frame is all over."""

    def way(frame: Frame, trusted: Mask) -> Mask:
        ratio = np.median(frame.colour[trusted] / np.maximum(clean.colour[trusted], 1), axis=0)
        return _differs(frame.colour, (clean.colour * ratio).astype(np.float32)) & trusted

    return way


def _differs(colour: Image, usual: Singles) -> Mask:
    difference = np.sqrt(((colour - usual) ** 2).mean(axis=2))
    return np.asarray(difference > LEAST * np.maximum(usual.mean(axis=2), 1.0))


def without_specks(way: Way) -> Way:
    """With a median filter after it, as perception has one."""

    def filtered(frame: Frame, trusted: Mask) -> Mask:
        dirty = way(frame, trusted)
        return np.asarray((cv2.medianBlur(dirty.astype(np.uint8), 3) > 0) & trusted)

    return filtered


def judged(dirty: Mask, there: Pasted) -> tuple[int, int]:
    """How many particles are found, and how many patches are false."""
    count, labels = cv2.connectedComponents(dirty.view(np.uint8), connectivity=8)
    rows, columns = np.nonzero(dirty)
    if not len(rows) or not len(there.pixels):
        return 0, count - 1
    offsets = there.pixels[:, None] - np.column_stack([columns, rows])[None]
    apart = np.linalg.norm(offsets, axis=2) / there.scale[:, None]
    nearest = np.full(count, np.inf)
    np.minimum.at(nearest, np.asarray(labels, np.int64)[rows, columns], apart.min(axis=0))
    return int((apart.min(axis=1) < FOUND).sum()), int((nearest[1:] > FALSE).sum())


def ways(scene: Scene, first: Frame, rng: np.random.Generator) -> dict[str, Way]:
    """Perception itself, and what stands beside it."""

    def ours(setting: Scene) -> Way:
        def way(frame: Frame, trusted: Mask) -> Mask:
            return perceive([frame], setting, rng).steps.believed

        return way

    found: dict[str, Way] = {"perception": ours(scene)}
    try:
        calibration = calibrate([first], scene, "first frame", rng).calibration
        found["calibrated"] = ours(replace(scene, calibration=calibration))
    except (NotClean, NoSurface) as error:
        print(f"not calibrated: {error}")
    simple = {"adaptive": adaptive, "to median": to_median, "to clean": to_clean(first)}
    return found | {name: without_specks(way) for name, way in simple.items()}


def measured(
    frames: Sequence[Frame], scene: Scene, seed: int, pictures: Path | None
) -> Iterator[tuple[str, str, Count]]:
    """Shade, way and count of each."""
    rng = np.random.default_rng(seed)
    known = [(frame, seen) for frame in frames if (seen := _seen(frame, scene, rng)) is not None]
    print(f"{len(frames)} frames, of which {len(known)} show the surface")
    if not known:
        return
    for name, way in ways(scene, known[0][0], rng).items():
        for kind, shade in real_camera.SHADES.items():
            count = Count()
            # The first frame is what was calibrated on.
            for number, (frame, seen) in enumerate(known[1:] or known):
                there = pasted(frame, seen, np.array(shade), np.random.default_rng((seed, number)))
                _count(count, way, there)
                if pictures is not None and name == "perception":
                    bgr = cv2.cvtColor(there.frame.colour, cv2.COLOR_RGB2BGR)
                    cv2.imwrite(str(pictures / f"{number:03}-{kind}.png"), bgr)
            yield kind, name, count


def _count(count: Count, way: Way, there: Pasted) -> None:
    started = time.process_time()
    try:
        dirty, without = way(there.frame, there.trusted), way(there.clean, there.trusted)
    except NoSurface:
        dirty = without = np.zeros_like(there.trusted)
    count.seconds += (time.process_time() - started) / 2
    found, false = judged(dirty, there)
    count.particles += len(there.pixels)
    count.found += found
    count.false += false
    count.clean += 1
    count.false_clean += cv2.connectedComponents(without.view(np.uint8), connectivity=8)[0] - 1


def _seen(frame: Frame, scene: Scene, rng: np.random.Generator) -> Observation | None:
    try:
        return perceive([frame], scene, rng)
    except (NoSurface, BadFrame) as error:
        print(f"passed over: {error}")
        return None


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scene", default="two_groups", help="whose surface and thresholds hold")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--pictures", type=Path, help="a folder for pictures of what was pasted")
    asked = parser.parse_args()
    cv2.setNumThreads(1)
    scene = load_scene(read_source(find(asked.scene, "problems")))
    if asked.pictures is not None:
        asked.pictures.mkdir(parents=True, exist_ok=True)
    looks, _ = recorded_looks(asked.folder, Reading())
    frames = [frame for _, look in looks for frame in look]
    head = f"{'shade':8}{'way':12}{'particles':>10}{'recall':>8}{'precision':>11}"
    print(head + f"{'false a clean frame':>21}{'ms':>7}")
    for kind, name, count in measured(frames, scene, asked.seed, asked.pictures):
        recall = count.found / max(count.particles, 1)
        precision = count.found / max(count.found + count.false, 1)
        false, spent = count.false_clean / count.clean, 1e3 * count.seconds / count.clean
        print(f"{kind:8}{name:12}{count.particles:10}{recall:8.3f}{precision:11.3f}{false:21.2f}{spent:7.1f}")


if __name__ == "__main__":
    main()
