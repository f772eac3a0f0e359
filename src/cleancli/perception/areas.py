"""Ellipse representation (§3.1): dirty pixels become areas on the surface, in metres."""

from __future__ import annotations

from math import atan2, pi

import cv2
import numpy as np

from cleancli.perception import geometry
from cleancli.perception.area import Area, Ellipse
from cleancli.perception.frame import Camera
from cleancli.perception.geometry import Plane, PlaneView, Points
from cleancli.perception.surface import Mask

LEAST_PATCH = 14e-6
"""Square metres below which a patch is no dirt: half of a lentil 6 mm across."""

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
    reach = (link * camera.focal / seen_as.depth() + 1) / 2
    _, labels = cv2.connectedComponents((to_dirt <= reach).view(np.uint8), connectivity=8)
    rows, columns = np.nonzero(patches)
    owners = labels[rows, columns]
    pixels = np.column_stack([columns, rows]).astype(np.float64)
    covered = np.bincount(owners, pixel_areas[rows, columns])
    areas = [
        Area(enclosing_ellipse(_outline(pixels[owners == owner], camera, plane)), float(covered[owner]))
        for owner in np.unique(owners)
    ]
    return tuple(sorted(areas, key=lambda area: area.ellipse.centre))


def enclosing_ellipse(points: Points) -> Ellipse:
    """The smallest ellipse that contains `points` (n, 2), which must not all lie on one line.

    Titterington's iteration (Applied Statistics 24, 1975) moves weight to the points farthest out by the
    weighted covariance; a last scaling makes sure that every point is inside.
    """
    weights = np.full(len(points), 1 / len(points))
    for _ in range(ROUNDS):
        squares = _squared_distances(points, *_moments(points, weights))
        # In the plane the weighted mean of the squares is 2, and at the optimum none is larger.
        weights = weights * (1 + squares) / 3
    centre, covariance = _moments(points, weights)
    squares = _squared_distances(points, centre, covariance)
    variances, directions = np.linalg.eigh(covariance * squares.max())
    short, long = np.sqrt(variances)
    angle = atan2(directions[1, 1], directions[0, 1])
    angle = angle - pi if angle > pi / 2 else angle + pi if angle <= -pi / 2 else angle
    return Ellipse((float(centre[0]), float(centre[1])), (float(long), float(short)), angle)


def _without_small_patches(dirt: Mask, pixel_areas: geometry.Depth) -> Mask:
    _, labels = cv2.connectedComponents(dirt.view(np.uint8), connectivity=8)
    sizes = np.bincount(labels[dirt], pixel_areas[dirt], minlength=1)
    large = sizes >= LEAST_PATCH
    large[0] = False
    return np.asarray(large[labels])


def _outline(pixels: Points, camera: Camera, plane: Plane) -> Points:
    """The convex hull, on the surface, of whole pixels: of their corners, not of their middles."""
    corners = (pixels[:, None, :] + _CORNERS).reshape(-1, 2)
    hull = cv2.convexHull(corners.astype(np.float32))[:, 0, :]
    return geometry.on_plane(camera, plane, hull.astype(np.float64))


def _moments(points: Points, weights: Points) -> tuple[Points, Points]:
    centre = weights @ points
    offsets = points - centre
    return centre, (weights[:, None] * offsets).T @ offsets


def _squared_distances(points: Points, centre: Points, covariance: Points) -> Points:
    offsets = points - centre
    return np.asarray(((offsets @ np.linalg.inv(covariance)) * offsets).sum(axis=1))
