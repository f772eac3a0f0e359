"""What a frame looks like that was read or described wrongly: units, intrinsics, poses, pictures out of step.

Each question is asked of a few thousand pixels, once a look. Limits are chosen: far beyond what cameras and
tables do, and below what a mistake makes.
"""

from __future__ import annotations

from dataclasses import replace
from math import acos, degrees, hypot, log

import cv2
import numpy as np

from cleancli.array_types import Mask
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception.geometry import Plane, PlaneView
from cleancli.perception.surface import STRIDE, known_depth, sampled_points
from cleancli.scene.calibration import Thresholds
from cleancli.scene.model import Surface

UNITS = {
    1000.0: "millimetres where metres are wanted",
    10.0: "tenths of a millimetre",
    5.0: "1/5000 of a metre, as in the TUM layout",
    0.001: "metres",
}
"""By what factor depth is too large, read in another unit than this one."""
UNIT_FITS = log(1.6)
"""How far the logarithm of a factor may be from one of these."""
FARTHEST_CAMERA = 20.0
"""Metres from the scene's origin beyond which no camera looks at a table."""
OFF_CENTRE = 0.15
"""Share of the picture by which the principal point may be off its middle."""
VIEW = 25.0, 130.0
"""Degrees that the picture is wide."""
BLACK, WHITE = 5, 250
"""Brightness, of 255, of the median pixel below and above which the picture shows nothing."""
HIGHER, SLANTED = 0.03, 5.0
"""Metres and degrees by which the surface may lie otherwise than the scene says."""
LOWER = 0.05
"""Share of the surface's extent where something lower may be seen."""
BEYOND = 0.03
"""Metres beyond the surface's edges where it is asked whether the plane goes on."""
GOES_ON = 0.9
"""Share of what is seen there beyond each edge that must lie on the plane."""
LEAVES = 0.2
"""Share of one of the picture's borders that the surface must reach to leave the picture there."""
COARSE = 4
"""Every fourth pixel of every fourth row is enough to find a shift."""
MOST_SHIFT = 10
"""Of those pixels, to each side."""
LEAST_SHIFT = 2
DISTINCT = 1.5
"""Factor by which outlines of colour and depth must agree better if one is shifted."""


def unit_of(factor: float) -> str | None:
    """In which unit depth is given if it is too large by this factor; None if no unit explains it."""
    if factor <= 0 or abs(log(factor)) < UNIT_FITS:
        return None
    nearest = min(UNITS, key=lambda unit: abs(log(factor / unit)))
    return UNITS[nearest] if abs(log(factor / nearest)) < UNIT_FITS else None


def of_depth(frame: Frame) -> list[str]:
    """Doubts about the unit of depth, if the camera's pose is known and it looks at the scene."""
    known = frame.depth[known_depth(frame)]
    pose = frame.camera.pose
    if not (frame.camera.located and len(known) and pose[2, 3] > 0 and pose[2, 2] < -0.1):
        return []
    median, expected = float(np.median(known)), float(-pose[2, 3] / pose[2, 2])
    unit = unit_of(median / expected)
    told = f"the depth's median is {median:.3g} m, where {expected:.3g} m are expected"
    return [] if unit is None else [f"{told}: is its unit {unit}?"]


def of_frame(frame: Frame) -> list[str]:
    """Doubts about the camera's description, and about colour, that need no plane."""
    camera, found = frame.camera, []
    column, row = camera.centre[0] / camera.width, camera.centre[1] / camera.height
    size = f"a picture of {camera.width} x {camera.height} pixels"
    wide = 2 * degrees(np.arctan(camera.width / 2 / camera.focal))
    if max(abs(column - 0.5), abs(row - 0.5)) > OFF_CENTRE:
        at = f"({camera.centre[0]:.0f}, {camera.centre[1]:.0f})"
        found.append(
            f"the principal point is at {at} in {size}: are focal and centre those of another resolution?"
        )
    elif not VIEW[0] <= wide <= VIEW[1]:
        found.append(
            f"with a focal length of {camera.focal:.0f} pixels, {size} shows {wide:.0f} degrees: "
            "is focal that of another resolution?"
        )
    eye = float(np.linalg.norm(camera.pose[:3, 3]))
    if camera.located and eye > FARTHEST_CAMERA:
        found.append(f"the camera stands {eye:.0f} m from the scene's origin: is its pose in millimetres?")
    return found


