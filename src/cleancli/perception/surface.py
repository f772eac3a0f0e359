"""Surface segmentation and edges removal (§3.1): which pixels show the surface, and can be trusted to.

The frames have been checked: shapes fit the camera. Calibration tells where on the plane the surface lies, so
that neither the floor nor the inside of the container is searched for dirt.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from cleancli.perception import geometry
from cleancli.perception.frame import Frame
from cleancli.perception.geometry import Plane, PlaneView, Points
from cleancli.scene import model as scene_model

Mask = NDArray[np.bool_]

STRIDE = 6
"""Every sixth pixel of every sixth row is enough to find a plane."""

TRIPLES = 60
"""Planes tried; with 60 % of the points on the surface, all miss it with a chance of 1e-6."""

TOLERANCE = 0.008
"""Metres from the plane up to which a point belongs to it: over six times the depth noise at 0.9 m."""

HEAP = 0.015
"""Metres above the plane up to which a point still belongs to it: dirt lies in heaps."""

LEAST_SHARE = 0.3
"""The plane must hold this share of the points within the surface's extent."""

MISPLACED = 0.05
"""Metres at the scene's origin by which the plane found may be off the calibrated surface."""

HOLE = 5
"""Width in pixels of a square that holes of unknown depth must not contain to be closed."""

EDGE_OF_OBJECTS = 9
"""Pixels (width of a square) around what stands on the surface whose colour may be the object's."""

EDGE_OF_SURFACE = 5
"""The same around whatever else is no surface: the floor beyond the rim, unknown depth."""


class NoSurface(Exception):
    """The frame does not show the surface; `reason` says what is seen instead."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(f"no surface found: {reason}")


def find_plane(frame: Frame, extent: scene_model.Surface, rng: np.random.Generator) -> Plane:
    """The plane of the surface by RANSAC and a least-squares refit. Raises NoSurface."""
    points = _samples(frame, extent)
    if len(points) < 100:
        raise NoSurface(f"depth is known at {len(points)} of the pixels sampled where it should be")
    first, second, third = points[rng.integers(0, len(points), (TRIPLES, 3))].transpose(1, 0, 2)
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.maximum(lengths, 1e-12)
    offsets = np.einsum("ij,ij->i", normals, first)
    close = np.abs(points @ normals.T - offsets) < TOLERANCE
    # Three points on a line, or the same one twice, are close to everything.
    support = np.where(lengths[:, 0] > 1e-6, close.sum(axis=0), 0)
    best = int(support.argmax())
    if support[best] < LEAST_SHARE * len(points):
        raise NoSurface(f"the largest plane holds {support[best] / len(points):.0%} of what is seen there")
    plane = _fitted(points[close[:, best]])
    height = plane.offset / plane.normal[2] if plane.normal[2] > 0.1 else np.inf
    if abs(height) > MISPLACED:
        raise NoSurface(f"the largest plane passes {100 * height:.0f} cm from where the surface should be")
    return plane


def extent_mask(seen_as: PlaneView, extent: scene_model.Surface, inset: float = 0.0) -> Mask:
    """The pixels behind which the surface would lie if nothing stood on it, `inset` metres within its rim."""
    wide, deep = extent.width / 2 - inset, extent.depth / 2 - inset
    return np.asarray((np.abs(seen_as.x) < wide) & (np.abs(seen_as.y) < deep))


def surface_mask(frame: Frame, seen_as: PlaneView, extent: Mask) -> Mask:
    """The pixels whose depth lies on the plane, within the surface's extent; small holes are closed."""
    known = known_depth(frame)
    height = seen_as.height_of(frame.depth)
    on_plane = known & (height > -TOLERANCE) & (height < HEAP) & extent
    # A dropout of a few pixels must not blind its whole neighbourhood when edges are removed.
    closed = cv2.morphologyEx(on_plane.view(np.uint8), cv2.MORPH_CLOSE, np.ones((HOLE, HOLE), np.uint8))
    return on_plane | (closed.view(np.bool_) & ~known & extent)


def object_mask(frame: Frame, seen_as: PlaneView) -> Mask:
    """The pixels that show something standing above the surface: the tool, a hand."""
    return known_depth(frame) & (seen_as.height_of(frame.depth) >= HEAP)


def without_edges(surface: Mask, objects: Mask) -> Mask:
    """The surface without the pixels whose colour may be that of something else (§3.1, "Edges removal")."""
    return ~_widened(objects, EDGE_OF_OBJECTS) & ~_widened(~surface, EDGE_OF_SURFACE)


def _widened(mask: Mask, width: int) -> Mask:
    """The mask and half of `width` pixels around it; the image's border is no edge."""
    return cv2.dilate(mask.view(np.uint8), np.ones((width, width), np.uint8)).view(np.bool_)


def known_depth(frame: Frame) -> Mask:
    """Where the camera measured a depth; cameras report 0, NaN or infinity where they did not."""
    return np.asarray(np.isfinite(frame.depth) & (frame.depth > 0))


def _samples(frame: Frame, extent: scene_model.Surface) -> Points:
    """Scene points (n, 3) of every sixth pixel, as far as they lie above or below the surface's extent."""
    sampled = np.zeros(frame.depth.shape, np.bool_)
    sampled[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE] = True
    rows, columns = np.nonzero(sampled & known_depth(frame))
    pixels = np.column_stack([columns, rows]).astype(np.float64)
    depth = frame.depth[rows, columns].astype(np.float64)
    points = frame.camera.pose[:3, 3] + depth[:, None] * geometry.rays(frame.camera, pixels)
    inside = (np.abs(points[:, 0]) < extent.width / 2) & (np.abs(points[:, 1]) < extent.depth / 2)
    return np.asarray(points[inside])


def _fitted(points: Points) -> Plane:
    """The plane with the least squared distances to `points` (n, 3), its normal upwards."""
    middle = points.mean(axis=0)
    _, directions = np.linalg.eigh(np.cov((points - middle).T))
    normal = directions[:, 0] if directions[2, 0] > 0 else -directions[:, 0]
    return Plane(normal, float(normal @ middle))
