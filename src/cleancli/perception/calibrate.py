"""The smallest thresholds for which a clean surface is seen as clean (§3.1), and how much room they leave.

"Perception modules are initialized using a clean surface: the different parameters are adjusted to the
minimum values for which the entire surface gets segmented as clean."
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np

from cleancli.array_types import Depth, Mask
from cleancli.geometry.rgbd import Frame
from cleancli.perception import dirt, fit, geometry, reference, surface
from cleancli.perception.dirt import Subtraction
from cleancli.perception.geometry import Plane, PlaneView
from cleancli.perception.perceive import RIM, BadFrame, checked_camera, find_surface
from cleancli.scene.calibration import Appearance, Calibration, Reference, Thresholds
from cleancli.scene.model import Scene

MARGIN = {"tolerance": 1.25, "gradient": 1.35, "contrast": 1.3}
"""What is stored exceeds the smallest value that sufficed by these factors: other frames have other noise.
Chosen on the pairs of `python benchmarks/real_tables.py`."""

MOST = {"tolerance": 0.04, "gradient": 0.4, "contrast": 0.5}
"""Values from which on real dirt would be taken for the surface, too."""

LEAST = {"tolerance": 0.001, "gradient": 0.004, "contrast": 0.02}
"""Values below which nothing is gained: a frame without noise would lead to 0."""

OFF = 1e-4
"""Share of the pixels that may lie off the plane: noise has no largest value."""

EVEN = 0.99
"""Share of the trusted pixels that regions must take in by the gradient alone. A little below the gradient
that does it, regions fall apart all at once, and a contrast that hides what is left would hide that."""

FINE = 1.02
"""Factor up to which a smallest value is found."""

MOST_EDGE = 8
"""Pixels along the surface's outline that may be given up."""

MOST_OBJECT_EDGE = 24
"""Pixels around an object that may be given up."""

OBJECT = 4e-4
"""Square metres from which on what stands on the surface is an object to learn from, and no dirt."""


class NotClean(Exception):
    """Frames for which no thresholds make the surface clean; the message says which step fails.

    `frame` is the first that fails, and `where` (height, width) what of it is not clean.
    """

    def __init__(self, message: str, frame: Frame, where: Mask) -> None:
        self.frame, self.where = frame, where
        super().__init__(message)


@dataclass(frozen=True, slots=True)
class LeftOut:
    """What one frame shows with the thresholds that the others ask for: the share of its trusted pixels that
    is background, its false patches, and by what factors the thresholds exceed what it would need."""

    background: float
    false: int
    gradient: float
    contrast: float


@dataclass(frozen=True, slots=True)
class Adjusted:
    """A calibration, and what it promises.

    `left_out`: each frame judged by the others; nothing, where there is one alone. `objects`: the share of
    the surface that objects cover, from which `object_edge` was learned; 0 if it was not. `steepness`
    (height, width): how near each trusted pixel of the first frame comes to the threshold of the gradient,
    1 where it reaches it, and NaN where it was not judged.
    """

    calibration: Calibration
    left_out: tuple[LeftOut, ...]
    objects: float
    steepness: Depth


@dataclass(frozen=True, slots=True)
class _View:
    """The surface as all frames show it, the masks of the first step, and what stands on it in each frame."""

    frames: Sequence[Frame]
    plane: Plane
    seen_as: PlaneView
    extent: Mask
    inner: Mask
    objects: Sequence[Mask]


