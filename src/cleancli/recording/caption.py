"""Texts in a band above a picture, where they lie on nothing that the picture shows."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from cleancli.array_types import Image

ROW = 32
"""Height of a row of text, pixels; even, as the pictures of a video must be."""

SCALE = 0.7
"""Of the font, where there is room: letters are then about 15 pixels high."""

GAP = 12  # pixels beside a text
PAPER = (28, 33, 40)
INK = (255, 255, 255)
_FONT = cv2.FONT_HERSHEY_SIMPLEX


def captioned(picture: Image, *rows: tuple[str, str]) -> Image:
    """The picture under a band with a row for each pair of texts, one on the left and one on the right."""
    width = picture.shape[1]
    band = np.full((ROW * len(rows), width, 3), PAPER, np.uint8)
    for number, texts in enumerate(rows):
        scale = fitting(texts, width)
        left, right = texts
        baseline = ROW * number + ROW - 10
        _put(band, left, GAP, baseline, scale)
        _put(band, right, width - GAP - width_of(right, scale), baseline, scale)
    return np.vstack([band, picture])


def fitting(texts: Sequence[str], width: int) -> float:
    """The scale of the font at which texts fit beside each other into so many pixels."""
    wanted = sum(width_of(text, SCALE) for text in texts)
    room = width - GAP * (len(texts) + 1)
    return SCALE * min(1.0, max(room, 1) / max(wanted, 1))


def width_of(text: str, scale: float) -> int:
    """How many pixels wide a text is."""
    return int(cv2.getTextSize(text, _FONT, scale, 1)[0][0])


def _put(band: Image, text: str, left: int, baseline: int, scale: float) -> None:
    cv2.putText(band, text, (left, baseline), _FONT, scale, INK, 1, cv2.LINE_AA)
