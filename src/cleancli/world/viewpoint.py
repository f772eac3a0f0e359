"""Where a camera for people stands: as near as it can while all that it is to show stays in the picture."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin, tan

import numpy as np

from cleancli.array_types import Floats


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """A camera's place `eye`, metres; the unit vectors `back`, to it from what it looks at, and `up` in the
    picture; `field` is its vertical opening angle, radians. What it shows is `near` to `far` metres away."""

    eye: Floats
    back: Floats
    up: Floats
    field: float
    near: float
    far: float


def around(points: Floats, azimuth: float, elevation: float, field: float, aspect: float) -> Viewpoint:
    """The nearest camera in a direction from which all `points` (n, 3) are in a picture of this `aspect`,
    width by height. `azimuth` and `elevation`: where it stands, seen from the points, radians.

    Each side of the picture is a plane through the camera, and all points lie on one side of it. That bounds
    how near the camera may be for the left and the right plane together, and for the upper and the lower.
    """
    back = np.array((cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation)))
    right = np.array((-sin(azimuth), cos(azimuth), 0.0))
    up = np.cross(back, right)
    slopes = tan(field / 2) * aspect, tan(field / 2)
    depths = points @ -back
    ends = [
        (float((side - slope * depths).max()), float((-side - slope * depths).max()))
        for side, slope in zip((points @ right, points @ up), slopes, strict=True)
    ]
    away = max((high + low) / (2 * slope) for (high, low), slope in zip(ends, slopes, strict=True))
    (x_high, x_low), (y_high, y_low) = ends
    eye = (x_high - x_low) / 2 * right + (y_high - y_low) / 2 * up + away * back
    near, far = float(away + depths.min()), float(away + depths.max())
    return Viewpoint(eye, back, up, field, near, far)