def of_colour(frame: Frame, seen: Mask) -> list[str]:
    """Doubts about the colour of what depth shows well; `seen` (height, width) is the surface."""
    step = slice(STRIDE // 2, None, STRIDE)
    shown = frame.colour[step, step][seen[step, step]]
    if not len(shown):
        return []
    median = float(np.median(shown))
    if median >= WHITE:
        return ["the surface is white all over, though its depth is known: is the picture overexposed?"]
    if median <= BLACK:
        return ["the surface is black all over, though its depth is known: is the lens covered, or no light?"]
    return []


def of_plane(plane: Plane, camera: Camera) -> list[str]:
    """Doubts about where the surface was found, if the camera's pose is known."""
    if not camera.located:
        return []
    height = plane.offset / plane.normal[2]
    tilt = degrees(acos(min(1.0, float(plane.normal[2]))))
    if abs(height) <= HIGHER and tilt <= SLANTED:
        return []
    way = "above" if height > 0 else "below"
    return [
        f"the surface lies {abs(100 * height):.0f} cm {way} where the scene says, and slants {tilt:.0f} "
        "degrees against it: is the camera's pose right?"
    ]


def of_extent(frame: Frame, seen_as: PlaneView, surface: Surface, thresholds: Thresholds) -> list[str]:
    """Doubts about whether the surface ends where it should, if the camera's pose is known."""
    if not frame.camera.located:
        return []
    step = slice(STRIDE // 2, None, STRIDE)
    x, y, away = (each[step, step] for each in (seen_as.x, seen_as.y, seen_as.depth))
    depth = frame.depth[step, step]
    height = depth * seen_as.cosine[step, step] + seen_as.distance
    known = np.isfinite(depth) & (depth > 0) & (away > 0)
    reach = np.maximum(thresholds.tolerance * away * away, thresholds.heap)
    out_x, out_y = np.abs(x) - surface.width / 2, np.abs(y) - surface.depth / 2
    inside = known & (out_x < 0) & (out_y < 0)
    lower = float((height[inside] < -reach[inside]).mean()) if inside.any() else 0.0
    if lower > LOWER:
        return [
            f"{lower:.0%} of where the surface should be lies lower than it: is the camera's pose right, its "
            "focal length, and the scene's width and depth?"
        ]
    beside_x = known & (out_x > BEYOND / 3) & (out_x < BEYOND) & (out_y < 0)
    beside_y = known & (out_y > BEYOND / 3) & (out_y < BEYOND) & (out_x < 0)
    sides = [beside_x & (x < 0), beside_x & (x > 0), beside_y & (y < 0), beside_y & (y > 0)]
    on_plane = np.abs(height) < reach
    if all(side.any() and on_plane[side].mean() > GOES_ON for side in sides):
        return [
            "the plane goes on beyond all edges of the surface: if it is no part of something larger, is the "
            "camera's focal length right, and the scene's width and depth?"
        ]
    return []


def of_shift(frame: Frame, on_surface: Mask) -> list[str]:
    """Doubts whether colour and depth show the same place: outlines that agree better if one is shifted."""
    small = np.ascontiguousarray(on_surface[::COARSE, ::COARSE]).view(np.uint8)
    depth = frame.depth[::COARSE, ::COARSE]
    known = (np.isfinite(depth) & (depth > 0)).view(np.uint8)
    whole = cv2.morphologyEx(small, cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8))
    outline = cv2.morphologyEx(whole, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    outline = cv2.bitwise_and(outline, known).astype(np.float32)
    if outline.sum() < 50:
        return []
    colour = cv2.blur(frame.colour[::2, ::2], (2, 2))[::2, ::2]
    grey = cv2.cvtColor(np.ascontiguousarray(colour), cv2.COLOR_RGB2GRAY)
    steep = cv2.morphologyEx(grey, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)).astype(np.float32)
    # The strongest edges alone say where things end; a bright lamp must not outweigh them all.
    steep = np.minimum(steep, np.float32(np.quantile(steep[::2, ::2], 0.97)))
    around = np.pad(steep, MOST_SHIFT, constant_values=steep.mean())
    scores = cv2.matchTemplate(around, outline, cv2.TM_CCORR)
    _, best, _, (column, row) = cv2.minMaxLoc(scores)
    across, down = column - MOST_SHIFT, row - MOST_SHIFT
    if hypot(across, down) < LEAST_SHIFT or best <= DISTINCT * float(scores[MOST_SHIFT, MOST_SHIFT]):
        return []
    ways = [(across, "right", "left"), (down, "down", "up")]
    told = " and ".join(
        f"{COARSE * abs(by)} pixels {right if by > 0 else left}" for by, right, left in ways if by
    )
    return [f"colour is shifted against depth by about {told}: are the two registered, of the same moment?"]


def of_border(frame: Frame, on_surface: Mask) -> list[str]:
    """Where places are measured from, if nobody knows where the camera stands and the surface goes on
    outside the picture."""
    if frame.camera.located:
        return []
    borders = on_surface[0], on_surface[-1], on_surface[:, 0], on_surface[:, -1]
    if all(border.mean() < LEAVES for border in borders):
        return []
    return [
        "the surface leaves the picture, and the camera's pose is not known: places are measured from where "
        "the camera's axis meets it, x to the right of the picture"
    ]


def where_points_fall(frame: Frame) -> str:
    """Where in the scene's coordinates most of what the camera sees lies."""
    points = sampled_points(frame)
    if not len(points):
        return "no depth is known"
    low, high = np.quantile(points, (0.05, 0.95), axis=0)
    spans = ", ".join(f"{axis} {a:.3g} to {b:.3g}" for axis, a, b in zip("xyz", low, high, strict=True))
    of = "the scene's" if frame.camera.located else "the camera's"
    return f"nine tenths of the points lie at {spans} m in {of} coordinates"


def inverted(frame: Frame) -> Frame:
    """The frame with its camera's pose the other way round."""
    pose = np.asarray(np.linalg.inv(frame.camera.pose), np.float64)
    return replace(frame, camera=replace(frame.camera, pose=pose))
