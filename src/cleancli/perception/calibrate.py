"""The smallest thresholds for which a clean surface is seen as clean (§3.1).

"Perception modules are initialized using a clean surface: the different parameters are adjusted to the
minimum values for which the entire surface gets segmented as clean."
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cleancli.array_types import Mask
from cleancli.geometry.rgbd import Frame
from cleancli.perception import dirt, fit, geometry, surface
from cleancli.perception.geometry import Plane, PlaneView
from cleancli.perception.perceive import RIM, checked_camera, find_surface
from cleancli.scene.calibration import Appearance, Calibration, Thresholds
from cleancli.scene.model import Scene

MARGIN = 1.25
"""What is stored exceeds the smallest value that sufficed by this factor: other frames have other noise."""

MOST = {"tolerance": 0.04, "gradient": 0.4, "contrast": 0.5}
"""Values from which on real dirt would be taken for the surface, too."""

LEAST = {"tolerance": 0.001, "gradient": 0.004, "contrast": 0.02}
"""Values below which nothing is gained: a frame without noise would lead to 0."""

FINE = 1.02
"""Factor up to which a smallest value is found."""

MOST_EDGE = 8
"""Pixels along the surface's outline that may be given up."""


class NotClean(Exception):
    """Frames for which no thresholds make the surface clean; the message says which step fails."""


@dataclass(frozen=True, slots=True)
class _View:
    """The surface as all frames show it, and the masks of the first step."""

    frames: Sequence[Frame]
    plane: Plane
    seen_as: PlaneView
    extent: Mask
    inner: Mask


def calibrate(frames: Sequence[Frame], scene: Scene, path: str, rng: np.random.Generator) -> Calibration:
    """Thresholds for the clean surface that `frames` of one camera show; `path` is how scenes will name it.

    One after another, each is lowered as far as the surface stays clean in every single frame while the
    others are at their defaults, or at what was found for them: first the tolerance of depth, then the edge,
    the gradient and the contrast. Those that a clean surface says nothing about keep their defaults. Raises
    BadFrame, NoSurface, and NotClean.
    """
    camera = checked_camera(frames)
    default = Thresholds()
    plane = find_surface(frames[0], scene, default, rng)
    seen_as = geometry.view(camera, plane)
    extent = surface.extent_mask(seen_as, scene.surface)
    inner = surface.extent_mask(seen_as, scene.surface, RIM)
    view = _View(frames, plane, seen_as, extent, inner)
    found = replace(default, tolerance=_smallest("tolerance", default, lambda t: _is_flat(view, t)))
    generous = replace(found, gradient=MOST["gradient"], contrast=MOST["contrast"])
    edge = next((e for e in range(MOST_EDGE + 1) if _is_clean(view, replace(generous, surface_edge=e))), None)
    if edge is None:
        raise NotClean("something on it is seen as dirt whatever the thresholds: is it clean?")
    found = replace(found, surface_edge=edge)
    # At the default gradient the rim may need more pixels than at a generous one.
    while edge < default.surface_edge and not _is_clean(view, replace(found, surface_edge=edge)):
        edge += 1
    found = replace(found, surface_edge=edge, object_edge=max(default.object_edge, edge + 2))
    trusted = [_trusted(frame, view, found) for frame in frames]
    found = replace(found, gradient=_smallest("gradient", found, lambda t: _is_clean(view, t, trusted)))
    # Without the gradient's margin, or it would be the contrast's only one.
    barely = replace(found, gradient=found.gradient / MARGIN)
    found = replace(found, contrast=_smallest("contrast", barely, lambda t: _is_clean(view, t, trusted)))
    return Calibration(path, found, _appearance(view, scene, found))


def _smallest(name: str, others: Thresholds, is_clean: Callable[[Thresholds], bool]) -> float:
    """The smallest value of one threshold for which all is clean, with the margin."""
    low, high = LEAST[name], MOST[name]

    def suffices(value: float) -> bool:
        changed: dict[str, Any] = {name: value}
        return is_clean(replace(others, **changed))

    if not suffices(high):
        raise NotClean(f"the surface is not clean even with a {name} of {high:g}")
    if suffices(low):
        return low
    while high / low > FINE:
        middle = float(np.sqrt(low * high))
        if suffices(middle):
            high = middle
        else:
            low = middle
    return min(MOST[name], MARGIN * high)


def _is_flat(view: _View, thresholds: Thresholds) -> bool:
    """Whether every pixel within the rim whose depth is known lies on the plane, but for one in ten thousand:
    noise has no largest value."""
    for frame in view.frames:
        on_plane = surface.surface_mask(frame, view.seen_as, view.extent, thresholds)
        known = surface.known_depth(frame) & view.inner
        if (known & ~on_plane).sum() > 1e-4 * max(int(known.sum()), 1):
            return False
    return True


def _is_clean(view: _View, thresholds: Thresholds, trusted: Sequence[Mask] = ()) -> bool:
    """Whether no patch of dirt is seen in any frame; `trusted` are their masks, if they are known."""
    masks = trusted or (_trusted(frame, view, thresholds) for frame in view.frames)
    return not any(
        _dirty(frame, mask, view, thresholds) for frame, mask in zip(view.frames, masks, strict=True)
    )


def _trusted(frame: Frame, view: _View, thresholds: Thresholds) -> Mask:
    on_surface = surface.surface_mask(frame, view.seen_as, view.extent, thresholds)
    objects = surface.object_mask(frame, view.seen_as, thresholds)
    return surface.without_edges(on_surface, objects, thresholds)


def _dirty(frame: Frame, trusted: Mask, view: _View, thresholds: Thresholds) -> bool:
    subtraction = dirt.subtract_background(frame.colour, trusted, view.seen_as.pixel_areas, thresholds)
    filtered = dirt.without_specks(subtraction, thresholds)
    return bool(dirt.without_small_patches(filtered, view.seen_as.pixel_areas, thresholds).any())


def _appearance(view: _View, scene: Scene, thresholds: Thresholds) -> Appearance:
    frame = view.frames[0]
    on_surface = surface.surface_mask(frame, view.seen_as, view.extent, thresholds)
    trusted = surface.without_edges(on_surface, np.zeros_like(on_surface), thresholds)
    shown = dirt.subtract_background(frame.colour, trusted, view.seen_as.pixel_areas, thresholds).background
    colours = np.nan_to_num(fit.colours_of(frame.colour, shown, view.seen_as, scene.surface))
    triples = tuple((round(r, 1), round(g, 1), round(b, 1)) for r, g, b in colours.tolist())
    tilt = fit.tilt_of(view.plane, frame.camera.pose[:3, 2])
    return Appearance(fit.COLUMNS, fit.ROWS, triples, round(tilt, 4))
