"""The workcell on the fast stand-in for the table: a look takes no picture, and finds what one would show."""

from __future__ import annotations

import time

import cv2
import numpy as np

from cleancli.array_types import Floats, Mask, Points
from cleancli.execution.episode_state import Situation
from cleancli.execution.table_cell import DrivenCell
from cleancli.execution.workcell import LookResult
from cleancli.geometry.rgbd import Camera
from cleancli.language.model import Domain
from cleancli.perception import areas, geometry, surface
from cleancli.perception.geometry import Plane
from cleancli.perception.perceive import RIM, Observation, Steps
from cleancli.perception.tracking import Stroke
from cleancli.scene.model import Scene
from cleancli.world import constants as par
from cleancli.world.camera import overhead
from cleancli.world.kinematic import KinematicTable

_FINE = 3  # bits of a pixel's fraction when discs are drawn


class KinematicCell(DrivenCell):
    """A `Workcell` that finds each particle exactly where it lies, unless the tool hides it: as perception
    does in pictures, but for its errors, which are a few millimetres (docs/measurements/perception.md)."""

    def __init__(self, domain: Domain, scene: Scene, table: KinematicTable) -> None:
        super().__init__(domain, scene, table)
        self._table = table
        self._camera = overhead(scene.camera)
        up, east = np.array((0.0, 0.0, 1.0)), np.array((1.0, 0.0, 0.0))
        self._plane = Plane.below(np.zeros(3), up, 0.0, east)
        self._view = geometry.view(self._camera, self._plane)
        self._inner = surface.extent_mask(self._view, scene.surface, RIM)

    def look(self, before: Situation | None, stroke: Stroke | None, number: int, named: int) -> LookResult:
        """Areas of what lies in view."""
        started = time.perf_counter()
        return self._told((), self._observation(), before, stroke, named, started)

    def _observation(self) -> Observation:
        camera, view = self._camera, self._view
        hidden = self._inner & shaded(camera, tool_corners(self._table.pose, self._scene.rag.width))
        dirty = discs(camera, self._table.dirt) & ~hidden
        found = areas.group(dirty, camera, self._plane, view, self._scene.symbols.link)
        whole = float(view.pixel_areas[self._inner].sum())
        share = float(view.pixel_areas[hidden].sum()) / whole
        steps = Steps(self._inner, ~hidden, dirty, dirty, dirty)
        return Observation(found, self._plane, steps, share, hidden, {}, camera)


def discs(camera: Camera, places: Points) -> Mask:
    """Which pixels show lentils at places (n, 2) of the surface."""
    drawn = np.zeros((camera.height, camera.width), np.uint8)
    radius = par.PARTICLES["lentils"].size[0] / 2 * camera.focal / camera.pose[2, 3]
    for column, row in geometry.project(camera, places) if len(places) else ():
        middle = round(column * 2**_FINE), round(row * 2**_FINE)
        cv2.circle(drawn, middle, round(radius * 2**_FINE), 1, cv2.FILLED, cv2.LINE_8, _FINE)
    return drawn.astype(np.bool_)


def tool_corners(pose: Floats, width: float) -> Floats:
    """(n, 3) corners around the cloth, its holder and the lower half of the post, at a tool pose (4,)."""
    x, y, z, yaw = pose
    cos, sin = np.cos(yaw), np.sin(yaw)
    half, high = par.HOLDER_SIZE[0] / 2, z + par.FLAP_HEIGHT + par.HOLDER_SIZE[1]
    bar = [(u, v, h) for u in (-half, half) for v in (-width / 2, width / 2) for h in (z, high)]
    thick = par.POST_RADIUS
    post = [
        (u, v, h) for u in (-thick, thick) for v in (-thick, thick) for h in (high, high + par.POST_HEIGHT)
    ]
    return np.array([(x + cos * u - sin * v, y + sin * u + cos * v, h) for u, v, h in (*bar, *post)])


def shaded(camera: Camera, corners: Floats) -> Mask:
    """Which pixels show something of a convex body with these corners (n, 3), metres."""
    local = (corners - camera.pose[:3, 3]) @ camera.pose[:3, :3]
    pixels = local[:, :2] / local[:, 2:] * camera.focal + np.array(camera.centre)
    hull = cv2.convexHull(pixels.astype(np.float32))
    drawn = np.zeros((camera.height, camera.width), np.uint8)
    cv2.fillConvexPoly(drawn, np.rint(hull).astype(np.int32), 1)
    return drawn.astype(np.bool_)
