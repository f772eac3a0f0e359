"""Where a picture shows the corners of a board."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from cleancli.array_types import Image, Longs, Points
from cleancli.cell.board import BOARDS, Board, charuco

LEAST_CORNERS = 6
"""Corners of a board that a picture must show: fewer may lie on one line."""
WINDOW = 0.25
"""Half a window's side, as a share of the distance between neighbours, in which a corner's place is refined:
markers begin at an eighth of a square from it, but on the diagonal, where they pull to no side."""
MOST_DOUBLED = 1280
"""Pixels: pictures up to so wide are looked at in twice their size, in which up to twice as many corners are
found of those that are blurred."""
_STEPS = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 40, 1e-3)


@dataclass(frozen=True, slots=True)
class Corners:
    """The board that was seen, the numbers of its corners (n,), and the `pixels` (n, 2) that show them, as
    (column, row), where whole numbers are the middles of pixels."""

    board: Board
    numbers: Longs
    pixels: Points

    @property
    def places(self) -> Points:
        """(n, 2) on the board, metres."""
        return self.board.places[self.numbers]


def corners_in(image: Image) -> Corners | None:
    """The corners in a picture (height, width, 3) of the board that it shows most of; None if it shows fewer
    than `LEAST_CORNERS` of any, or all of them on a line."""
    grey = np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), np.uint8)
    found = (_of_board(grey, board) for board in BOARDS.values())
    usable = [corners for corners in found if corners is not None and _is_wide(corners)]
    return max(usable, key=lambda corners: len(corners.numbers), default=None)


def _of_board(grey: Image, board: Board) -> Corners | None:
    factor = 2 if grey.shape[1] <= MOST_DOUBLED else 1
    looked_at = cv2.resize(grey, None, fx=factor, fy=factor, interpolation=cv2.INTER_CUBIC)
    at, numbers, _, _ = cv2.aruco.CharucoDetector(charuco(board)).detectBoard(looked_at)
    if numbers is None or len(numbers) < LEAST_CORNERS:
        return None
    # Shapes differ between OpenCV 4 and 5, and so do places: up to 4.13 all are half a pixel off
    # (github.com/opencv/opencv/issues/25539). Refined from there they are the same.
    pixels = (np.asarray(at, np.float32).reshape(-1, 1, 2) - (factor - 1) / 2) / factor
    apart = np.linalg.norm(pixels - pixels.reshape(1, -1, 2), axis=2)
    np.fill_diagonal(apart, np.inf)
    half = max(2, int(WINDOW * apart.min()))
    refined = cv2.cornerSubPix(grey, pixels.copy(), (half, half), (-1, -1), _STEPS)
    return Corners(board, np.ravel(numbers).astype(np.int64), np.asarray(refined, np.float64).reshape(-1, 2))


def _is_wide(corners: Corners) -> bool:
    """Whether the corners lie in several rows and columns of the board."""
    return all(len(np.unique(along.round(4))) > 1 for along in corners.places.T)
