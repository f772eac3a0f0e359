"""Surface segmentation and edges removal (§3.1): which pixels show the surface, and can be trusted to.

The frames have been checked: shapes fit the camera. The scene tells where on the plane the surface lies, so
that neither the floor nor the inside of the container is searched for dirt.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, degrees

import cv2
import numpy as np

from cleancli.array_types import Depth, Mask, Points
from cleancli.geometry.rgbd import Frame
from cleancli.perception import geometry
from cleancli.perception.geometry import Plane, PlaneView
from cleancli.scene import model as scene_model
from cleancli.scene.calibration import Thresholds

STRIDE = 6
"""Every sixth pixel of every sixth row is enough to find a plane."""

TRIPLES = 150
"""Planes tried; with half of the points on the surface, all miss it with a chance of 2e-9."""

JUDGES = 1000
"""Points, drawn at random, that tell which of the planes is best."""

PLANES = 4
"""Planes to look at, the largest first: the floor may be larger than the table."""

LEAST_PART = 0.05
"""Share of the points that a plane must hold to be looked at."""

LEAST_POINTS = 100
"""Points without which no plane is looked for."""

LEAST_SHARE = 0.3
"""The plane must hold this share of the points within the surface's extent that are as near to it as
`MISPLACED`: a floor seen beside a small table is no reason to doubt the table."""

MISPLACED = 0.3
"""Metres at the scene's origin by which the plane found may be off the place that the scene states."""

MOST_TILT = 45.0
"""Degrees by which it may slant against what the scene states."""

HOLE = 5
"""Width in pixels of a square that holes of unknown depth must not contain to be closed."""

_UP = np.array([0.0, 0.0, 1.0])


class NoSurface(Exception):
    """The frame does not show the surface; `reason` says what is seen instead."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(f"no surface found: {reason}")


class NoBackground(NoSurface):
    """Most of the surface has no even colour, so that nothing tells dirt from it."""


def find_plane(
    frame: Frame, extent: scene_model.Surface, thresholds: Thresholds, rng: np.random.Generator
) -> Plane:
    """The plane of the surface, in any pose up to `MOST_TILT` and `MISPLACED` from the one expected.

    Its origin is perpendicularly below the scene's, and its x runs as far along the scene's as it can: for a
    surface where it should be they agree. Raises NoSurface.
    """
    points = sampled_points(frame)
    inside = (np.abs(points[:, 0]) < extent.width / 2) & (np.abs(points[:, 1]) < extent.depth / 2)
    points = points[inside]
    reasons: list[str] = []
    least = max(LEAST_POINTS, int(LEAST_PART * len(points)))
    while len(points) >= least and len(reasons) < PLANES:
        normal, offset, close = largest_plane(points, frame.camera.pose[:3, 3], thresholds.tolerance, rng)
        reason = _unfit(points, normal, offset, close)
        if reason is None:
            return Plane.below(np.zeros(3), normal, offset, np.array([1.0, 0.0, 0.0]))
        reasons.append(reason)
        points = points[~close]
    # What is said of the largest plane counts: of smaller ones nobody expected anything.
    first = f"depth is known at {len(points)} of the pixels sampled where it should be"
    raise NoSurface(reasons[0] if reasons else first)


def _unfit(points: Points, normal: Points, offset: float, close: Mask) -> str | None:
    """Why a plane is not that of the surface, None if it can be."""
    share = close.sum() / max(int((np.abs(points @ normal - offset) < MISPLACED).sum()), 1)
    if share < LEAST_SHARE:
        return f"the largest plane holds {share:.0%} of what is seen there"
    tilt = degrees(acos(min(1.0, float(normal @ _UP))))
    if tilt > MOST_TILT:
        return f"the largest plane slants by {tilt:.0f} degrees against what the scene says"
    height = offset / normal[2]
    if abs(height) > MISPLACED:
        return f"the largest plane passes {100 * height:.0f} cm from where the surface should be"
    return None


def sampled_points(frame: Frame) -> Points:
    """Scene points (n, 3) of every sixth pixel whose depth is known."""
    depth = frame.depth[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE]
    rows, columns = np.nonzero(np.isfinite(depth) & (depth > 0))
    pixels = np.column_stack([columns, rows]).astype(np.float64) * STRIDE + STRIDE // 2
    directions = geometry.rays(frame.camera, pixels)
    return np.asarray(frame.camera.pose[:3, 3] + depth[rows, columns, None].astype(float) * directions)


def largest_plane(
    points: Points, eye: Points, tolerance: float, rng: np.random.Generator
) -> tuple[Points, float, Mask]:
    """RANSAC (Fischler and Bolles, 1981) and two least-squares fits: normal, offset, which of `points` (n, 3)
    are close. The normal points towards `eye`. No library at hand fits planes so."""
    reach = tolerance * ((points - eye) ** 2).sum(axis=1)
    first, second, third = points[rng.integers(0, len(points), (TRIPLES, 3))].transpose(1, 0, 2)
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(lengths, 1e-12)[:, None]
    offsets = np.einsum("ij,ij->i", normals, first)
    judges = rng.integers(0, len(points), min(JUDGES, len(points)))
    close = np.abs(points[judges] @ normals.T - offsets) < reach[judges, None]
    # Three points on a line, or the same one twice, are close to everything.
    support = np.where(lengths > 1e-6, close.sum(axis=0), 0)
    best = int(support.argmax())
    normal, offset = normals[best], offsets[best]
    for _ in range(2):
        held = np.abs(points @ normal - offset) < reach
        normal, offset = _fitted(points[held], eye)
    return normal, offset, np.abs(points @ normal - offset) < reach


def extent_mask(seen_as: PlaneView, extent: scene_model.Surface, inset: float = 0.0) -> Mask:
    """The pixels behind which the surface would lie if nothing stood on it, `inset` metres within its rim."""
    wide, deep = extent.width / 2 - inset, extent.depth / 2 - inset
    return np.asarray((np.abs(seen_as.x) < wide) & (np.abs(seen_as.y) < deep) & (seen_as.depth > 0))


@dataclass(frozen=True, slots=True)
class Heights:
    """What depth says of each pixel, (height, width): metres above the plane, those below which it `reach`es
    the plane within the error of depth, those from which on it is `higher` than that and than a heap of dirt,
    and whether it is known and believed."""

    above: Depth
    reach: Depth
    higher: Depth
    known: Mask


def heights(frame: Frame, seen_as: PlaneView, thresholds: Thresholds) -> Heights:
    """How high what each pixel shows lies.

    A value above the plane in no square of 2 x 2 pixels that are all above it is an error of the camera's,
    and as good as none; below it likewise.
    """
    above = seen_as.height_of(frame.depth)
    reach = np.float32(thresholds.tolerance) * seen_as.depth * seen_as.depth
    known = known_depth(frame)
    higher = np.maximum(reach, np.float32(thresholds.heap))
    square = np.ones((2, 2), np.uint8)
    for off in (known & (above >= higher), known & (above <= -higher)):
        thick = cv2.morphologyEx(off.view(np.uint8), cv2.MORPH_OPEN, square).view(np.bool_)
        known &= thick | ~off
    return Heights(above, reach, higher, known)


def surface_mask(height: Heights, extent: Mask) -> Mask:
    """The pixels whose depth lies on the plane, within the surface's extent; small holes are closed."""
    known = height.known
    on_plane = known & (height.above > -height.reach) & (height.above < height.higher) & extent
    # A dropout of a few pixels must not blind its whole neighbourhood when edges are removed.
    closed = cv2.morphologyEx(on_plane.view(np.uint8), cv2.MORPH_CLOSE, np.ones((HOLE, HOLE), np.uint8))
    return np.asarray(on_plane | (closed.view(np.bool_) & ~known & extent))


