"""The noise of a real camera, measured on its pictures: `python benchmarks/camera_noise.py FOLDER`.

FOLDER holds `colour-000.png` and `depth-000.png` (16 bits, millimetres) and so on. Of blocks of 16 x 16
pixels that show one smooth thing, a quadratic surface is taken away, and of depth a plane; what is left is
noise. It prints its spread by brightness and by distance, its correlations, and how brightness changes
along the radius. Half of the blocks have texture: the quarter with the least spread is what counts.
Ten pictures take about 5 seconds. tests/support/real_camera.py draws frames with these numbers.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from cleancli.array_types import Floats

BLOCK = 16
"""Pixels along a block's side."""
DARK, BRIGHT = 20, 245
"""Mean brightness outside which values are cut off."""
QUIET = 0.25
"""Share of the blocks that count, those with the least spread."""
LAGS = 1, 2, 4

_ROWS, _COLUMNS = np.mgrid[:BLOCK, :BLOCK].reshape(2, -1).astype(float)
_PLANE = np.column_stack([np.ones(BLOCK**2), _COLUMNS, _ROWS])
_SMOOTH = np.column_stack([_PLANE, _COLUMNS**2, _ROWS**2, _COLUMNS * _ROWS])


@dataclass(frozen=True)
class Spread:
    """Blocks' noise: where they are on the scale it may depend on (`level`, n), its standard deviations
    (n, channels), correlations of neighbours `LAGS` pixels apart (n, 3), and of channels (n)."""

    level: Floats
    spread: Floats
    neighbours: Floats
    channels: Floats

    def quiet(self, low: float, high: float) -> tuple[int, Floats, Floats, float]:
        """How many blocks there are between two levels, and medians over the quietest of them."""
        among = np.flatnonzero((self.level >= low) & (self.level < high))
        order = among[np.argsort(self.spread[among].mean(axis=1))]
        few = order[: max(1, int(QUIET * len(order)))]
        medians = [np.median(each[few], axis=0) for each in (self.spread, self.neighbours, self.channels)]
        return len(among), medians[0], medians[1], float(medians[2])


def colour_noise(pictures: Sequence[Floats]) -> Spread:
    """Of pictures (height, width, 3), red, green and blue of 255."""
    taken = [block for picture in pictures for _, block in _blocks(picture)]
    usable = [b for b in taken if b.mean(axis=0).min() > DARK and b.mean(axis=0).max() < BRIGHT]
    return _spread([float(b.mean()) for b in usable], [_residual(b, _SMOOTH) for b in usable])


def depth_noise(depths: Sequence[Floats]) -> Spread:
    """Of depth (height, width) in metres, 0 where unknown; the inverse of depth is linear over a plane."""
    known = [b for depth in depths for _, b in _blocks(depth[:, :, None]) if (b > 0).all()]
    left = [_residual(1 / b, _PLANE) * b.mean() ** 2 for b in known]
    return _spread([float(b.mean()) for b in known], left)


def radial(pictures: Sequence[Floats]) -> Floats:
    """Median change of the logarithm of brightness per half diagonal of the picture, by quarters of the
    radius, (4,): negative where corners are darker."""
    found: list[tuple[float, float]] = []
    for picture in pictures:
        middle = np.array([picture.shape[1], picture.shape[0]]) / 2
        half = float(np.hypot(*middle))
        for corner, block in _blocks(picture):
            out = corner + BLOCK / 2 - middle
            if block.mean() > DARK and block.max() < BRIGHT and _residual(block, _SMOOTH).std() < 6:
                slope = (np.linalg.pinv(_PLANE) @ np.log(np.maximum(block.mean(axis=1), 1)))[1:]
                found.append((float(np.hypot(*out)) / half, float(slope @ out / np.hypot(*out)) * half))
    radius, slopes = np.array(found).T
    return np.array([np.median(slopes[(radius >= q / 4) & (radius < (q + 1) / 4)]) for q in range(4)])


def _blocks(image: Floats) -> Iterator[tuple[Floats, Floats]]:
    """Corner (column, row) and pixels (n, channels) of each block."""
    for row in range(0, image.shape[0] - BLOCK + 1, BLOCK):
        for column in range(0, image.shape[1] - BLOCK + 1, BLOCK):
            block = image[row : row + BLOCK, column : column + BLOCK]
            yield np.array([column, row], float), block.reshape(BLOCK**2, -1)


def _residual(values: Floats, smooth: Floats) -> Floats:
    return np.asarray(values - smooth @ (np.linalg.pinv(smooth) @ values))


def _spread(levels: Sequence[float], left: Sequence[Floats]) -> Spread:
    squares = np.stack(left).reshape(len(left), BLOCK, BLOCK, -1)
    variance = np.maximum((squares**2).mean(axis=(1, 2)), 1e-12)
    alike = [
        ((squares[:, :, lag:] * squares[:, :, :-lag]).mean(axis=(1, 2)) / variance).mean(axis=1)
        for lag in LAGS
    ]
    channels = squares.shape[3]
    pairs = [(i, j) for i in range(channels) for j in range(i)] or [(0, 0)]
    scaled = squares / np.sqrt(variance)[:, None, None, :]
    shared = np.mean([(scaled[..., i] * scaled[..., j]).mean(axis=(1, 2)) for i, j in pairs], axis=0)
    return Spread(np.array(levels), np.sqrt(variance), np.stack(alike, axis=1), shared)


def _read(path: Path) -> Floats:
    picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if picture is None:
        raise SystemExit(f"{path}: no picture")
    return np.asarray(picture, np.float64)


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    pictures = [_read(path)[:, :, ::-1] for path in sorted(folder.glob("colour-*.png"))]
    depths = [_read(path) / 1000 for path in sorted(folder.glob("depth-*.png"))]
    colour, depth = colour_noise(pictures), depth_noise(depths)
    print("brightness  blocks     red   green    blue  correlation at 1, 2, 4 pixels, of channels")
    for low in range(DARK, BRIGHT, 25):
        number, spread, alike, shared = colour.quiet(low, low + 25)
        words = "  ".join(f"{value:6.2f}" for value in (*spread, *alike, shared))
        print(f"{low:4}-{low + 25:<4} {number:8}  {words}")
    print("distance    blocks  mm at 1 m  correlation at 1, 2, 4 pixels")
    for near in (0.3, 0.6, 0.9, 1.2, 1.5):
        number, spread, alike, _ = depth.quiet(near, near + 0.3)
        at_one = 1000 * float(spread[0]) / (near + 0.15) ** 2
        print(
            f"{near:.1f}-{near + 0.3:.1f} m {number:8}  {at_one:9.2f}  "
            + "  ".join(f"{a:5.2f}" for a in alike)
        )
    shares = ", ".join(f"{1 - np.count_nonzero(each) / each.size:.1%}" for each in depths)
    print(f"without depth: {shares}")
    print("change of log brightness outwards, by quarters of the radius:", radial(pictures).round(2))


if __name__ == "__main__":
    main()
