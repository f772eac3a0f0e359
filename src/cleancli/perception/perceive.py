"""The steps of §3.1 in their order: frames in, dirty areas out."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.perception import areas, dirt, geometry, surface
from cleancli.perception.area import Area
from cleancli.perception.frame import Camera, Frame
from cleancli.perception.geometry import Plane, PlaneView
from cleancli.perception.surface import Mask
from cleancli.scene.model import Scene

RIM = 0.010
"""Metres along the surface's rim that are never seen well, and do not count as hidden."""


class BadFrame(Exception):
    """Frames that no perception can use: none, or one that does not fit its camera."""


@dataclass(frozen=True, slots=True)
class Steps:
    """What each step of §3.1 left over, (height, width) each; all but `believed` of the last frame."""

    surface: Mask
    without_edges: Mask
    dirty: Mask
    without_specks: Mask
    believed: Mask


@dataclass(frozen=True, slots=True)
class Observation:
    """What was seen: unnamed `areas` from west to east, and the `plane` on which they lie.

    `hidden`: share of the surface, its outermost centimetre aside, about which nothing is known;
    `hidden_mask` shows where in the image. `seconds` of computing, by step.
    """

    areas: tuple[Area, ...]
    plane: Plane
    steps: Steps
    hidden: float
    hidden_mask: Mask
    seconds: Mapping[str, float]


class _Watch:
    """Adds up seconds by step."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, step: str) -> None:
        now = time.perf_counter()
        self.seconds[step] = self.seconds.get(step, 0.0) + now - self._last
        self._last = now


def perceive(frames: Sequence[Frame], scene: Scene, rng: np.random.Generator) -> Observation:
    """Find the dirty areas that most of `frames` show; all frames are taken by one camera that stands still.

    Raises BadFrame and NoSurface. `rng` draws RANSAC's triples.
    """
    camera = _common_camera(frames)
    watch = _Watch()
    plane = surface.find_plane(frames[0], scene.surface, rng)
    seen_as = geometry.view(camera, plane)
    extent = surface.extent_mask(seen_as, scene.surface)
    watch.lap("plane")
    steps: list[Steps] = []
    for frame in frames:
        steps.append(_segmented(frame, seen_as, extent, watch))
    believed, seen = dirt.believed([s.without_specks for s in steps], [s.without_edges for s in steps])
    watch.lap("belief")
    found = areas.group(believed, camera, plane, seen_as, scene.symbols.link)
    watch.lap("ellipses")
    last = steps[-1]
    shown = Steps(last.surface, last.without_edges, last.dirty, last.without_specks, believed)
    hidden, hidden_mask = _hidden(seen, camera, seen_as, scene)
    watch.lap("hidden")
    return Observation(found, plane, shown, hidden, hidden_mask, watch.seconds)


def _segmented(frame: Frame, seen_as: PlaneView, extent: Mask, watch: _Watch) -> Steps:
    """One frame's masks; what is believed after it alone is what it shows."""
    on_surface = surface.surface_mask(frame, seen_as, extent)
    watch.lap("surface")
    trusted = surface.without_edges(on_surface, surface.object_mask(frame, seen_as))
    watch.lap("edges")
    subtraction = dirt.subtract_background(frame.colour, trusted)
    watch.lap("background")
    filtered = dirt.without_specks(subtraction)
    watch.lap("median")
    return Steps(on_surface, trusted, subtraction.left, filtered, filtered)


def _hidden(seen: Mask, camera: Camera, seen_as: PlaneView, scene: Scene) -> tuple[float, Mask]:
    """Measured in square metres, so that a part of the surface outside the image counts as hidden too."""
    inner = surface.extent_mask(seen_as, scene.surface, RIM)
    whole = (scene.surface.width - 2 * RIM) * (scene.surface.depth - 2 * RIM)
    visible = float(seen_as.pixel_areas(camera.focal)[seen & inner].sum())
    return max(0.0, 1 - visible / whole), inner & ~seen


def _common_camera(frames: Sequence[Frame]) -> Camera:
    if not frames:
        raise BadFrame("there is no frame")
    camera = frames[0].camera
    size = (camera.height, camera.width)
    for number, frame in enumerate(frames, start=1):
        other = frame.camera
        if (other.height, other.width) != size or not np.array_equal(other.pose, camera.pose):
            raise BadFrame(f"frame {number} was taken by another camera, or from another place")
        if frame.colour.shape != (*size, 3) or frame.colour.dtype != np.uint8:
            raise BadFrame(f"frame {number}: colour must be uint8 {(*size, 3)}, not {frame.colour.shape}")
        if frame.depth.shape != size:
            raise BadFrame(f"frame {number}: depth must be {size}, not {frame.depth.shape}")
    if min(size) < 2 * surface.STRIDE:
        raise BadFrame(f"an image of {size[1]} x {size[0]} pixels is too small")
    return camera