def calibrate(
    frames: Sequence[Frame], scene: Scene, path: str, rng: np.random.Generator, keeps_picture: bool = False
) -> Adjusted:
    """Thresholds for the clean surface that `frames` of one camera show; `path` is how scenes will name it.

    One after another, each is lowered as far as every single frame allows while the others are at their
    defaults, or at what was found for them: the tolerance of depth, the gradient, for which regions must take
    in `EVEN` of the surface, the contrast, and the edges of the surface and of objects on it. Those that a
    clean surface says nothing about keep their defaults. With `keeps_picture` the mean of the frames, of at
    least two, is kept to take the surface's texture away, with thresholds of its own: what is told is then of
    these, each frame flattened by the others. Raises BadFrame, NoSurface, and NotClean.
    """
    camera = checked_camera(frames)
    plane = find_surface(frames[0], scene, Thresholds(), rng)
    seen_as = geometry.view(camera, plane)
    found = _adjusted(frames, plane, seen_as, scene, path)
    if not keeps_picture:
        return found
    if len(frames) < 2:
        raise BadFrame("a picture of the clean surface to refer to needs two frames or more")
    others = ([*frames[:number], *frames[number + 1 :]] for number in range(len(frames)))
    flat = [
        reference.flattened(frame, reference.mean_colour(rest))
        for frame, rest in zip(frames, others, strict=True)
    ]
    told = _adjusted(flat, plane, seen_as, scene, path)
    picture = reference.as_png(reference.mean_colour(frames))
    kept = Reference(told.calibration.thresholds, picture)
    return replace(told, calibration=replace(found.calibration, reference=kept))


def _adjusted(frames: Sequence[Frame], plane: Plane, seen_as: PlaneView, scene: Scene, path: str) -> Adjusted:
    default = Thresholds()
    extent = surface.extent_mask(seen_as, scene.surface)
    inner = surface.extent_mask(seen_as, scene.surface, RIM)
    heights = (surface.heights(frame, seen_as, default) for frame in frames)
    objects = [_large(surface.object_mask(height, default) & extent, seen_as) for height in heights]
    view = _View(frames, plane, seen_as, extent, inner, objects)
    found = replace(default, tolerance=_tolerance(view, default))
    # Far from all edges, whose colours would count as the surface's own.
    far = replace(found, surface_edge=MOST_EDGE, object_edge=MOST_OBJECT_EDGE)
    trusted = [_trusted(frame, view, far) for frame in frames]
    found = replace(found, darkest=_brightness(frames, trusted))
    steep = [_gradient(view, frame, mask, found) for frame, mask in zip(frames, trusted, strict=True)]
    # The contrast must hide what is left at a gradient without a margin, or it had none of its own.
    barely = replace(found, gradient=max(steep))
    strong = [_contrast(view, frame, mask, barely) for frame, mask in zip(frames, trusted, strict=True)]
    needs = list(zip(steep, strong, strict=True))
    found = _with_edges(view, _with_needs(found, needs))
    trusted = [_trusted(frame, view, found) for frame in frames]
    left_out = tuple(
        _judged(view, number, trusted[number], needs[number], _with_needs(found, others))
        for number in range(len(frames))
        if (others := needs[:number] + needs[number + 1 :])
    )
    calibration = Calibration(path, found, _appearance(view, scene, found))
    share = float(objects[0].sum() / max(int(extent.sum()), 1))
    steepness = np.sqrt(dirt.squared_steepness(frames[0].colour, found))
    steepness[~trusted[0]] = np.nan
    return Adjusted(calibration, left_out, share, steepness)


def _with_needs(thresholds: Thresholds, needs: Sequence[tuple[float, float]]) -> Thresholds:
    """With what the most demanding of some frames needs of gradient and contrast, and the margins."""
    gradient, contrast = (max(each) for each in zip(*needs, strict=True))
    return replace(
        thresholds,
        gradient=min(MOST["gradient"], MARGIN["gradient"] * gradient),
        contrast=min(MOST["contrast"], MARGIN["contrast"] * contrast),
    )


def _smallest(name: str, others: Thresholds, suffices: Callable[[Thresholds], bool]) -> float | None:
    """The smallest value of one threshold that suffices, None if even the largest doesn't."""
    low, high = LEAST[name], MOST[name]

    def does(value: float) -> bool:
        changed: dict[str, Any] = {name: value}
        return suffices(replace(others, **changed))

    if not does(high):
        return None
    if does(low):
        return low
    while high / low > FINE:
        middle = float(np.sqrt(low * high))
        if does(middle):
            high = middle
        else:
            low = middle
    return high


