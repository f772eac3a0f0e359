"""What a camera's lens does to its pictures, undone: perception knows pinhole cameras with square pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from cleancli.array_types import Depth, Floats, Image, Singles
from cleancli.geometry.rgbd import Camera, Frame

MODELS = {"plumb_bob": (4, 5), "rational_polynomial": (8,)}
"""Models of distortion by the names that ROS gives them, and how many coefficients each has."""

LARGEST = 1e5
"""Of all numbers of a lens: pixels, and coefficients."""
FARTHEST = 65.535
"""Metres: what 16 bits of millimetres can say. What is farther away is unknown."""


class UnknownLens(Exception):
    """Intrinsics that no picture can be rectified with; the message is a sentence without a subject."""


@dataclass(frozen=True, slots=True)
class Lens:
    """Pinhole with distortion: focal lengths along columns and rows and the optical centre in pixels,
    coefficients in OpenCV's order (k1 k2 p1 p2 k3, and k4 k5 k6 of the rational model)."""

    focal: tuple[float, float]
    centre: tuple[float, float]
    coefficients: tuple[float, ...] = ()

    @property
    def is_pinhole(self) -> bool:
        """Whether pictures need no rectification."""
        return self.focal[0] == self.focal[1] and not any(self.coefficients)


def lens(
    focal: Sequence[float], centre: Sequence[float], model: str = "", coefficients: Sequence[float] = ()
) -> Lens:
    """A lens that can be used. Raises UnknownLens for a model of distortion that is none of `MODELS`, and for
    numbers that no lens has."""
    numbers = (*focal, *centre, *coefficients)
    if not all(abs(number) <= LARGEST for number in numbers) or min(focal) <= 0:
        raise UnknownLens(f"focal lengths must be above 0, and no number of the lens above {LARGEST:g}")
    # Other models bend pictures even where their coefficients are 0.
    if model not in MODELS and (model or any(coefficients)):
        known = " or ".join(f"`{name}`" for name in MODELS)
        raise UnknownLens(f"the model of distortion `{model}` is not known, only {known}: rectify first")
    if any(coefficients) and len(coefficients) not in MODELS[model]:
        asked = " or ".join(map(str, MODELS[model]))
        raise UnknownLens(f"`{model}` has {asked} coefficients, not {len(coefficients)}")
    return Lens((focal[0], focal[1]), (centre[0], centre[1]), tuple(coefficients))


def rectified(colour: Image, depth: Depth, seen_through: Lens) -> tuple[Image, Depth]:
    """Both pictures as a pinhole camera with square pixels of the size `focal[0]` would have taken them.

    The depth of a pixel is that of the nearest one, 0 where the lens saw nothing: a mean across an edge would
    lie in the air.
    """
    if seen_through.is_pinhole:
        return colour, depth
    height, width = depth.shape
    columns, rows = _sources(seen_through, width, height)
    straight = cv2.remap(colour, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    nearest = cv2.remap(depth, columns, rows, cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT)
    return straight.astype(np.uint8, copy=False), nearest.astype(np.float32, copy=False)


def pinhole_frame(
    colour: Image, depth: Depth | Floats, seen_through: Lens, pose: Floats | None, clock: float
) -> Frame:
    """A rectified frame; depth in metres is unknown where it is no distance up to `FARTHEST`; `pose` (4, 4)
    is the camera's in the scene, None where nobody knows."""
    height, width = depth.shape
    known = np.where((depth > 0) & (depth <= FARTHEST), depth, 0).astype(np.float32)
    camera = Camera(
        width,
        height,
        seen_through.focal[0],
        seen_through.centre,
        np.eye(4) if pose is None else pose,
        pose is not None,
    )
    return Frame(*rectified(colour, known, seen_through), camera, clock)


@lru_cache(maxsize=4)
def _sources(seen_through: Lens, width: int, height: int) -> tuple[Singles, Singles]:
    """Columns and rows (height, width) of the picture that each pixel of the rectified one is taken from."""
    pinhole = _matrix((seen_through.focal[0],) * 2, seen_through.centre)
    raw = _matrix(seen_through.focal, seen_through.centre)
    distortion = np.array(seen_through.coefficients, dtype=np.float64)
    columns, rows = cv2.initUndistortRectifyMap(
        raw, distortion, np.eye(3), pinhole, (width, height), cv2.CV_32FC1
    )
    return columns.astype(np.float32, copy=False), rows.astype(np.float32, copy=False)


def _matrix(focal: tuple[float, float], centre: tuple[float, float]) -> Floats:
    return np.array([[focal[0], 0.0, centre[0]], [0.0, focal[1], centre[1]], [0.0, 0.0, 1.0]])
