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
    """The points p with normal · p = offset, in metres; `normal` (3,) has length 1 and points up."""

    normal: NDArray[np.float64]
    offset: float


@dataclass(frozen=True, slots=True)
class PlaneView:
    """A plane as a camera sees it.

    Arrays are (height, width). `cosine`: normal · ray for the ray with depth 1 through each pixel, negative
    where the upper side is seen. `distance`: metres from the camera to the plane, along the normal. `depth`:
    metres along the optical axis to the plane itself. `x`, `y`: scene coordinates of the plane behind each
    pixel.
    """

    cosine: Depth
    distance: float
    depth: Depth
    x: Depth
    y: Depth

    def height_of(self, depth: Depth) -> Depth:
        """Metres above the plane of what is seen at `depth`."""
        return np.asarray(depth * self.cosine + np.float32(self.distance), np.float32)

    def pixel_areas(self, focal: float) -> Depth:
        """Square metres of the plane behind each pixel."""
        return np.asarray(self.depth**3 / np.float32(self.distance * focal**2), np.float32)


def view(camera: Camera, plane: Plane) -> PlaneView:
    """How `camera` sees `plane`."""
    columns = ((np.arange(camera.width) - camera.centre[0]) / camera.focal).astype(np.float32)[None, :]
    rows = ((np.arange(camera.height) - camera.centre[1]) / camera.focal).astype(np.float32)[:, None]

    def along(direction: NDArray[np.float64]) -> Depth:
        """The component of each pixel's ray along a scene direction."""
        right, down, forward = (direction @ camera.pose[:3, :3]).astype(np.float32)
        return np.asarray(right * columns + (down * rows + forward))

    eye = camera.pose[:3, 3]
    cosine = along(plane.normal)
    distance = float(plane.normal @ eye - plane.offset)
    depth = np.asarray(np.float32(-distance) / cosine)
    east, north = np.eye(3)[:2]
    x, y = (np.float32(eye @ axis) + depth * along(axis) for axis in (east, north))
    return PlaneView(cosine, distance, depth, x, y)


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
