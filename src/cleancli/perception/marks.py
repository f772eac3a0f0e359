"""Lines, arrows and labels drawn on pictures, that can be seen on every colour: light on a dark edge.

Whatever the ground is, it is far from one of the two.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np

from cleancli.array_types import Floats, Image, Ints
from cleancli.perception.labels import Box

Colour = tuple[int, int, int]

EDGE: Colour = (15, 15, 20)
ELLIPSE: Colour = (255, 214, 40)
STROKE: Colour = (120, 205, 255)

WIDTH = 2  # of a line, pixels in a picture that is `USUAL` high; its edge is one more on both sides
USUAL = 480
BESIDE = 4.0  # from what a line goes around to its middle, likewise
HEAD = 11.0  # length of an arrow's head, likewise
SHORTEST = 2.0  # times its head: a shorter piece of a way has none, the last one aside

_FONT = cv2.FONT_HERSHEY_SIMPLEX
_SCALE = 0.42
_LINE = 15  # from one line of a label to the next
_MARGIN = 3
_INK: Colour = (15, 15, 15)


def scale_of(picture: Image) -> float:
    """By how much marks are larger than in a picture of the usual height; small ones have marks as large."""
    height: int = picture.shape[0]
    return max(1.0, height / USUAL)


def grown(outline: Ints, by: float) -> Ints:
    """An outline (n, 1, 2) whose pixels lie so much farther from its middle."""
    offsets = outline - outline.mean(axis=(0, 1))
    lengths = np.maximum(np.linalg.norm(offsets, axis=2, keepdims=True), 1e-9)
    return np.asarray(np.rint(outline + offsets / lengths * by), np.int32)


def line(picture: Image, pixels: Ints, colour: Colour, closed: bool = False) -> None:
    """Draw the line through `pixels` (n, 1, 2)."""
    scale = scale_of(picture)
    for paint, width in ((EDGE, WIDTH + 2), (colour, WIDTH)):
        cv2.polylines(picture, [pixels], closed, paint, round(width * scale), cv2.LINE_AA)


def arrow(picture: Image, pixels: Floats, colour: Colour) -> None:
    """Draw the way through `pixels` (n, 2), with a head at the end of each piece that has room for one."""
    if len(pixels) < 2:
        return
    way = np.rint(pixels).astype(np.int32)[:, None, :]
    line(picture, way, colour)
    scale = scale_of(picture)
    pieces = list(pairwise(pixels))
    for number, (begin, end) in enumerate(pieces, start=1):
        long = float(np.linalg.norm(end - begin))
        if long > SHORTEST * HEAD * scale or (number == len(pieces) and long > 0):
            corners = head(begin, end, HEAD * scale)
            cv2.fillPoly(picture, [corners], EDGE, cv2.LINE_AA)
            cv2.polylines(picture, [corners], True, EDGE, round(3 * scale), cv2.LINE_AA)
            cv2.fillPoly(picture, [corners], colour, cv2.LINE_AA)


def head(begin: Floats, end: Floats, length: float) -> Ints:
    """(3, 1, 2) corners of the head of an arrow from `begin` to `end`, (2,) pixels each."""
    ahead = (end - begin) / np.linalg.norm(end - begin)
    aside = np.array((-ahead[1], ahead[0])) * length / 2
    back = end - ahead * length
    return np.rint((end, back + aside, back - aside)).astype(np.int32)[:, None, :]


def size_of(lines: Sequence[str], scale: float) -> tuple[int, int]:
    """Width and height of a label with these lines, pixels."""
    wide = max((cv2.getTextSize(text, _FONT, _SCALE * scale, 1)[0][0] for text in lines), default=0)
    return round(wide + 2 * _MARGIN * scale), round((_LINE * len(lines) + _MARGIN) * scale)


def label(picture: Image, lines: Sequence[str], box: Box) -> None:
    """Write lines into a box of their size, on paper through which dirt can still be seen."""
    scale = scale_of(picture)
    left, top, right, bottom = box
    ground = picture[top:bottom, left:right]
    ground[:] = (ground // 4 + np.uint8(190)).astype(np.uint8)
    for number, text in enumerate(lines, start=1):
        place = round(left + _MARGIN * scale), round(top + (_LINE * number - _MARGIN) * scale)
        cv2.putText(picture, text, place, _FONT, _SCALE * scale, _INK, 1, cv2.LINE_AA)


def connect(picture: Image, box: Box, named: Box, colour: Colour) -> None:
    """Draw the shortest line from a label's box to the box of what it names, if they lie apart."""
    begin, end = nearest(box, named), nearest(named, box)
    if np.abs(np.subtract(begin, end)).max() > 2 * _LINE * scale_of(picture):
        line(picture, np.array((begin, end), np.int32)[:, None, :], colour)


def nearest(box: Box, other: Box) -> tuple[int, int]:
    """The pixel of a box that is nearest to the middle of another."""
    x, y = (other[0] + other[2]) // 2, (other[1] + other[3]) // 2
    return min(max(x, box[0]), box[2] - 1), min(max(y, box[1]), box[3] - 1)
