"""The steps of §3.1 in their order: frames in, dirty areas out."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from cleancli.array_types import Mask
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception import areas, dirt, fit, geometry, outline, surface
from cleancli.perception.area import Area
from cleancli.perception.geometry import Plane, PlaneView
from cleancli.scene.calibration import Thresholds
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
    `hidden_mask` shows where in the image. `seconds` of computing, by step. `camera`: the frames' camera with
    its pose in the coordinates of the surface, as those of the areas are. `doubts`: what speaks against the
    scene's calibration, for people; nothing, if there is none.
    """

    areas: tuple[Area, ...]
    plane: Plane
    steps: Steps
    hidden: float
    hidden_mask: Mask
    seconds: Mapping[str, float]
    camera: Camera
    doubts: tuple[str, ...] = field(default=())


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

    Thresholds are those of the scene's calibration, or the defaults. Raises BadFrame and NoSurface. `rng`
    draws RANSAC's triples.
    """
    camera = checked_camera(frames)
    thresholds = Thresholds() if scene.calibration is None else scene.calibration.thresholds
    watch = _Watch()
    plane = find_surface(frames[0], scene, thresholds, rng)
    seen_as = geometry.view(camera, plane)
    extent = surface.extent_mask(seen_as, scene.surface)
    watch.lap("plane")
    steps: list[Steps] = []
    for frame in frames:
        step, background = _segmented(frame, seen_as, extent, thresholds, watch)
        steps.append(step)
    believed, seen = dirt.believed(
        [s.without_specks for s in steps], [s.without_edges for s in steps], thresholds
    )
    believed = dirt.without_small_patches(believed, seen_as.pixel_areas, thresholds)
    watch.lap("belief")
    found = areas.group(believed, camera, plane, seen_as, scene.symbols.link)
    watch.lap("ellipses")
    hidden, hidden_mask = _hidden(seen, seen_as, scene)
    watch.lap("hidden")
    doubts = _doubts(frames[-1], background, plane, seen_as, scene)
    watch.lap("doubts")
    shown = replace(steps[-1], believed=believed)
    relative = geometry.relative_to(plane, camera)
    return Observation(found, plane, shown, hidden, hidden_mask, watch.seconds, relative, doubts)


def checked_camera(frames: Sequence[Frame]) -> Camera:
    """The one camera of frames that fit it. Raises BadFrame."""
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


def find_surface(frame: Frame, scene: Scene, thresholds: Thresholds, rng: np.random.Generator) -> Plane:
    """Surface segmentation's first half: where the surface is. Raises NoSurface."""
    find = surface.find_plane if frame.camera.located else outline.find_by_outline
    return find(frame, scene.surface, thresholds, rng)


def _segmented(
    frame: Frame, seen_as: PlaneView, extent: Mask, thresholds: Thresholds, watch: _Watch
) -> tuple[Steps, Mask]:
    """One frame's masks, of which the last is believed as it is, and which pixels show the background."""
    on_surface = surface.surface_mask(frame, seen_as, extent, thresholds)
    watch.lap("surface")
    objects = surface.object_mask(frame, seen_as, thresholds)
    trusted = surface.without_edges(on_surface, objects, thresholds)
    watch.lap("edges")
    subtraction = dirt.subtract_background(frame.colour, trusted, seen_as.pixel_areas, thresholds)
    watch.lap("background")
    filtered = dirt.without_specks(subtraction, thresholds)
    watch.lap("median")
    return Steps(on_surface, trusted, subtraction.left, filtered, filtered), subtraction.background


def _hidden(seen: Mask, seen_as: PlaneView, scene: Scene) -> tuple[float, Mask]:
    """Measured in square metres, so that a part of the surface outside the image counts as hidden too."""
    inner = surface.extent_mask(seen_as, scene.surface, RIM)
    whole = (scene.surface.width - 2 * RIM) * (scene.surface.depth - 2 * RIM)
    visible = float(seen_as.pixel_areas[seen & inner].sum())
    return max(0.0, 1 - visible / whole), inner & ~seen


def _doubts(
    frame: Frame, background: Mask, plane: Plane, seen_as: PlaneView, scene: Scene
) -> tuple[str, ...]:
    if scene.calibration is None:
        return ()
    colours = fit.colours_of(frame.colour, background, seen_as, scene.surface)
    return fit.doubts(colours, fit.tilt_of(plane, frame.camera.pose[:3, 2]), scene.calibration.appearance)
