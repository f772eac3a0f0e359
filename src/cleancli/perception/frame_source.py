"""Frames as they come from a recording: pairs of colour and depth, and which of them are looked at.

Bags and folders in the TUM layout are sources; each knows the clocks of all its pairs, and reads pictures
when they are asked for, so that a recording may be larger than memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice, takewhile
from pathlib import Path

import numpy as np

from cleancli.array_types import Floats
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception.look import FRAMES_PER_LOOK

STILL = 0.001
"""Metres by which the camera may have moved between frames of one look, and a thousandth of which it may have
turned, in radians."""
NEIGHBOURS = 4
"""Pictures of depth on either side of one of colour that may be its partner."""
FEW = 100
"""Pictures of colour among which the nearest one is looked for, for a message."""
MOST_PIXELS = 3840 * 2160
MOST_IN_ALL = 32 << 20
"""Pixels of a frame and of all frames of a look, for which perception takes some 0.9 GB of memory."""


class BadRecording(OSError):
    """A recording that holds no readable frames; the message names the file and what is wrong."""


@dataclass(frozen=True, slots=True)
class FrameSource:
    """Pairs of colour and depth in the order of their `clocks` (seconds); `take` reads those with some
    numbers, in rising order, and raises OSError. A frame has so many `pixels`; `notes` say what of the
    recording is left out."""

    path: Path
    clocks: tuple[float, ...]
    pixels: int
    take: Callable[[Sequence[int]], Iterator[Frame]]
    notes: tuple[str, ...] = ()


def looks(source: FrameSource, every: float) -> Iterator[tuple[Frame, ...]]:
    """A look each time that `every` seconds have passed: frames that follow each other, as many as a look
    has, and fewer where the camera moves. Raises OSError."""
    starts = _starts(source.clocks, every)
    ends = [*starts[1:], len(source.clocks)]
    groups = [
        range(start, min(start + FRAMES_PER_LOOK, end)) for start, end in zip(starts, ends, strict=True)
    ]
    frames = source.take([number for group in groups for number in group])
    for group in groups:
        yield _from_one_place(tuple(islice(frames, len(group))))


def spread(source: FrameSource, count: int) -> tuple[Frame, ...]:
    """At most `count` frames, and no more than memory is used for, spread evenly over the recording. Raises
    OSError."""
    most = min(count, len(source.clocks), MOST_IN_ALL // source.pixels)
    chosen = np.linspace(0, len(source.clocks) - 1, most)
    frames = tuple(source.take([int(number) for number in np.rint(chosen)]))
    first = frames[0].camera
    return tuple(replace(each, camera=first) if _is_still(first, each.camera) else each for each in frames)


def nearest_pairs(
    colour: Sequence[float], depth: Sequence[float], max_difference: float
) -> list[tuple[int, int]]:
    """Numbers of pictures whose stamps (seconds, in any order) differ by at most `max_difference`: the
    nearest two are a pair first, and each picture is in one pair. In the order of the colour's stamps."""
    order = np.argsort(np.asarray(depth, dtype=np.float64), kind="stable")
    sorted_depth = np.asarray(depth, dtype=np.float64)[order]
    near: list[tuple[float, int, int]] = []
    for number, stamp in enumerate(colour):
        first = int(np.searchsorted(sorted_depth, stamp - max_difference, side="left"))
        last = int(np.searchsorted(sorted_depth, stamp + max_difference, side="right"))
        middle = int(np.searchsorted(sorted_depth, stamp))
        # Of many within the limit, those nearest on either side are enough.
        within = range(max(first, middle - NEIGHBOURS), min(last, middle + NEIGHBOURS))
        near += [(abs(sorted_depth[at] - stamp), number, int(order[at])) for at in within]
    used_colour, used_depth, pairs = set[int](), set[int](), list[tuple[int, int]]()
    for _, one, other in sorted(near):
        if one not in used_colour and other not in used_depth:
            used_colour.add(one)
            used_depth.add(other)
            pairs.append((one, other))
    return sorted(pairs, key=lambda pair: colour[pair[0]])


def _starts(clocks: Sequence[float], every: float) -> list[int]:
    starts = [0] if clocks else []
    for number, clock in enumerate(clocks):
        if clock >= clocks[starts[-1]] + every:
            starts.append(number)
    return starts


def _from_one_place(frames: tuple[Frame, ...]) -> tuple[Frame, ...]:
    """The first frames, up to where the camera has moved; a trembling pose is taken for the first one."""
    first = frames[0].camera
    still = takewhile(lambda frame: _is_still(first, frame.camera), frames)
    return tuple(replace(frame, camera=first) for frame in still)


def _is_still(first: Camera, other: Camera) -> bool:
    moved: Floats = np.abs(other.pose - first.pose)
    is_same = replace(first, pose=other.pose) == other
    return is_same and bool(moved[:3, 3].max() <= STILL and moved[:3, :3].max() <= STILL)


def unpaired(
    path: Path, colour: Sequence[float], depth: Sequence[float], pairs: int, max_difference: float
) -> tuple[str, ...]:
    """What is to be said of pictures of colour without a partner. Raises BadRecording where all are."""
    limit = f"no depth within {max_difference:g} s"
    if not pairs:
        others = np.asarray(depth, dtype=np.float64)
        apart = min(float(np.abs(others - stamp).min()) for stamp in colour[:FEW])
        raise BadRecording(
            f"{path}: {limit} of any colour picture; the nearest is {apart:.3g} s off: `--max-difference`"
        )
    missing = len(colour) - pairs
    return (f"{path}: {missing} of {len(colour)} colour pictures have {limit}",) if missing else ()
