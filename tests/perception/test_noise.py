"""Noise at its limits: patches of just the least area, pixels that some frames show, depth from afar."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cleancli.geometry.rgbd import Frame
from cleancli.perception.dirt import believed, without_small_patches
from cleancli.perception.geometry import Plane, view
from cleancli.perception.surface import heights, object_mask
from cleancli.scene.calibration import Thresholds
from support import synthetic

QUARTER = 0.25
"""Of a unit of area: a power of two, so that sums are exact."""


def patches(*sizes: int) -> tuple[np.ndarray, np.ndarray]:
    """A mask with patches of so many pixels each, and the areas of its pixels."""
    mask = np.zeros((2 * len(sizes) + 1, max(sizes) + 2), np.bool_)
    for row, size in enumerate(sizes):
        mask[2 * row + 1, 1 : 1 + size] = True
    return mask, np.full(mask.shape, QUARTER)


@pytest.mark.parametrize(("patch", "kept"), [(1.0, 4), (0.99, 4), (1.01, 5), (0.25, 1), (0.26, 2), (9.0, 9)])
def test_patches_below_the_threshold_go_and_others_stay_whole(patch: float, kept: int) -> None:
    mask, areas = patches(1, 2, 3, 4, 5)
    left = without_small_patches(mask, areas, replace(Thresholds(), patch=patch))
    sizes = [size for size in range(1, 6) if size >= kept]
    assert [int(row.sum()) for row in left[1::2] if row.any()] == sizes
    assert not (left & ~mask).any()


def test_pixels_that_touch_at_a_corner_are_one_patch() -> None:
    mask, areas = np.eye(4, dtype=np.bool_), np.full((4, 4), QUARTER)
    assert (without_small_patches(mask, areas, replace(Thresholds(), patch=1.0)) == mask).all()
    assert not without_small_patches(mask, areas, replace(Thresholds(), patch=1.25)).any()


@pytest.mark.parametrize(
    ("agreement", "dirty", "shown", "frames", "is_dirt", "is_seen"),
    [
        (2 / 3, 2, 3, 3, True, True),
        (2 / 3, 1, 3, 3, False, True),
        (2 / 3, 2, 2, 3, True, True),
        (2 / 3, 1, 2, 3, False, True),
        (2 / 3, 1, 1, 3, False, False),
        (0.5, 1, 2, 4, True, True),
        (0.5, 1, 1, 4, False, False),
        (0.5, 1, 1, 2, True, True),
        (0.5, 0, 2, 2, False, True),
        (0.0, 0, 3, 3, False, True),
        (0.0, 1, 3, 3, True, True),
        (1.0, 3, 3, 3, True, True),
        (1.0, 2, 3, 3, False, True),
        (2 / 3, 1, 1, 1, True, True),
        (2 / 3, 0, 0, 1, False, False),
    ],
)
def test_a_pixel_is_dirty_in_its_share_of_the_frames_that_show_it(
    agreement: float, dirty: int, shown: int, frames: int, is_dirt: bool, is_seen: bool
) -> None:
    dirty_masks = [np.full((1, 1), number < dirty) for number in range(frames)]
    seen_masks = [np.full((1, 1), number < shown) for number in range(frames)]
    dirt, seen = believed(dirty_masks, seen_masks, replace(Thresholds(), agreement=agreement))
    assert (bool(dirt[0, 0]), bool(seen[0, 0])) == (is_dirt, is_seen)


@pytest.mark.parametrize(("distance", "is_object"), [(0.9, True), (2.0, False)])
def test_what_stands_out_of_the_noise_nearby_is_none_from_afar(distance: float, is_object: bool) -> None:
    """docs/perception.md: `tolerance` grows with the square of the distance, as the error of depth does."""
    camera = replace(synthetic.camera(), pose=np.diag([1.0, -1.0, -1.0, 1.0]))
    camera.pose[2, 3] = distance
    up, east = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    seen_as = view(camera, Plane.below(camera.pose[:3, 3], up, 0.0, east))
    depth = np.full((camera.height, camera.width), distance, np.float32)
    depth[200:240, 300:340] -= 0.025
    frame = Frame(np.zeros((*depth.shape, 3), np.uint8), depth, camera, 0.0)
    assert object_mask(heights(frame, seen_as, Thresholds()), Thresholds()).any() == is_object
