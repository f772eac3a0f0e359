"""Background subtraction and noise removal (§3.1): which pixels of the surface are dirty.

Nothing is known about the dirt but that its patches are smaller than the background's. The masks given leave out
the edges of objects, so no colour but the surface's and the dirt's is met.
"""

from __future__ import annotations

from collections.abc import Sequence
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


def dirty(colour: Image, surface: Mask) -> Mask:
    """The pixels of `surface` that no large region of even brightness takes in.

    Regions grow over relative gradients first; then they take in the pixels at their rim that look like them,
    for a gradient reaches one pixel beyond the dirt that causes it.
    """
    grey = cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY).astype(np.float32)
    background = _background(grey, surface)
    left = surface & ~background
    return left & (_relative_difference(grey, background) > CONTRAST)


def without_specks(mask: Mask) -> Mask:
    """The mask after a 3 x 3 median filter."""
    return cv2.medianBlur(mask.view(np.uint8), 3).view(np.bool_)


def believed(dirty_masks: Sequence[Mask], seen_masks: Sequence[Mask]) -> tuple[Mask, Mask]:
    """The pixels believed dirty, and those that were seen often enough to believe anything about them.

    Masks are those of successive frames. A pixel counts as seen if at least half of the frames show it, and as
    dirty if it is dirty in two thirds of those.
    """
    dirt = np.sum(dirty_masks, axis=0, dtype=np.uint8)
    shown = np.sum(seen_masks, axis=0, dtype=np.uint8)
    seen = shown >= ceil(len(seen_masks) / 2)
    needed = np.array([max(ceil(AGREEMENT * n), 1) for n in range(len(seen_masks) + 1)], np.uint8)
    return seen & (dirt >= needed[shown]), seen


def _background(grey: NDArray[np.float32], surface: Mask) -> Mask:
    across = cv2.Sobel(grey, cv2.CV_32F, 1, 0, ksize=3, scale=1 / 8)
    down = cv2.Sobel(grey, cv2.CV_32F, 0, 1, ksize=3, scale=1 / 8)
    # Brightness below 8 of 255 is noise; dividing by it would make gradients of nothing.
    brightness = np.maximum(cv2.blur(grey, (3, 3)), 8)
    smooth = surface & (cv2.magnitude(across, down) < GRADIENT * brightness)
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(smooth.view(np.uint8), connectivity=4)
    large = statistics[:, cv2.CC_STAT_AREA] > BACKGROUND
    large[0] = False
    return np.asarray(large[labels])


def _relative_difference(grey: NDArray[np.float32], background: Mask) -> NDArray[np.float32]:
    """How far each pixel's brightness is from the mean of the background around it, as a share of that."""
    size = (NEIGHBOURHOOD, NEIGHBOURHOOD)
    weight = background.astype(np.float32)
    share = cv2.blur(weight, size)
    mean = cv2.blur(grey * weight, size) / np.maximum(share, 1e-6)
    difference = np.abs(grey - mean) / np.maximum(mean, 8)
    return np.where(share > 0, difference, np.float32(np.inf))
