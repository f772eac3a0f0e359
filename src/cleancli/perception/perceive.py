"""The steps of §3.1 in their order: frames in, dirty areas out."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from cleancli.array_types import Mask
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.motion.zone import inwards
from cleancli.perception import areas, dirt, fit, geometry, misread, outline, reference, surface
from cleancli.perception.area import Area
from cleancli.perception.geometry import Plane, PlaneView
from cleancli.perception.surface import NoBackground, NoSurface
from cleancli.scene.calibration import Thresholds
from cleancli.scene.model import Scene, Zone

RIM = 0.010
"""Metres along the surface's rim that are never seen well, and do not count as hidden."""


LEAST_BACKGROUND = 1 / 3
"""Share of what is seen of the surface that must be background, or nothing is told from it."""

USUAL_BACKGROUND = 0.8
"""Share below which that is worth a doubt; no table that is worth cleaning has so much dirt."""

BORDER = 0.002
"""Metres around the zone in which dirt counts as within it: about a pixel. Chosen."""

FLAT = 0.97
"""Share of background that a fitting picture of the clean surface leaves; three pixels beside its place it is
0.92 of wood."""

WORTH_JUDGING = 0.02
"""Square metres of the surface that must be seen for its background's share to mean anything."""


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
    its pose in the coordinates of the surface, as those of the areas are. `doubts`: what speaks against how
    the frames were read or described, and against the scene's calibration, for people. `arrived`: the
    share of the dirt seen that lies in the scene's zone, and so in no area; None without a zone, or dirt.
    """

    areas: tuple[Area, ...]
    plane: Plane
    steps: Steps
    hidden: float
    hidden_mask: Mask
    seconds: Mapping[str, float]
    camera: Camera
    doubts: tuple[str, ...] = field(default=())
    arrived: float | None = None


@dataclass(frozen=True, slots=True)
class _Segmented:
    """The steps of each frame, the last one's background, and the median share of what is trusted that is
    background; `doubts` say why the calibration's picture of the clean surface was not used."""

    steps: list[Steps]
    background: Mask
    even: float
    doubts: tuple[str, ...]


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

    Thresholds are those of the scene's calibration, or the defaults. Raises BadFrame, and NoSurface or
    NoBackground. `rng` draws RANSAC's triples.
    """
    camera = checked_camera(frames)
    thresholds = Thresholds() if scene.calibration is None else scene.calibration.thresholds
    watch = _Watch()
    plane = find_surface(frames[0], scene, thresholds, rng)
    seen_as = geometry.view(camera, plane)
    extent = surface.extent_mask(seen_as, scene.surface)
    watch.lap("plane")
    segmented = _all_segmented(frames, seen_as, extent, scene, watch)
    steps = segmented.steps
    if segmented.even < LEAST_BACKGROUND:
        raise NoBackground(_uneven(segmented.even, scene))
    believed, seen = dirt.believed(
        [s.without_specks for s in steps], [s.without_edges for s in steps], thresholds
    )
    believed = dirt.without_small_patches(believed, seen_as.pixel_areas, thresholds)
    watch.lap("belief")
    arrived = None
    if scene.zone is not None:
        inside = in_zone(believed, frames, seen_as, plane, scene.zone)
        arrived = _share_of(inside, believed, seen_as)
        believed = dirt.without_small_patches(believed & ~inside, seen_as.pixel_areas, thresholds)
        watch.lap("zone")
    found = areas.group(believed, camera, plane, seen_as, scene.symbols.link)
    watch.lap("ellipses")
    hidden, hidden_mask = _hidden(seen, seen_as, scene)
    watch.lap("hidden")
    doubts = _doubts(frames[-1], segmented, plane, seen_as, scene, thresholds)
    watch.lap("doubts")
    shown = replace(steps[-1], believed=believed)
    relative = geometry.relative_to(plane, camera)
    return Observation(
        found, plane, shown, hidden, hidden_mask, watch.seconds, relative, tuple(doubts), arrived
    )


def in_zone(believed: Mask, frames: Sequence[Frame], seen_as: PlaneView, plane: Plane, zone: Zone) -> Mask:
    """The dirty pixels that show something in the zone, `BORDER` around it included.

    What stands above the surface is seen beside its place, so each pixel's own depth tells where it is.
    """
    rows, columns = np.nonzero(believed)
    depths = np.stack([frame.depth[rows, columns] for frame in frames])
    known = np.isfinite(depths) & (depths > 0)
    on_plane = seen_as.depth[rows, columns]
    depth = np.median(np.where(known, depths, on_plane), axis=0)
    nadir = (frames[0].camera.pose[:3, 3] - plane.origin) @ np.column_stack((plane.east, plane.north))
    places = np.column_stack((seen_as.x[rows, columns], seen_as.y[rows, columns])).astype(np.float64)
    places = nadir + (places - nadir) * (depth / on_plane)[:, None]
    inside = np.zeros_like(believed)
    inside[rows, columns] = inwards(zone, places) >= -BORDER
    return inside


def _share_of(part: Mask, whole: Mask, seen_as: PlaneView) -> float | None:
    """The share of the surface behind some pixels that is behind a part of them."""
    total = float(seen_as.pixel_areas[whole].sum())
    return float(seen_as.pixel_areas[part].sum()) / total if total > 0 else None


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
    """Surface segmentation's first half: where the surface is. Raises NoSurface, whose reason says what the
    frame looks like instead."""
    find = surface.find_plane if frame.camera.located else outline.find_by_outline
    try:
        return find(frame, scene.surface, thresholds, rng)
    except NoSurface as error:
        told = [error.reason, *_looks_like(frame, scene, thresholds, rng), misread.where_points_fall(frame)]
        raise NoSurface("; ".join(told)) from error


def _looks_like(frame: Frame, scene: Scene, thresholds: Thresholds, rng: np.random.Generator) -> list[str]:
    """Which mistakes of reading or describing it explain that the surface is not found."""
    found = misread.of_frame(frame) or misread.of_depth(frame)
    if found or not frame.camera.located:
        return found
    try:
        surface.find_plane(misread.inverted(frame), scene.surface, thresholds, rng)
    except NoSurface:
        return ["is the camera's pose right?"]
    return ["with its pose inverted it is found: does `pose` lead from the scene to the camera?"]


def _all_segmented(
    frames: Sequence[Frame], seen_as: PlaneView, extent: Mask, scene: Scene, watch: _Watch
) -> _Segmented:
    """With the calibration's picture of the clean surface where there is one that fits, else without."""
    calibration = scene.calibration

    def segmented(those: Sequence[Frame], thresholds: Thresholds, doubts: tuple[str, ...] = ()) -> _Segmented:
        found = [_segmented(frame, seen_as, extent, thresholds, watch) for frame in those]
        shares = [_share(background, step.without_edges, seen_as) for step, background in found]
        return _Segmented([step for step, _ in found], found[-1][1], float(np.median(shares)), doubts)

    if calibration is None or calibration.reference is None:
        return segmented(frames, Thresholds() if calibration is None else calibration.thresholds)
    picture = reference.read_reference(calibration.reference.picture, frames[0])
    if picture is None:
        size = f"{frames[0].camera.width} x {frames[0].camera.height}"
        dropped = f"the picture of the clean surface is not of {size} pixels, and is not used"
        return segmented(frames, calibration.thresholds, (dropped,))
    clean = picture.astype(np.float32)
    flat = segmented([reference.flattened(f, clean) for f in frames], calibration.reference.thresholds)
    if flat.even >= FLAT:
        return flat
    dropped = "the picture of the clean surface no longer fits, and is not used: did camera or light move?"
    plain = segmented(frames, calibration.thresholds, (dropped,))
    # Much dirt is missing from the background of both alike.
    return flat if flat.even >= plain.even - (1 - FLAT) else plain


