"""Whether a surface still looks as it did when its thresholds were adjusted (§3.1: "adjusted again if either
the surface or the lighting changes significantly")."""

from __future__ import annotations

from math import acos, degrees

import numpy as np

from cleancli.array_types import Floats, Image, Mask
from cleancli.perception.geometry import Plane, PlaneView
from cleancli.perception.surface import STRIDE
from cleancli.scene.calibration import Appearance
from cleancli.scene.model import Surface

COLUMNS, ROWS = 6, 4
"""Parts of the surface whose colours are compared."""

LEAST_SEEN = 10
"""Sampled pixels of a part that must show it, for its colour to count."""

BRIGHTER = 0.15
"""Share by which the surface may be brighter or darker than it was; chosen."""

UNEVEN = 0.15
"""Share by which one part may have changed differently from another; chosen."""

RECOLOURED = 0.04
"""How much the shares of red, green and blue in the surface's colour may change; chosen."""

TURNED = 10.0
"""Degrees by which the camera's axis may be nearer to the surface, or farther from it; chosen."""

Colours = Floats


def colours_of(image: Image, background: Mask, seen_as: PlaneView, surface: Surface) -> Colours:
    """Mean colours (ROWS * COLUMNS, 3) of the parts of the surface, from the south-west; NaN where unseen.

    `image` (height, width, 3) shows the surface itself where `background` (height, width) holds.
    """
    step = slice(STRIDE // 2, None, STRIDE)
    colour, x, y = image[step, step], seen_as.x[step, step], seen_as.y[step, step]
    column = np.floor((x / surface.width + 0.5) * COLUMNS)
    row = np.floor((y / surface.depth + 0.5) * ROWS)
    known = background[step, step] & (column >= 0) & (column < COLUMNS) & (row >= 0) & (row < ROWS)
    part = (row[known] * COLUMNS + column[known]).astype(int)
    number = np.bincount(part, minlength=ROWS * COLUMNS)
    total = np.stack([np.bincount(part, c, ROWS * COLUMNS) for c in colour[known].T.astype(float)], axis=1)
    means = np.full((ROWS * COLUMNS, 3), np.nan)
    enough = number >= LEAST_SEEN
    means[enough] = total[enough] / number[enough, None]
    return means


def tilt_of(plane: Plane, axis: Floats) -> float:
    """Radians between the optical axis (3,) and the surface's normal."""
    return acos(min(1.0, max(-1.0, -float(plane.normal @ axis))))


def doubts(colours: Colours, tilt: float, calibrated: Appearance) -> tuple[str, ...]:
    """Why thresholds adjusted for a surface that looked so may not fit one with these `colours`, for people.

    `colours` as `colours_of` gives them, `tilt` as `tilt_of`.
    """
    found = []
    turned = degrees(tilt - calibrated.tilt)
    if abs(turned) > TURNED:
        slant = "flatter" if turned > 0 else "steeper"
        found.append(
            f"the camera looks at the surface {abs(turned):.0f} degrees {slant} than when calibrated"
        )
    then = np.array(calibrated.colours)
    if then.shape != colours.shape:
        return (*found, "the calibration divides the surface into other parts")
    both = np.isfinite(colours).all(axis=1) & (then.max(axis=1) > 0)
    if not both.any():
        return tuple(found)
    now, then = colours[both], then[both]
    ratio = now.mean(axis=1) / np.maximum(then.mean(axis=1), 1.0)
    change = float(np.median(ratio))
    if abs(change - 1) > BRIGHTER:
        way = "brighter" if change > 1 else "darker"
        found.append(f"the surface is {abs(change - 1):.0%} {way} than when calibrated")
    elif np.abs(ratio / change - 1).max() > UNEVEN:
        found.append("light falls differently on the surface than when calibrated")
    shares = np.abs(now / now.sum(axis=1, keepdims=True) - then / then.sum(axis=1, keepdims=True))
    if np.median(shares.max(axis=1)) > RECOLOURED:
        found.append("the surface, or the light on it, has another colour than when calibrated")
    return tuple(found)
