"""The boards by which a camera is calibrated: chessboards with a marker in every white square (ChArUco), to
be printed on paper.

Corners are where black squares meet, and are called as on a chessboard: letters from the left, numbers from
the bottom. A board's coordinates begin in its middle, x to the right and y to the top of the sheet.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from string import ascii_lowercase
from types import MappingProxyType

import cv2
import numpy as np

from cleancli.array_types import Bools, Image, Points

MODULES = 8
"""Parts of a square's side; a marker is 6 of them wide: 4 bits and its black border."""
MARKER = 6
BAR = 0.2
"""Metres that the bar on the sheet measures, if it was printed in true size."""
TOP = 0.012
"""Metres from the sheet's upper edge to the board: printers leave about 6 mm white."""


@dataclass(frozen=True, slots=True)
class Board:
    """`sheet`: width and height of the paper, metres. `columns`, `rows`: of squares, of `square` metres each.
    `first`: the number of its first marker; no two boards share one, so that each is known by its markers."""

    name: str
    sheet: tuple[float, float]
    columns: int
    rows: int
    square: float
    first: int

    @property
    def places(self) -> Points:
        """Where the corners are, (n, 2): rows from the top, each from the left, as OpenCV numbers them."""
        columns, rows = np.meshgrid(np.arange(1, self.columns), np.arange(1, self.rows))
        right, down = columns.ravel() - self.columns / 2, rows.ravel() - self.rows / 2
        return self.square * np.column_stack([right, -down])

    @property
    def corner_names(self) -> tuple[str, ...]:
        """In the order of `places`."""
        letters = ascii_lowercase[: self.columns - 1]
        return tuple(f"{letter}{row}" for row in range(self.rows - 1, 0, -1) for letter in letters)


BOARDS: Mapping[str, Board] = MappingProxyType(
    {
        "a4": Board("a4", (0.297, 0.210), 6, 4, 0.044, 0),
        "a3": Board("a3", (0.420, 0.297), 8, 5, 0.048, 12),
    }
)
"""Squares are as large as the paper allows: from 0.9 m a usual camera sees a module as 3 pixels."""


def charuco(board: Board) -> cv2.aruco.CharucoBoard:
    """The board as OpenCV describes it, in modules."""
    markers = np.arange(board.first, board.first + board.columns * board.rows // 2)
    return cv2.aruco.CharucoBoard(
        (board.columns, board.rows),
        MODULES,
        MARKER,
        cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50),
        markers.astype(np.int32),
    )


def raster(board: Board) -> Image:
    """The board with one pixel a module, 0 where it is black and 255 where it is white."""
    size = board.columns * MODULES, board.rows * MODULES
    return np.asarray(charuco(board).generateImage(size, marginSize=0), np.uint8)


def svg(board: Board) -> str:
    """The sheet to print, in millimetres, with a bar to hold a ruler to, whose middle tick and three marks at
    the other edges point to the board's middle."""
    width, height = (1000 * side for side in board.sheet)
    side = 1000 * board.square
    left, top = (width - side * board.columns) / 2, 1000 * TOP
    right, bottom = left + side * board.columns, top + side * board.rows
    module = side / MODULES
    black = "".join(
        f"M{left + module * x:g} {top + module * y:g}h{module * wide:g}v{module * high:g}h{-module * wide:g}z"
        for x, y, wide, high in _rectangles(raster(board) == 0)
    )
    names = [_text(left + side * n, bottom + 5, ascii_lowercase[n - 1]) for n in range(1, board.columns)]
    names += [
        _text(x, bottom - side * n + 1.5, str(n)) for n in range(1, board.rows) for x in (left - 5, right + 5)
    ]
    middle = (top + bottom) / 2
    marks = f"M{width / 2:g} {top - 2:g}v-4M{left - 9:g} {middle:g}h-4M{right + 9:g} {middle:g}h4"
    bar = _bar((width - 1000 * BAR) / 2, bottom + 9)
    told = (
        f"cleancli board {board.name}, squares of {side:g} mm. Print at 100 %, not fitted to the page: "
        f"the bar is {1000 * BAR:g} mm long."
    )
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{height:g}mm" '
            f'viewBox="0 0 {width:g} {height:g}">',
            f'<rect width="{width:g}" height="{height:g}" fill="white"/>',
            f'<path shape-rendering="crispEdges" d="{black}"/>',
            *names,
            f'<path fill="none" stroke="black" stroke-width="0.25" d="{marks}"/>',
            f'<path fill="none" stroke="black" stroke-width="0.25" d="{bar}"/>',
            _text(width / 2, bottom + 17, told),
            "</svg>\n",
        ]
    )


def _text(x: float, y: float, words: str) -> str:
    style = 'font-family="sans-serif" font-size="4" text-anchor="middle"'
    return f'<text x="{x:g}" y="{y:g}" {style}>{words}</text>'


def _bar(left: float, y: float) -> str:
    """A line with a tick each centimetre, those at its ends longer."""
    length = round(1000 * BAR)
    ticks = (f"M{left + at:g} {y:g}v{3 if at in (0, length) else 1.5:g}" for at in range(0, length + 1, 10))
    return f"M{left:g} {y:g}h{length}{''.join(ticks)}"


def _rectangles(black: Bools) -> Iterator[tuple[int, int, int, int]]:
    """Rectangles that cover what is black (height, width): x, y, width, height. Runs of a row that begin and
    end alike in rows below are one."""
    left = black.copy()
    for y, x in np.argwhere(black):
        if not left[y, x]:
            continue
        wide = int(np.argmin(np.append(left[y, x:], False)))
        high = 1
        while y + high < len(left) and _is_run(left[y + high], x, wide):
            high += 1
        left[y : y + high, x : x + wide] = False
        yield int(x), int(y), wide, high


def _is_run(row: Bools, x: int, wide: int) -> bool:
    """Whether a row is black from `x` on for just so many pixels."""
    padded = np.pad(row, 1)
    return bool(padded[x + 1 : x + 1 + wide].all() and not padded[x] and not padded[x + 1 + wide])
