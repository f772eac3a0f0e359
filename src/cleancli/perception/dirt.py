"""Background subtraction and noise removal (§3.1): which pixels of the surface are dirty.

Nothing is known about the dirt but that its patches are smaller than the background's. The masks given leave
out the edges of objects, so no colour but the surface's and the dirt's is met.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import cv2
import numpy as np
from numpy.typing import NDArray

from cleancli.perception.surface import Mask

Image = NDArray[np.uint8]

GRADIENT = 0.045
"""Change of brightness from one pixel to the next, as a share of it, below which a region grows on."""

BACKGROUND = 400
"""Pixels above which a region is background."""

NEIGHBOURHOOD = 31
"""Pixels (width of a square) over which the background's brightness is averaged."""

CONTRAST = 0.10
"""A pixel that differs from the background around it by a smaller share of its brightness belongs to it."""

AGREEMENT = 2 / 3
"""The share of the frames showing a pixel in which it must be dirty to be believed so."""


@dataclass(frozen=True, slots=True)
class Subtraction:
    """What is left of the surface without its background, (height, width) both.

    `left`: the pixels that no background region took in. `contrast`: how far each pixel's brightness is from
    that of the background around it, as a share of it.
    """

    left: Mask
    contrast: NDArray[np.float32]


def subtract_background(colour: Image, surface: Mask) -> Subtraction:
    """Grow regions over relative gradients within `surface`, and take away the large ones."""
    grey = cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY).astype(np.float32)
    background = _background(grey, surface)
    return Subtraction(surface & ~background, _contrast(grey, background))


def without_specks(subtraction: Subtraction) -> Mask:
    """What is left after a 3 x 3 median filter, without the rims that look like the background.

    A gradient reaches one pixel beyond the dirt that causes it. Those rims go only after the filter, which
    would eat up a lentil without them.
    """
    filtered = cv2.medianBlur(subtraction.left.view(np.uint8), 3).view(np.bool_)
    # A pixel that dirt covers by half has half of the contrast of its darkest neighbour.
    strongest = cv2.dilate(subtraction.contrast, np.ones((3, 3), np.uint8))
    return np.asarray(filtered & (subtraction.contrast > np.maximum(CONTRAST, strongest / 2)))


def believed(dirty_masks: Sequence[Mask], seen_masks: Sequence[Mask]) -> tuple[Mask, Mask]:
    """The pixels believed dirty, and those that were seen often enough to believe anything about them.

    Masks are those of successive frames. A pixel counts as seen if at least half of the frames show it, and
    as dirty if it is dirty in two thirds of those.
    """
    dirt = np.sum(dirty_masks, axis=0, dtype=np.uint8)
    shown = np.sum(seen_masks, axis=0, dtype=np.uint8)
    seen = shown >= ceil(len(seen_masks) / 2)
    needed = np.array([max(ceil(AGREEMENT * n), 1) for n in range(len(seen_masks) + 1)], np.uint8)
    return np.asarray(seen & (dirt >= needed[shown])), np.asarray(seen)


def _background(grey: NDArray[np.float32], surface: Mask) -> Mask:
    across = cv2.Sobel(grey, cv2.CV_32F, 1, 0, ksize=3, scale=1 / 8)
    down = cv2.Sobel(grey, cv2.CV_32F, 0, 1, ksize=3, scale=1 / 8)
    # Brightness below 8 of 255 is noise; dividing by it would make gradients of nothing.
    brightness = np.maximum(cv2.blur(grey, (3, 3)), 8)
    smooth = surface & (cv2.magnitude(across, down) < GRADIENT * brightness)
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(smooth.view(np.uint8), connectivity=4)
    large = statistics[:, cv2.CC_STAT_AREA] > BACKGROUND
    large[0] = False
    return np.asarray(large.take(np.asarray(labels, np.int32)))


def _contrast(grey: NDArray[np.float32], background: Mask) -> NDArray[np.float32]:
    """1, the contrast of black, where there is no background near enough to compare with."""
    size = (NEIGHBOURHOOD, NEIGHBOURHOOD)
    weight = background.astype(np.float32)
    share = cv2.blur(weight, size)
    mean = cv2.blur(grey * weight, size) / np.maximum(share, 1e-6)
    contrast = np.asarray(np.abs(grey - mean) / np.maximum(mean, 8), np.float32)
    contrast[share < 1e-3] = 1
    return contrast