def _tolerance(view: _View, default: Thresholds) -> float:
    """For which every pixel within the rim whose depth is known lies on the plane, but for `OFF`. What stands
    on the surface does not count."""
    found = [_tolerance_of(view, number, default) for number in range(len(view.frames))]
    return min(MOST["tolerance"], MARGIN["tolerance"] * max(found))


def _tolerance_of(view: _View, number: int, default: Thresholds) -> float:
    frame = view.frames[number]
    known = surface.known_depth(frame) & view.inner & ~_around(view.objects[number], MOST_EDGE)

    def off(thresholds: Thresholds) -> Mask:
        height = surface.heights(frame, view.seen_as, thresholds)
        return known & ~surface.surface_mask(height, view.extent)

    least = _smallest("tolerance", default, lambda t: off(t).sum() <= OFF * max(int(known.sum()), 1))
    if least is None:
        where = off(replace(default, tolerance=MOST["tolerance"]))
        raise NotClean(_not_flat(where, int(known.sum()), number + 1, frame, view), frame, where)
    return least


def _not_flat(where: Mask, known: int, number: int, frame: Frame, view: _View) -> str:
    high = where & (view.seen_as.height_of(frame.depth) > 0)
    told = [
        f"{int(mask.sum())} pixels ({mask.sum() / known:.2%}) lie {way} it, most around {_place(mask)}"
        for mask, way in ((high, "above"), (where & ~high, "below"))
        if mask.any()
    ]
    return (
        f"the surface is not clean even with a tolerance of {MOST['tolerance']:g}: in frame {number} "
        + "; ".join(told)
    )


def _place(mask: Mask) -> str:
    """Where in the image the largest patch of a mask is."""
    _, _, statistics, middles = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=8)
    column, row = middles[1 + int(statistics[1:, cv2.CC_STAT_AREA].argmax())]
    return f"column {column:.0f}, row {row:.0f}"