def object_mask(height: Heights, thresholds: Thresholds) -> Mask:
    """The pixels that show something standing on the surface, the tool or a hand, down to its foot.

    What is higher than a heap of dirt is an object; what is raised at all, and adjoins one, is its foot.
    """
    tall = height.known & (height.above >= height.higher)
    if not tall.any():
        return np.asarray(tall)
    raised = height.known & (height.above >= np.minimum(height.reach, np.float32(thresholds.heap)))
    _, labels = cv2.connectedComponents(raised.view(np.uint8), connectivity=8)
    objects = np.zeros(int(labels.max()) + 1, np.bool_)
    objects[labels[tall]] = True
    return np.asarray(objects[labels])


def without_edges(surface: Mask, objects: Mask, thresholds: Thresholds) -> Mask:
    """The surface without the pixels whose colour may be that of something else (§3.1, "Edges removal")."""
    return ~_widened(objects, thresholds.object_edge) & ~_widened(~surface, thresholds.surface_edge)


def known_depth(frame: Frame) -> Mask:
    """Where the camera measured a depth; cameras report 0, NaN or infinity where they did not."""
    return np.asarray(np.isfinite(frame.depth) & (frame.depth > 0))


def _widened(mask: Mask, pixels: int) -> Mask:
    """The mask and what is up to so many pixels beside it; the image's border is no edge."""
    size = 2 * pixels + 1
    return cv2.dilate(mask.view(np.uint8), np.ones((size, size), np.uint8)).view(np.bool_)


def _fitted(points: Points, eye: Points) -> tuple[Points, float]:
    """Normal and offset of the plane with the least squared distances to `points` (n, 3)."""
    middle = points.mean(axis=0)
    _, directions = np.linalg.eigh(np.cov((points - middle).T))
    normal = directions[:, 0] if directions[:, 0] @ (eye - middle) > 0 else -directions[:, 0]
    return normal, float(normal @ middle)
