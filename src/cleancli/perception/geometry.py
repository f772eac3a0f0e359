"""Between pixels and the surface: a pinhole camera looking at a plane, both given in scene coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cleancli.perception.frame import Camera

Points = NDArray[np.float64]
Depth = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Plane:
    """The points p with normal · p = offset; `normal` (3,) has unit length and points up, `offset` in metres."""

    normal: NDArray[np.float64]
    offset: float


@dataclass(frozen=True, slots=True)
class PlaneView:
    """A plane as a camera sees it.

    `cosine` (height, width): normal · ray for the ray with depth 1 through each pixel, negative where the upper
    side is seen. `distance`: metres from the camera to the plane, along the normal.
    """

    cosine: Depth
    distance: float

    def height(self, depth: Depth) -> Depth:
        """Metres above the plane of what is seen at `depth` (height, width)."""
        return np.asarray(depth * self.cosine + np.float32(self.distance), np.float32)

    def depth(self) -> Depth:
        """Metres along the optical axis to the plane itself, (height, width)."""
        return np.asarray(np.float32(-self.distance) / self.cosine, np.float32)

    def pixel_areas(self, focal: float) -> Depth:
        """Square metres of the plane behind each pixel, (height, width)."""
        return np.asarray(self.depth() ** 3 / np.float32(self.distance * focal**2), np.float32)


def view(camera: Camera, plane: Plane) -> PlaneView:
    """How `camera` sees `plane`."""
    right, down, forward = plane.normal @ camera.pose[:3, :3]
    columns = (np.arange(camera.width, dtype=np.float32) - camera.centre[0]) / camera.focal
    rows = (np.arange(camera.height, dtype=np.float32) - camera.centre[1]) / camera.focal
    cosine = (right * columns[None, :] + down * rows[:, None] + forward).astype(np.float32)
    return PlaneView(cosine, float(plane.normal @ camera.pose[:3, 3] - plane.offset))


def rays(camera: Camera, pixels: Points) -> Points:
    """Directions in scene coordinates, of depth 1, through `pixels` (n, 2) given as (column, row); (n, 3)."""
    offsets = (pixels - np.array(camera.centre)) / camera.focal
    return np.asarray(np.column_stack([offsets, np.ones(len(pixels))]) @ camera.pose[:3, :3].T)


def on_plane(camera: Camera, plane: Plane, pixels: Points) -> Points:
    """Scene x, y in metres where the rays through `pixels` (n, 2) meet the plane; (n, 2)."""
    directions = rays(camera, pixels)
    eye = camera.pose[:3, 3]
    depth = (plane.offset - plane.normal @ eye) / (directions @ plane.normal)
    return np.asarray((eye + depth[:, None] * directions)[:, :2])


def project(camera: Camera, points: Points) -> Points:
    """Pixels (n, 2) as (column, row) of scene points (n, 3), or of surface points (n, 2) at z = 0."""
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    seen = (points - camera.pose[:3, 3]) @ camera.pose[:3, :3]
    return np.asarray(seen[:, :2] / seen[:, 2:] * camera.focal + np.array(camera.centre))
