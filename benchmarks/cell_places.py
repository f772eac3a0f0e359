"""How exactly a board and touches tell places: python benchmarks/cell_places.py [--draws N] [--seed N].

Draws pictures of the boards of `cleancli cell board` from random poses of a camera of 640 x 480 pixels: 75 to
95 cm above the table, up to 25 degrees off looking straight down, with boards that lie turned somewhere near
the middle. Colour has noise of 4 of 255 and is blurred by 0.7 pixels, depth has 1.4 mm at one metre and 0.3 %
of bias, but where a row says otherwise. Prints by how much the pose that `cleancli cell camera` finds is off,
the median and the 95th of a hundred, and how often there is none. Then by how much the height is off that
nine touches with 1 mm of noise tell, in the middle and at the worst corner of a table of 90 x 70 cm, as root
mean squares of 100 times so many draws, and how often a touch that is 5 mm too high is named.

About a minute of CPU for 40 draws; with `--quick` (2 draws) some seconds.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from cleancli.cell.board import BOARDS, Board
from cleancli.cell.camera import Laid, NoBoard, sighted
from cleancli.cell.touches import Touch, touched
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.scene.check import load_scene
from support.board_pictures import Optics, errors, looking, picture

BIAS = 0.003
"""Share by which depth is too large."""
TOUCH_NOISE, MISTAKE = 0.001, 0.005
"""Metres."""
TOUCHED = np.array([(x, y) for x in (-0.3, 0.0, 0.3) for y in (-0.25, 0.0, 0.25)])

Case = tuple[Optics, int, bool]
"""How pictures are taken, how many, and whether they have depth."""

CASES: Mapping[str, Case] = {
    "one picture": (Optics(bias=BIAS), 1, True),
    "ten pictures": (Optics(bias=BIAS), 10, True),
    "colour alone": (Optics(bias=BIAS), 1, False),
    "a lens of k1 = -0.2, rectified": (Optics(bias=BIAS, distortion=(-0.2, 0.05, 0.001, -0.001)), 1, True),
    "a third covered": (Optics(bias=BIAS, covered=0.33), 1, True),
    "blur of 1.2 pixels, twice the noise": (Optics(blur=1.2, colour=8.0, bias=BIAS), 1, True),
}


def pose_error(board: Board, case: Case, rng: np.random.Generator) -> tuple[float, float] | None:
    """Millimetres and degrees by which a pose is off that pictures of one draw tell; None where none do."""
    optics, count, has_depth = case
    pose = looking(rng.uniform(0.75, 0.95), rng.uniform(0, 25), rng.uniform(0, 360), rng.uniform(-180, 180))
    laid = Laid((rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05)), rng.uniform(-np.pi, np.pi))
    frames = [picture(board, laid, pose, rng, optics) for _ in range(count)]
    if not has_depth:
        for frame in frames:
            frame.depth[:] = 0
    try:
        return errors(sighted(frames, laid, rng).pose, pose)
    except NoBoard:
        return None


def poses(draws: int, seed: int) -> Iterator[str]:
    """A row for each board and case."""
    yield "| board | pictures | place off, mm | angle off, degrees | not found |"
    yield "|---" * 5 + "|"
    for name, board in BOARDS.items():
        for told, case in CASES.items():
            rng = np.random.default_rng(seed)
            drawn = [pose_error(board, case, rng) for _ in range(draws)]
            found = np.array([each for each in drawn if each is not None]).reshape(-1, 2)
            if not len(found):
                yield f"| {name} | {told} | | | {draws} of {draws} |"
                continue
            (place, angle), (far, wide) = np.median(found, axis=0), np.quantile(found, 0.95, axis=0)
            cells = f"{place:.2f}, {far:.2f} | {angle:.3f}, {wide:.3f}"
            yield f"| {name} | {told} | {cells} | {draws - len(found)} of {draws} |"


def heights(draws: int, seed: int) -> str:
    """What nine touches tell."""
    surface = load_scene(read_source(find("two_groups", "problems"))).surface
    rng = np.random.default_rng(seed)
    asked = np.array([(0.0, 0.0), (surface.width / 2, surface.depth / 2)])
    off, said, named = [], [], 0
    for number in range(draws):
        places = np.column_stack([TOUCHED, np.zeros(len(TOUCHED))])
        noisy = places + rng.normal(0, TOUCH_NOISE, places.shape)
        touches = [Touch((float(x), float(y), float(z))) for x, y, z in noisy]
        found = touched(touches, BOARDS["a3"], Laid(), surface, np.eye(4))
        normal = found.pose[:3, 2]
        flat = np.column_stack([asked, np.zeros(len(asked))])
        off.append((flat - found.pose[:3, 3]) @ normal)
        said.append(found.height_errors)
        x, y, z = touches[number % 9].tool
        touches[number % 9] = Touch((x, y, z + MISTAKE))
        doubts = touched(touches, BOARDS["a3"], Laid(), surface, np.eye(4)).doubts
        named += any(doubt.startswith(f"touch {number % 9 + 1} ") for doubt in doubts)
    made, told = (1000 * np.sqrt((np.array(each, np.float64) ** 2).mean(axis=0)) for each in (off, said))
    return (
        f"nine touches: the height is {made[0]:.2f} mm off in the middle (said: {told[0]:.2f}) and "
        f"{made[1]:.2f} mm at the worst corner (said: {told[1]:.2f}); "
        f"of {draws} mistakes {named / draws:.0%} are named"
    )


def main() -> None:
    """Draw, and print both."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--draws", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    draws = 2 if options.quick else options.draws
    for line in poses(draws, options.seed):
        print(line, flush=True)
    print("", heights(100 * draws, options.seed), sep="\n")


if __name__ == "__main__":
    main()
