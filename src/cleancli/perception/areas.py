"""Ellipse representation (§3.1): dirty pixels become areas on the surface, in metres."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, ceil, pi

import cv2
import numpy as np

from cleancli.array_types import Longs, Mask, Points
from cleancli.geometry.ellipse import Ellipse
from cleancli.geometry.rgbd import Camera
from cleancli.perception import geometry
from cleancli.perception.area import Area
from cleancli.perception.geometry import Plane, PlaneView

ROUNDS = 40
"""Rounds of Titterington's iteration; the ellipse is then within 2 % of the smallest one's axes."""

CELL = 0.001
"""Metres: width of the cells of the surface between which gaps are measured."""

_CORNERS = np.array([[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]])
"""How far dirt reaches in a pixel at its border, from the middle: such a pixel is covered by half or whole,
and the border is a quarter of a pixel beyond its middle on average."""


def group(patches: Mask, camera: Camera, plane: Plane, seen_as: PlaneView, link: float) -> tuple[Area, ...]:
    """The dirty areas, unnamed, from west to east; patches with a gap below `link` metres are one area."""
    rows, columns = np.nonzero(patches)
    if not len(rows):
        return ()
    pixel_areas = seen_as.pixel_areas[rows, columns].astype(np.float64)
    middles = np.column_stack([seen_as.x[rows, columns], seen_as.y[rows, columns]]).astype(np.float64)
    owners = linked(middles, pixel_areas, link)
    covered = np.bincount(owners, pixel_areas)
    pixels = np.column_stack([columns, rows]).astype(np.float64)
    hulls = [_hull(pixels[owners == owner]) for owner in range(len(covered))]
    outlines = geometry.on_plane(camera, plane, np.vstack(hulls))
    ellipses = enclosing_ellipses(np.split(outlines, np.cumsum([len(hull) for hull in hulls])[:-1]))
    areas = [Area(ellipse, float(share)) for ellipse, share in zip(ellipses, covered, strict=True)]
    return tuple(sorted(areas, key=lambda area: area.ellipse.centre))


def linked(middles: Points, sizes: Points, link: float) -> Longs:
    """The number, from 0, of the group of each piece of the surface: gaps below `link` do not divide one.

    `middles` (n, 2) in metres, `sizes` (n) square metres of the pieces.
    """
    low = middles.min(axis=0) - link
    cells = np.floor((middles - low) / CELL).astype(int)
    columns, rows = cells.max(axis=0) + ceil(link / CELL) + 1
    empty = np.ones((rows, columns), np.uint8)
    empty[cells[:, 1], cells[:, 0]] = 0
    to_dirt = cv2.distanceTransform(empty, cv2.DIST_L2, cv2.DIST_MASK_5) * CELL
    # Half a link around every piece: those that touch are linked. Distances between middles are longer than
    # the gaps by a quarter of a piece's width at both ends, as in `_CORNERS`.
    reach = (link + np.sqrt(sizes.mean()) / 2) / 2
    _, labels = cv2.connectedComponents((to_dirt <= reach).view(np.uint8), connectivity=8)
    _, owners = np.unique(labels[cells[:, 1], cells[:, 0]], return_inverse=True)
    return np.asarray(owners, np.int64)


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


def _hull(pixels: Points) -> Points:
    """The convex hull of the dirt in these pixels."""
    corners = (pixels[:, None, :] + _CORNERS).reshape(-1, 2)
    return np.asarray(cv2.convexHull(corners.astype(np.float32))[:, 0, :], np.float64)


def _moments(points: Points, weights: Points) -> tuple[Points, Points]:
    """Weighted means (k, 2) and covariances (k, 2, 2) of points (k, n, 2) with weights (k, n)."""
    centres = (weights[:, None, :] @ points)[:, 0, :]
    offsets = points - centres[:, None, :]
    return centres, offsets.transpose(0, 2, 1) @ (weights[:, :, None] * offsets)


def _squared_distances(points: Points, centres: Points, covariances: Points) -> Points:
    """Squared Mahalanobis distances (k, n)."""
    offsets = points - centres[:, None, :]
    return np.asarray(((offsets @ np.linalg.inv(covariances)) * offsets).sum(axis=2))
