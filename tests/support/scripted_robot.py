"""A robot whose world is a script: what the camera shows, and how motions end."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from cleancli.geometry.rgbd import Camera, Frame
from cleancli.motion.path import ToolPath
from cleancli.scene.model import Scene
from cleancli.world.camera import overhead
from cleancli.world.robot import Status

Points = Sequence[tuple[float, float]]
STROKE, WITHDRAWAL = 5.0, 1.0
"""Seconds that motions take."""


class Scripted:
    """A `Robot` that sees dirt where `dirt(strokes)` says, strokes being how many were carried out, and whose
    strokes end as `ends(strokes)` says. While its tool is out, `hides` (low x, high x) is out of view."""

    def __init__(
        self,
        scene: Scene,
        dirt: Callable[[int], Points],
        ends: Callable[[int], Status] = lambda strokes: Status.DONE,
        hides: tuple[float, float] | None = None,
    ) -> None:
        self._camera, self._surface = overhead(scene.camera), scene.surface
        self._dirt, self._ends, self._hides = dirt, ends, hides
        self._noise = np.random.default_rng(1)
        self._status = Status.DONE
        self.out = False
        self.strokes = self.stops = 0
        self.clock = 0.0
        self.failure = "something holds the tool back"
        self.tool = (0.0, 0.0, 0.3)

    def observe(self) -> Frame:
        """The surface with black spots on a floor."""
        hides = self._hides if self.out else None
        return painted(
            self._camera, self._surface.width, self._surface.depth, self._dirt(self.strokes), hides
        )

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """It can, whatever the path."""
        return True

    def start(self, path: ToolPath) -> None:
        """The whole stroke in one period."""
        last = path.waypoints[-1]
        self.tool = last.x, last.y, last.z
        self._status = self._ends(self.strokes)
        self.strokes += 1
        self.out = True
        self.clock += STROKE

    def withdraw(self) -> None:
        """Out of view in one period."""
        self._status = Status.DONE
        self.clock += WITHDRAWAL if self.out else 0.0
        self.out = False

    def poll(self) -> Status:
        """How the motion ended."""
        return self._status

    def stop(self) -> None:
        """Counted."""
        self.stops += 1
        self._status = Status.DONE


def painted(
    camera: Camera, width: float, depth: float, dirt: Points, hides: tuple[float, float] | None
) -> Frame:
    """A clean light surface at z = 0 with a dark spot of 1 cm at each place; where it is hidden, a slab
    10 cm above it."""
    columns, rows = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    away = float(camera.pose[2, 3]) / camera.focal
    places = np.stack(((columns - camera.centre[0]) * away, -(rows - camera.centre[1]) * away), axis=-1)
    on = (np.abs(places[..., 0]) <= width / 2) & (np.abs(places[..., 1]) <= depth / 2)
    colour = np.where(on[..., None], (205, 198, 184), (120, 110, 100)).astype(np.uint8)
    height = float(camera.pose[2, 3])
    z = np.where(on, height, height + 0.7)
    for spot in dirt:
        colour[np.hypot(places[..., 0] - spot[0], places[..., 1] - spot[1]) <= 0.006] = (40, 35, 30)
    if hides is not None:
        slab = on & (places[..., 0] >= hides[0]) & (places[..., 0] <= hides[1])
        colour[slab], z = (60, 90, 160), np.where(slab, height - 0.1, z)
    return Frame(colour, z.astype(np.float32), camera, 0.0)
