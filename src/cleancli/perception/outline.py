"""Estimates the surface's pose from its outline, where nobody knows where the camera stands.

The frames have been checked. The camera's own coordinates stand for the scene's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, radians, sin, sqrt

import cv2
import numpy as np

from cleancli.array_types import Mask, Points
from cleancli.geometry.rgbd import Frame
from cleancli.perception import geometry
from cleancli.perception.geometry import Plane
from cleancli.perception.misread import LEAVES, unit_of
from cleancli.perception.surface import (
    LEAST_PART,
    LEAST_POINTS,
    PLANES,
    NoSurface,
    known_depth,
    largest_plane,
    sampled_points,
)
from cleancli.scene.calibration import Thresholds
from cleancli.scene.model import Surface

FILLS = 0.8
"""Share of the image that a plane must hold to fill the view: a floor with a table on it holds less."""

FITS = 0.12
"""Share by which the sides of a plane's outline may differ from the surface's."""


@dataclass(frozen=True, slots=True)
class _Outline:
    """A rectangle on a plane around what is seen of it: middle, sides and angle of the first from `east`."""

    plane: Plane
    middle: tuple[float, float]
    sides: tuple[float, float]
    angle: float
    fills_view: bool
    leaves_view: bool


def find_by_outline(
    frame: Frame, surface: Surface, thresholds: Thresholds, rng: np.random.Generator
) -> Plane:
    """The plane whose outline has the size of `surface`, with its origin in the outline's middle.

    x runs along the side of the surface's width, as far to the right of the image as that can be. Where no
    outline fits, but one plane goes beyond the image on all sides, or leaves it and is seen no larger than
    the surface is, that is the surface: its origin is then where the camera's axis meets it, and x runs to
    the right of the image. Raises NoSurface.
    """
    outlines = list(_outlines(frame, thresholds, rng))
    if not outlines:
        # Tables are about a metre away.
        known = frame.depth[known_depth(frame)]
        unit = unit_of(float(np.median(known))) if len(known) else None
        mend = f"; is the unit of depth {unit}?" if unit else ""
        raise NoSurface(f"there is no plane in what is seen{mend}")
    best = min(outlines, key=lambda outline: _misfit(outline, surface))
    if _misfit(best, surface) <= FITS:
        return _placed(best, surface)
    part = next((o for o in outlines if o.fills_view or _may_be_part(o, surface)), None)
    if part is None:
        raise NoSurface(_unlike(outlines, surface))
    return part.plane


def whole_outline(
    frame: Frame, surface: Surface, thresholds: Thresholds, rng: np.random.Generator
) -> Plane | None:
    """As `find_by_outline`, where an outline of the surface's size is in the picture whole; else None."""
    whole = [outline for outline in _outlines(frame, thresholds, rng) if not outline.leaves_view]
    best = min(whole, key=lambda outline: _misfit(outline, surface), default=None)
    return _placed(best, surface) if best is not None and _misfit(best, surface) <= FITS else None


def _may_be_part(outline: _Outline, surface: Surface) -> bool:
    """Whether it goes on outside the image, and what is seen of it is no larger than the surface."""
    most, least = max(surface.width, surface.depth), min(surface.width, surface.depth)
    fits = max(outline.sides) <= most * (1 + FITS) and min(outline.sides) <= least * (1 + FITS)
    return outline.leaves_view and fits


def _unlike(outlines: Sequence[_Outline], surface: Surface) -> str:
    """What planes there are instead, and what would help."""
    seen = ", ".join(f"{100 * a:.0f} x {100 * b:.0f} cm" for a, b in (o.sides for o in outlines))
    wanted = f"{100 * surface.width:.0f} x {100 * surface.depth:.0f} cm"
    told = f"no plane has an outline of about {wanted}, but {seen}"
    ratios = [sqrt(o.sides[0] * o.sides[1] / (surface.width * surface.depth)) for o in outlines]
    units = (unit_of(ratio) for ratio in ratios)
    unit = next((unit for unit in units if unit is not None), None)
    mend = f"is the unit of depth {unit}?" if unit else "give the camera's `pose`, or show all of the surface"
    return f"{told}; {mend}"


