"""Ellipse representation (§3.1): dirty pixels become areas on the surface, in metres."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, pi

import cv2
import numpy as np

from cleancli.perception import geometry
from cleancli.perception.area import Area, Ellipse
from cleancli.perception.frame import Camera
from cleancli.perception.geometry import Plane, PlaneView, Points
from cleancli.perception.surface import Mask

LEAST_PATCH = 5.5e-6
"""Square metres below which a patch is no dirt: half of a grain of rice."""

ROUNDS = 40
"""Rounds of Titterington's iteration; the ellipse is then within 2 % of the smallest one's axes."""

_CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


def group(dirt: Mask, camera: Camera, plane: Plane, seen_as: PlaneView, link: float) -> tuple[Area, ...]:
    """The dirty areas, unnamed, from west to east; dirt with a gap below `link` metres is one area."""
    pixel_areas = seen_as.pixel_areas(camera.focal)
    patches = _without_small_patches(dirt, pixel_areas)
    if not patches.any():
        return ()
    to_dirt = cv2.distanceTransform((~patches).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    # Half a link around every patch: those that touch are linked. Distances between pixel middles are a pixel
    # longer than the gap between the pixels.
    reach = (link * camera.focal / seen_as.depth + 1) / 2
    _, labels = cv2.connectedComponents((to_dirt <= reach).view(np.uint8), connectivity=8)
    rows, columns = np.nonzero(patches)
    owners = labels[rows, columns]
    pixels = np.column_stack([columns, rows]).astype(np.float64)
    covered = np.bincount(owners, pixel_areas[rows, columns])
    present = np.unique(owners)
    ellipses = enclosing_ellipses([_outline(pixels[owners == owner], camera, plane) for owner in present])
    areas = [Area(ellipse, float(covered[owner])) for ellipse, owner in zip(ellipses, present, strict=True)]
    return tuple(sorted(areas, key=lambda area: area.ellipse.centre))


def enclosing_ellipses(outlines: Sequence[Points]) -> list[Ellipse]:
    """For each set of points (n, 2) the smallest ellipse that contains them; no set may lie on one line.

    Titterington's iteration (Applied Statistics 24, 1975) moves weight to the points farthest out by the
    weighted covariance; a last scaling makes sure that every point is inside. All sets advance together.
    """
    most = max(map(len, outlines))
    # Shorter sets repeat a point with no weight, which never gains any.
    points = np.stack([np.vstack([o, np.repeat(o[:1], most - len(o), axis=0)]) for o in outlines])
    weights = np.stack([np.repeat([1 / len(o), 0.0], [len(o), most - len(o)]) for o in outlines])
    for _ in range(ROUNDS):
        # In the plane the weighted mean of the squares is 2, and at the optimum none is larger.
        weights = weights * (1 + _squared_distances(points, *_moments(points, weights))) / 3
    centres, covariances = _moments(points, weights)
    scales = _squared_distances(points, centres, covariances).max(axis=1)
    variances, directions = np.linalg.eigh(covariances * scales[:, None, None])
    axes = np.sqrt(variances)
    return [
        Ellipse((centre[0], centre[1]), (long, short), _half_turn(atan2(direction[1], direction[0])))
        for centre, (short, long), direction in zip(
            centres.tolist(), axes.tolist(), directions[:, :, 1].tolist(), strict=True
        )
    ]


def _half_turn(angle: float) -> float:
    """The same undirected angle in (-pi/2, pi/2]."""
    return angle - pi if angle > pi / 2 else angle + pi if angle <= -pi / 2 else angle


def _without_small_patches(dirt: Mask, pixel_areas: geometry.Depth) -> Mask:
    _, labels = cv2.connectedComponents(dirt.view(np.uint8), connectivity=8)
    sizes = np.bincount(labels[dirt], pixel_areas[dirt], minlength=1)
    large = sizes >= LEAST_PATCH
    large[0] = False
    return np.asarray(large.take(np.asarray(labels, np.int32)))


def _outline(pixels: Points, camera: Camera, plane: Plane) -> Points:
    """The convex hull, on the surface, of whole pixels: of their corners, not of their middles."""
    corners = (pixels[:, None, :] + _CORNERS).reshape(-1, 2)
    hull = cv2.convexHull(corners.astype(np.float32))[:, 0, :]
    return geometry.on_plane(camera, plane, hull.astype(np.float64))


def _moments(points: Points, weights: Points) -> tuple[Points, Points]:
    """Weighted means (k, 2) and covariances (k, 2, 2) of points (k, n, 2) with weights (k, n)."""
    centres = (weights[:, None, :] @ points)[:, 0, :]
    offsets = points - centres[:, None, :]
    return centres, offsets.transpose(0, 2, 1) @ (weights[:, :, None] * offsets)


def _squared_distances(points: Points, centres: Points, covariances: Points) -> Points:
    """Squared Mahalanobis distances (k, n)."""
    offsets = points - centres[:, None, :]
    return np.asarray(((offsets @ np.linalg.inv(covariances)) * offsets).sum(axis=2))
