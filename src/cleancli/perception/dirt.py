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

from cleancli.array_types import Depth, Image, Mask, Singles
from cleancli.scene.calibration import Thresholds

NEIGHBOURHOOD = 31
"""Pixels (width of a square) over which the background's colour is averaged."""

CORE = 5
"""Pixels (width of a square) of a region around each pixel that counts for its size. A line of ink may be
long; the background is wide, too."""

RIM = 1 / 3
"""Share of the strongest neighbour's contrast up to which a pixel is the rim of dirt, and none itself."""

_MEAN = np.full((1, 3), 1 / 3, np.float32)


@dataclass(frozen=True, slots=True)
class Subtraction:
    """What is left of the surface without its background, (height, width) each.

    `left`: the pixels that no background region took in; `background`: those that one did. `contrast`: how
    far the colour of each pixel that is left is from that of the background around it, as a share of the
    brightness (root of the mean square of the channels), which counts as `darkest` where it is less.
    """

    left: Mask
    contrast: Singles
    background: Mask


def subtract_background(
    colour: Image, surface: Mask, pixel_areas: Depth, thresholds: Thresholds
) -> Subtraction:
    """Grow regions over relative gradients within `surface`, and take away those with a large area.

    `pixel_areas`: square metres of the surface behind each pixel.
    """
    background = _background(colour, surface, pixel_areas, thresholds)
    left = surface & ~background
    return Subtraction(left, _contrast(colour, background, left, thresholds.darkest), background)


def without_specks(subtraction: Subtraction, thresholds: Thresholds) -> Mask:
    """What is left after a 3 x 3 median filter, without the rims that look like the background.

    A gradient reaches one pixel beyond the dirt that causes it. Those rims go only after the filter, which
    would eat up a lentil without them.
    """
    filtered = cv2.medianBlur(subtraction.left.view(np.uint8), 3).view(np.bool_)
    # A pixel that dirt covers by a third has a third of the contrast of a neighbour that it covers whole.
    strongest = cv2.dilate(subtraction.contrast, np.ones((3, 3), np.uint8))
    least = np.maximum(np.float32(thresholds.contrast), strongest * np.float32(RIM))
    return np.asarray(filtered & (subtraction.contrast > least))


def without_small_patches(dirt: Mask, pixel_areas: Depth, thresholds: Thresholds) -> Mask:
    """The patches of dirt that are large enough."""
    labels = np.asarray(cv2.connectedComponents(dirt.view(np.uint8), connectivity=8)[1], np.int32)
    sizes = np.bincount(labels[dirt], pixel_areas[dirt], minlength=1)
    large = sizes >= thresholds.patch
    return np.asarray(large.take(labels))


def believed(
    dirty_masks: Sequence[Mask], seen_masks: Sequence[Mask], thresholds: Thresholds
) -> tuple[Mask, Mask]:
    """The pixels believed dirty, and those that were seen often enough to believe anything about them.

    Masks are those of successive frames. A pixel counts as seen if at least half of the frames show it, and
    as dirty if it is dirty in a large enough share of those.
    """
    dirt = np.sum(dirty_masks, axis=0, dtype=np.uint8)
    shown = np.sum(seen_masks, axis=0, dtype=np.uint8)
    seen = shown >= ceil(len(seen_masks) / 2)
    needed = [max(ceil(thresholds.agreement * n - 1e-9), 1) for n in range(len(seen_masks) + 1)]
    return np.asarray(seen & (dirt >= np.array(needed, np.uint8)[shown])), np.asarray(seen)


def squared_steepness(colour: Image, thresholds: Thresholds) -> Singles:
    """The square of the change of colour at each pixel (height, width), as a share of the one up to which
    regions grow on."""
    limit = _limit(colour, thresholds)
    return np.asarray(_squared_gradient(colour) / (limit * limit), np.float32)


def _background(colour: Image, surface: Mask, pixel_areas: Depth, thresholds: Thresholds) -> Mask:
    limit = _limit(colour, thresholds)
    smooth = surface & (_squared_gradient(colour) < limit * limit)
    number, found = cv2.connectedComponents(smooth.view(np.uint8), connectivity=4)
    labels = np.asarray(found, np.int32)
    core = cv2.erode(smooth.view(np.uint8), np.ones((CORE, CORE), np.uint8)).view(np.bool_)
    sizes = np.bincount(labels[core], pixel_areas[core], minlength=number)
    large = sizes > thresholds.background
    return np.asarray(large.take(labels))


def _limit(colour: Image, thresholds: Thresholds) -> Singles:
    """The change of colour from one pixel to the next up to which a region grows on, of 255."""
    brightness = cv2.blur(cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), (3, 3))
    darkest = np.uint8(min(255, round(thresholds.darkest)))
    return np.asarray(np.float32(thresholds.gradient) * np.maximum(brightness, darkest))


def _squared_gradient(colour: Image) -> Singles:
    """The mean square over three channels: noise in it is as rare as in one channel's."""
    across = cv2.Sobel(colour, cv2.CV_32F, 1, 0, ksize=3, scale=1 / 8)
    down = cv2.Sobel(colour, cv2.CV_32F, 0, 1, ksize=3, scale=1 / 8)
    # In place, for three times the pixels are most of the time that there is.
    cv2.multiply(across, across, dst=across)
    cv2.accumulateSquare(down, across)
    return np.asarray(cv2.transform(across, _MEAN), np.float32)


def _contrast(colour: Image, background: Mask, left: Mask, darkest: float) -> Singles:
    """Worked out around what is left alone, 0 elsewhere. Where no background is near, as in a corner that the
    arm cuts off, it is that to all background; without any, 1, the contrast of black."""
    size, weight = (NEIGHBOURHOOD, NEIGHBOURHOOD), background.view(np.uint8)
    shown = cv2.bitwise_and(colour, colour, mask=weight)
    total = cv2.boxFilter(shown, cv2.CV_32F, size, normalize=False)
    number = cv2.boxFilter(weight, cv2.CV_32F, size, normalize=False)
    # The median reaches a pixel beyond what is left, and each pixel is compared with its neighbours.
    near = np.flatnonzero(cv2.dilate(left.view(np.uint8), np.ones((5, 5), np.uint8)))
    compared = number.ravel()[near]
    mean = total.reshape(-1, 3)[near] / np.maximum(compared, np.float32(1))[:, None]
    mean[compared < 1] = cv2.mean(colour, weight)[:3]
    brightness = np.maximum(mean.mean(axis=1), np.float32(darkest))
    differences = colour.reshape(-1, 3)[near] - mean
    found = np.sqrt((differences * differences).mean(axis=1)) / brightness
    contrast = np.zeros(left.shape, np.float32)
    contrast.ravel()[near] = found if background.any() else np.float32(1)
    return contrast