def _outlines(frame: Frame, thresholds: Thresholds, rng: np.random.Generator) -> list[_Outline]:
    points, eye = sampled_points(frame), frame.camera.pose[:3, 3]
    least = max(LEAST_POINTS, LEAST_PART * len(points))
    found: list[_Outline] = []
    while len(points) >= least and len(found) < PLANES:
        normal, offset, close = largest_plane(points, eye, thresholds.tolerance, rng)
        if close.sum() < least:
            break
        found.append(_outline(frame, normal, offset, thresholds))
        points = points[~close]
    return found


def _outline(frame: Frame, normal: Points, offset: float, thresholds: Thresholds) -> _Outline:
    camera = frame.camera
    ahead, right = camera.pose[:3, 2], camera.pose[:3, 0]
    eye = camera.pose[:3, 3]
    axis = float(normal @ ahead)
    met = eye + (offset - normal @ eye) / axis * ahead if abs(axis) > 1e-3 else eye
    plane = Plane.below(met, normal, offset, right)
    largest = _largest_part(frame, plane, thresholds)
    hull = cv2.convexHull(np.argwhere(largest)[:, ::-1].astype(np.int32))[:, 0, :].astype(np.float64)
    corners = geometry.on_plane(camera, plane, hull)
    (x, y), sides, angle = cv2.minAreaRect(corners.astype(np.float32))
    borders = (largest[0], largest[-1], largest[:, 0], largest[:, -1])
    fills = bool(largest.mean() > FILLS) and all(border.mean() > 0.5 for border in borders)
    leaves = any(border.mean() > LEAVES for border in borders)
    long, wide = float(sides[0]), float(sides[1])
    return _Outline(plane, (float(x), float(y)), (long, wide), radians(angle), fills, leaves)


def _largest_part(frame: Frame, plane: Plane, thresholds: Thresholds) -> Mask:
    """The largest connected part of the pixels that lie on the plane."""
    seen_as = geometry.view(frame.camera, plane)
    reach = np.float32(thresholds.tolerance) * seen_as.depth * seen_as.depth
    close = known_depth(frame) & (np.abs(seen_as.height_of(frame.depth)) < reach)
    # Depth at an outline jitters; single pixels there must neither add to it nor connect it.
    opened = cv2.morphologyEx(close.view(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(opened, connectivity=4)
    if len(statistics) == 1:
        return close
    return np.asarray(labels == 1 + int(statistics[1:, cv2.CC_STAT_AREA].argmax()))


def _misfit(outline: _Outline, surface: Surface) -> float:
    """By what share the worse of its two sides differs, laid whichever way fits better."""
    return min(_misfits(outline, surface))


def _misfits(outline: _Outline, surface: Surface) -> tuple[float, float]:
    first, second = outline.sides
    return (
        max(abs(first / surface.width - 1), abs(second / surface.depth - 1)),
        max(abs(second / surface.width - 1), abs(first / surface.depth - 1)),
    )


def _placed(outline: _Outline, surface: Surface) -> Plane:
    along_first, along_second = _misfits(outline, surface)
    plane = outline.plane
    turns = [outline.angle + quarter * np.pi / 2 for quarter in range(4)]
    # A square fits both ways; then the one nearer to the image's rows counts.
    if abs(along_first - along_second) > FITS / 2:
        turns = turns[0::2] if along_first < along_second else turns[1::2]
    angle = max(turns, key=cos)
    middle = plane.origin + outline.middle[0] * plane.east + outline.middle[1] * plane.north
    east = cos(angle) * plane.east + sin(angle) * plane.north
    return Plane.below(middle, plane.normal, plane.offset, east)