def _segmented(
    frame: Frame, seen_as: PlaneView, extent: Mask, thresholds: Thresholds, watch: _Watch
) -> tuple[Steps, Mask]:
    """One frame's masks, of which the last is believed as it is, and which pixels show the background."""
    height = surface.heights(frame, seen_as, thresholds)
    on_surface = surface.surface_mask(height, extent)
    watch.lap("surface")
    objects = surface.object_mask(height, thresholds)
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


def _share(background: Mask, trusted: Mask, seen_as: PlaneView) -> float:
    """The share of what is trusted that is background; 1 where too little is seen to tell."""
    step = slice(None, None, surface.STRIDE)
    sizes = seen_as.pixel_areas[step, step] * np.float32(surface.STRIDE**2)
    seen = float(sizes[trusted[step, step]].sum())
    return float(sizes[background[step, step]].sum()) / seen if seen > WORTH_JUDGING else 1.0


def _uneven(share: float, scene: Scene) -> str:
    mend = (
        "`cleancli calibrate` adjusts to a pattern"
        if scene.calibration is None
        else "is it patterned, or the light another one than when calibrated?"
    )
    return f"only {share:.0%} of the surface is of an even colour: {mend}"


def _doubts(
    frame: Frame,
    segmented: _Segmented,
    plane: Plane,
    seen_as: PlaneView,
    scene: Scene,
    thresholds: Thresholds,
) -> list[str]:
    """What speaks against the last frame, how it is described, and the calibration."""
    on_surface = segmented.steps[-1].surface
    found = misread.of_frame(frame) + misread.of_plane(plane, frame.camera)
    found += misread.of_extent(frame, seen_as, scene.surface, thresholds)
    found += misread.of_border(frame, on_surface)
    found += misread.of_colour(frame, on_surface) + misread.of_shift(frame, on_surface)
    found += segmented.doubts
    if segmented.even < USUAL_BACKGROUND:
        found.append(_uneven(segmented.even, scene))
    return found + _changed(frame, segmented.background, plane, seen_as, scene)


def _changed(frame: Frame, background: Mask, plane: Plane, seen_as: PlaneView, scene: Scene) -> list[str]:
    """What no longer is as it was when the scene's thresholds were adjusted."""
    if scene.calibration is None:
        return []
    colours = fit.colours_of(frame.colour, background, seen_as, scene.surface)
    tilt = fit.tilt_of(plane, frame.camera.pose[:3, 2])
    return list(fit.doubts(colours, tilt, scene.calibration.appearance))