def _with_edges(view: _View, found: Thresholds) -> Thresholds:
    """With the fewest pixels along the outline, but no fewer than usual, and around objects, beside which
    nothing is seen as dirt: at the rim, too, one frame's noise decides nothing."""
    usual = Thresholds()
    wide = replace(found, object_edge=MOST_OBJECT_EDGE)
    edge = _fewest(range(usual.surface_edge, MOST_EDGE + 1), view, wide, "surface_edge", "its outline")
    found = replace(found, surface_edge=edge, object_edge=max(usual.object_edge, edge + 2))
    if any(objects.any() for objects in view.objects):
        around = _fewest(range(edge + 2, MOST_OBJECT_EDGE + 1), view, found, "object_edge", "objects on it")
        found = replace(found, object_edge=min(MOST_OBJECT_EDGE, around + -(-around // 4)))
    return found


def _fewest(edges: range, view: _View, others: Thresholds, name: str, what: str) -> int:
    """The first number of pixels at which no dirt is seen in any frame."""

    def dirty(edge: int) -> tuple[Frame, Mask] | None:
        changed: dict[str, Any] = {name: edge}
        seen = ((frame, _dirty(frame, view, replace(others, **changed))) for frame in view.frames)
        return next(((frame, where) for frame, where in seen if where.any()), None)

    fitting = next((edge for edge in edges if dirty(edge) is None), None)
    if fitting is not None:
        return fitting
    failed = dirty(edges[-1])
    assert failed is not None
    frame, where = failed
    message = f"dirt is seen around {_place(where)} even where {edges[-1]} pixels beside {what} do not count"
    raise NotClean(message, frame, where)


def _gradient(view: _View, frame: Frame, trusted: Mask, others: Thresholds) -> float:
    def background(thresholds: Thresholds) -> Mask:
        return _subtracted(frame, trusted, view, thresholds).background

    least = _smallest("gradient", others, lambda t: background(t).sum() >= EVEN * trusted.sum())
    if least is None:
        where = trusted & ~background(replace(others, gradient=MOST["gradient"]))
        share = where.sum() / max(int(trusted.sum()), 1)
        message = f"{share:.0%} of the surface has no even colour, most of it around {_place(where)}"
        raise NotClean(f"{message}: is it clean, and without a pattern?", frame, where)
    return least


def _contrast(view: _View, frame: Frame, trusted: Mask, others: Thresholds) -> float:
    subtraction = _subtracted(frame, trusted, view, others)
    least = _smallest("contrast", others, lambda t: not _patches(subtraction, view, t).any())
    if least is None:
        where = _patches(subtraction, view, replace(others, contrast=MOST["contrast"]))
        message = f"dirt is seen around {_place(where)} even with a contrast of {MOST['contrast']:g}"
        raise NotClean(message, frame, where)
    return least


def _judged(
    view: _View, number: int, trusted: Mask, needs: tuple[float, float], thresholds: Thresholds
) -> LeftOut:
    subtraction = _subtracted(view.frames[number], trusted, view, thresholds)
    share = float(subtraction.background.sum() / max(int(trusted.sum()), 1))
    patches = _patches(subtraction, view, thresholds)
    false = cv2.connectedComponents(patches.view(np.uint8), connectivity=8)[0] - 1
    return LeftOut(share, false, thresholds.gradient / needs[0], thresholds.contrast / needs[1])


def _brightness(frames: Sequence[Frame], trusted: Sequence[Mask]) -> float:
    """The median brightness of what is trusted: noise there is what is known of noise."""
    medians = [
        float(np.median(frame.colour[mask].mean(axis=1))) if mask.any() else 0.0
        for frame, mask in zip(frames, trusted, strict=True)
    ]
    return round(max(1.0, float(np.median(medians))), 1)


def _dirty(frame: Frame, view: _View, thresholds: Thresholds) -> Mask:
    subtraction = _subtracted(frame, _trusted(frame, view, thresholds), view, thresholds)
    return _patches(subtraction, view, thresholds)


def _trusted(frame: Frame, view: _View, thresholds: Thresholds) -> Mask:
    height = surface.heights(frame, view.seen_as, thresholds)
    on_surface = surface.surface_mask(height, view.extent)
    objects = surface.object_mask(height, thresholds)
    return surface.without_edges(on_surface, objects, thresholds)


def _subtracted(frame: Frame, trusted: Mask, view: _View, thresholds: Thresholds) -> Subtraction:
    return dirt.subtract_background(frame.colour, trusted, view.seen_as.pixel_areas, thresholds)


def _patches(subtraction: Subtraction, view: _View, thresholds: Thresholds) -> Mask:
    filtered = dirt.without_specks(subtraction, thresholds)
    return dirt.without_small_patches(filtered, view.seen_as.pixel_areas, thresholds)


def _large(objects: Mask, seen_as: PlaneView) -> Mask:
    """The objects that are large enough to have been put there."""
    _, labels = cv2.connectedComponents(objects.view(np.uint8), connectivity=8)
    sizes = np.bincount(labels[objects], seen_as.pixel_areas[objects], minlength=1)
    return np.asarray((sizes >= OBJECT)[labels])


def _around(mask: Mask, pixels: int) -> Mask:
    size = 2 * pixels + 1
    return cv2.dilate(mask.view(np.uint8), np.ones((size, size), np.uint8)).view(np.bool_)


def _appearance(view: _View, scene: Scene, thresholds: Thresholds) -> Appearance:
    frame = view.frames[0]
    trusted = _trusted(frame, view, thresholds)
    shown = _subtracted(frame, trusted, view, thresholds).background
    colours = np.nan_to_num(fit.colours_of(frame.colour, shown, view.seen_as, scene.surface))
    triples = tuple((round(r, 1), round(g, 1), round(b, 1)) for r, g, b in colours.tolist())
    tilt = fit.tilt_of(view.plane, frame.camera.pose[:3, 2])
    return Appearance(fit.COLUMNS, fit.ROWS, triples, round(tilt, 4))
