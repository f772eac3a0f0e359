"""Pinhole projection between pixels and the plane of the surface, both given in scene coordinates.

The surface has coordinates of its own: x and y in metres on it, z above it. Where the surface lies as the
scene says, they are the scene's.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from cleancli.array_types import Depth, Floats, Points
from cleancli.geometry.rgbd import Camera


@dataclass(frozen=True, slots=True)
class Plane:
    """The points p with normal · p = offset, in metres, and the surface's coordinates on it.

    `normal` (3,) has length 1 and points to the side that the camera sees. `origin` (3,) is where x and y are
    0, `east` (3,) the direction of x, with length 1; that of y is normal × east.
    """

    normal: Floats
    offset: float
    origin: Floats
    east: Floats

    @classmethod
    def below(cls, place: Floats, normal: Floats, offset: float, east: Floats) -> Self:
        """The plane with its origin perpendicularly below a place, and x along `east` as far as it can be."""
        flat = east - (normal @ east) * normal
        return cls(normal, offset, place - (normal @ place - offset) * normal, flat / np.linalg.norm(flat))

    @property
    def north(self) -> Floats:
        """The direction of y, (3,)."""
        return np.cross(self.normal, self.east)

    @property
    def pose(self) -> Floats:
        """(4, 4): from the surface's coordinates to the scene's."""
        pose = np.eye(4)
        pose[:3, :] = np.column_stack([self.east, self.north, self.normal, self.origin])
        return pose


@dataclass(frozen=True, slots=True)
class PlaneView:
    """A plane as a camera sees it.

    Arrays are (height, width). `cosine`: normal · ray for the ray with depth 1 through each pixel, negative
    where the upper side is seen. `distance`: metres from the camera to the plane, along the normal. `depth`:
    metres along the optical axis to the plane itself, 0 where the ray never meets it. `x`, `y`: where on the
    surface it does. `pixel_areas`: square metres of the plane behind each pixel.
    """

    cosine: Depth
    distance: float
    depth: Depth
    x: Depth
    y: Depth
    pixel_areas: Depth

    def height_of(self, depth: Depth) -> Depth:
        """Metres above the plane of what is seen at `depth`."""
        return np.asarray(depth * self.cosine + np.float32(self.distance), np.float32)


def view(camera: Camera, plane: Plane) -> PlaneView:
    """How `camera` sees `plane`."""
    columns = ((np.arange(camera.width) - camera.centre[0]) / camera.focal).astype(np.float32)[None, :]
    rows = ((np.arange(camera.height) - camera.centre[1]) / camera.focal).astype(np.float32)[:, None]

    def along(direction: Floats) -> Depth:
        """The component of each pixel's ray along a scene direction."""
        right, down, forward = (direction @ camera.pose[:3, :3]).astype(np.float32)
        return np.asarray(right * columns + (down * rows + forward))

    eye = camera.pose[:3, 3]
    cosine = along(plane.normal)
    distance = float(plane.normal @ eye - plane.offset)
    # Rays that run along the plane, or away from it, meet it nowhere.
    depth = np.asarray(np.float32(distance) / np.maximum(-cosine, np.float32(1e-6)), np.float32)
    depth[cosine > -1e-3] = 0
    from_origin = eye - plane.origin
    x, y = (
        np.asarray(np.float32(from_origin @ axis) + depth * along(axis), np.float32)
        for axis in (plane.east, plane.north)
    )
    areas = depth * depth * depth * np.float32(1 / (max(distance, 1e-6) * camera.focal**2))
    areas = np.asarray(areas, np.float32)
    return PlaneView(cosine, distance, depth, x, y, areas)


def relative_to(plane: Plane, camera: Camera) -> Camera:
    """The camera with a pose in the surface's coordinates, in which the surface is z = 0."""
    return replace(camera, pose=np.linalg.inv(plane.pose) @ camera.pose)


def rays(camera: Camera, pixels: Points) -> Points:
    """Directions in scene coordinates, of depth 1, through `pixels` (n, 2) given as (column, row); (n, 3)."""
    offsets = (pixels - np.array(camera.centre)) / camera.focal
    return np.asarray(np.column_stack([offsets, np.ones(len(pixels))]) @ camera.pose[:3, :3].T)


def on_plane(camera: Camera, plane: Plane, pixels: Points) -> Points:
    """x, y in metres on the surface where the rays through `pixels` (n, 2) meet the plane; (n, 2)."""
    directions = rays(camera, pixels)
    eye = camera.pose[:3, 3]
    depth = (plane.offset - plane.normal @ eye) / (directions @ plane.normal)
    met = eye - plane.origin + depth[:, None] * directions
    return np.column_stack([met @ plane.east, met @ plane.north])


def project(camera: Camera, points: Points) -> Points:
    """Pixels (n, 2) as (column, row) of scene points (n, 3), or of surface points (n, 2) at z = 0."""
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    seen = (points - camera.pose[:3, 3]) @ camera.pose[:3, :3]
    return np.asarray(seen[:, :2] / seen[:, 2:] * camera.focal + np.array(camera.centre))
