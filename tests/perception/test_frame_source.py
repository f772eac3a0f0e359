"""Which pictures belong together and which frames are looked at, against what is obvious and slow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception.frame_source import (
    MOST_IN_ALL,
    FrameSource,
    looks,
    nearest_pairs,
    spread,
)

STAMPS = st.lists(st.integers(0, 200), max_size=12, unique=True)


@given(STAMPS, STAMPS, st.integers(0, 30))
def test_pairs_are_found_as_one_would_by_hand(colour: list[int], depth: list[int], limit: int) -> None:
    """Again and again the two that are nearest, of those that have no partner yet."""
    left, right, expected = list(enumerate(colour)), list(enumerate(depth)), list[tuple[int, int]]()
    while left and right:
        gap, one, other = min((abs(a - b), i, j) for i, a in left for j, b in right)
        if gap > limit:
            break
        expected.append((one, other))
        left = [each for each in left if each[0] != one]
        right = [each for each in right if each[0] != other]
    found = nearest_pairs(colour, depth, limit)
    gaps = [sorted(abs(colour[i] - depth[j]) for i, j in pairs) for pairs in (found, expected)]
    assert gaps[0] == gaps[1]
    assert [colour[one] for one, _ in found] == sorted(colour[one] for one, _ in found)


def _source(clocks: Sequence[float], pixels: int = 100, speed: float = 0.0) -> FrameSource:
    camera = Camera(2, 2, 1.0, (1.0, 1.0), np.eye(4))

    def take(numbers: Sequence[int]) -> Iterator[Frame]:
        assert list(numbers) == sorted(numbers)
        for number in numbers:
            pose = np.eye(4)
            pose[0, 3] = speed * clocks[number]
            yield Frame(
                np.zeros((2, 2, 3), np.uint8),
                np.zeros((2, 2), np.float32),
                replace(camera, pose=pose),
                clocks[number],
            )

    return FrameSource(Path("table"), tuple(clocks), pixels, take)


def test_a_look_is_taken_each_time_that_seconds_have_passed() -> None:
    clocks = [0.0, 0.1, 0.2, 0.3, 0.9, 1.2, 1.3, 5.0]
    seen = [[frame.clock for frame in look] for look in looks(_source(clocks), every=1.0)]
    assert seen == [[0.0, 0.1, 0.2], [1.2, 1.3], [5.0]]


def test_a_camera_that_trembles_stands_still_and_one_that_moves_ends_the_look() -> None:
    ((first, second, third),) = looks(_source([0.0, 0.1, 0.2], speed=0.004), every=1.0)
    assert first.camera is second.camera is third.camera
    assert [len(look) for look in looks(_source([0.0, 0.1, 0.2], speed=0.015), every=1.0)] == [1]


@pytest.mark.parametrize(
    ("count", "clocks"), [(1, [0.0]), (3, [0.0, 2.0, 4.0]), (9, [0.0, 1.0, 2.0, 3.0, 4.0])]
)
def test_frames_are_spread_over_a_recording(count: int, clocks: list[float]) -> None:
    assert [frame.clock for frame in spread(_source([0.0, 1.0, 2.0, 3.0, 4.0]), count)] == clocks


def test_no_more_frames_are_taken_than_memory_is_used_for() -> None:
    assert len(spread(_source([0.0, 1.0, 2.0], pixels=MOST_IN_ALL // 2), 3)) == 2
