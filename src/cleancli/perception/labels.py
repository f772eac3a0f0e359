"""Where names stand in a picture: beside what they name, and on as little as can be of what is there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cleancli.array_types import Longs, Mask

Box = tuple[int, int, int, int]
"""Left, top, right and bottom in pixels; right and bottom are not part of it."""

DISTANCES = (4, 10, 18, 30, 46, 68)
"""Pixels between a label and what it names, the ones that are tried first."""

DIRECTIONS = ((1, 0), (0, -1), (-1, 0), (0, 1), (1, -1), (1, 1), (-1, -1), (-1, 1))
"""From what is named to its label, right and down, the ones that are tried first."""


def placed(sizes: Sequence[tuple[int, int]], around: Sequence[Box], busy: Mask) -> tuple[Box, ...]:
    """A box inside the picture for each label, given its width and height and the box of what it names.

    Of all places around that, a label has the one that covers the fewest pixels that are `busy` (height,
    width) or another label's; of several, the nearest.
    """
    height, width = busy.shape
    taken = busy.copy()
    boxes = []
    for size, named in zip(sizes, around, strict=True):
        sums = _sums(taken)
        box = min(_places(named, size, (width, height)), key=lambda place: _inside(sums, place))
        left, top, right, bottom = box
        taken[top:bottom, left:right] = True
        boxes.append(box)
    return tuple(boxes)


def box_of(pixels: Longs) -> Box:
    """The box around pixels (n, 2), each with its column and row."""
    (left, top), (right, bottom) = pixels.min(axis=0).tolist(), pixels.max(axis=0).tolist()
    return left, top, right + 1, bottom + 1


def _places(named: Box, size: tuple[int, int], picture: tuple[int, int]) -> Iterator[Box]:
    """Places around a box, the nearest first, moved into the picture where they stick out."""
    left, top, right, bottom = named
    width, height = size
    for away in DISTANCES:
        xs = left - away - width, (left + right - width) // 2, right + away
        ys = top - away - height, (top + bottom - height) // 2, bottom + away
        for across, down in DIRECTIONS:
            x = min(max(xs[across + 1], 0), max(picture[0] - width, 0))
            y = min(max(ys[down + 1], 0), max(picture[1] - height, 0))
            yield x, y, x + width, y + height


def _sums(mask: Mask) -> Longs:
    """(height + 1, width + 1) how many pixels hold above and left of each corner."""
    sums = np.zeros((mask.shape[0] + 1, mask.shape[1] + 1), np.int64)
    np.cumsum(np.cumsum(mask, axis=0, dtype=np.int64), axis=1, out=sums[1:, 1:])
    return sums


def _inside(sums: Longs, box: Box) -> int:
    """How many pixels of the mask hold in a box, as far as it lies in the picture."""
    height, width = sums.shape[0] - 1, sums.shape[1] - 1
    left, top, right, bottom = box[0], box[1], min(box[2], width), min(box[3], height)
    return int(sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left])
