"""Pictures for people: areas drawn on what the camera saw, and the steps of perception (Fig. 2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from textwrap import wrap

import cv2
import numpy as np

from cleancli.array_types import Depth, Image, Ints, Mask
from cleancli.geometry.ellipse import Ellipse
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import State
from cleancli.perception.area import Area
from cleancli.perception.geometry import project
from cleancli.perception.perceive import Observation

__all__ = ["contact_sheet", "draw", "margins", "not_clean", "outline", "project", "with_doubts", "words"]

_Box = tuple[int, int, int, int]  # left, top, right, bottom

_INK = (15, 15, 15)
_ELLIPSE = (200, 30, 40)
_PAPER = (255, 255, 255)
_REMOVED = (40, 44, 60)
_REACHED = (230, 30, 40)
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_FONT_SCALE = 0.38
_LINE = 13  # pixels from one line of a label to the next
_LETTER = 7  # pixels that a letter is wide
_CAPTION = 30  # height of a caption's strip in pixels


def draw(frame: Frame, areas: Sequence[Area], state: State = frozenset()) -> Image:
    """The colour image with each area's ellipse, its name and what `state` says of it alone; RGB."""
    picture = np.ascontiguousarray(frame.colour).copy()
    outlines = [outline(area.ellipse, frame.camera) for area in areas]
    # Labels keep off the ellipses as well as off each other.
    taken = [_box_of(line) for line in outlines]
    for line in outlines:
        cv2.polylines(picture, [line], True, _ELLIPSE, 1, cv2.LINE_AA)
    for area, line in zip(areas, outlines, strict=True):
        lines = [area.name, *words(area.name, state)]
        around = _box_of(line)
        box = _free_place(around, lines, taken, picture.shape[:2])
        taken.append(box)
        _connect(picture, box, around)
        _write(picture, lines, box)
    return picture


def contact_sheet(
    frame: Frame, observation: Observation, areas: Sequence[Area], state: State = frozenset()
) -> Image:
    """What each step of perception left of `frame`, captioned as in Fig. 2, two rows of three; RGB."""
    steps = observation.steps
    counted = plural(len(areas), "area")
    tiles = [
        _captioned(frame.colour, "(a) colour image"),
        _captioned(_cut_out(frame, steps.surface), "(b) surface segmented by depth"),
        _captioned(_cut_out(frame, steps.without_edges), "(c) edges removed"),
        _captioned(_marked(steps.dirty, steps.without_edges), "(d) background subtracted"),
        _captioned(_marked(steps.believed, steps.without_edges), "(e) noise removed"),
        _captioned(draw(replace(frame, camera=observation.camera), areas, state), f"(f) ellipses: {counted}"),
    ]
    return with_doubts(np.vstack([np.hstack(tiles[:3]), np.hstack(tiles[3:])]), observation.doubts)


def with_doubts(picture: Image, doubts: Sequence[str]) -> Image:
    """The picture, and below it a line for each doubt, broken where it is longer than the picture is wide."""
    letters = max(20, picture.shape[1] // _LETTER)
    lines = [line for doubt in doubts for line in wrap(f"doubt: {doubt}", letters)]
    if not lines:
        return picture
    strip = np.full((_LINE * len(lines) + 8, picture.shape[1], 3), 255, np.uint8)
    for number, line in enumerate(lines, start=1):
        cv2.putText(strip, line, (4, _LINE * number), _FONT, _FONT_SCALE, _ELLIPSE, 1, cv2.LINE_AA)
    return np.vstack([picture, strip])


def margins(frame: Frame, steepness: Depth) -> Image:
    """How near each pixel of a clean surface comes to the threshold of the gradient; RGB.

    `steepness` (height, width): 1 at the threshold, NaN where the surface was not judged. From dark blue far
    below the threshold over green to yellow at it; red where it is reached.
    """
    judged = np.isfinite(steepness)
    scaled = np.where(judged, np.clip(steepness, 0, 1) * 255, 0).astype(np.uint8)
    coloured = cv2.cvtColor(cv2.applyColorMap(scaled, cv2.COLORMAP_VIRIDIS), cv2.COLOR_BGR2RGB)
    picture = np.where(judged[:, :, None], coloured, frame.colour // 3).astype(np.uint8)
    picture[judged & (steepness >= 1)] = _REACHED
    known = steepness[judged]
    share = float((known < 1).mean()) if len(known) else 0.0
    middle = float(np.median(known)) if len(known) else 0.0
    caption = f"change of colour: {share:.2%} below the threshold, the median at {middle:.0%} of it"
    return _captioned(picture, caption)


def not_clean(frame: Frame, where: Mask, reason: str) -> Image:
    """The frame with what keeps its surface from being clean in red, and the reason below; RGB."""
    picture = np.ascontiguousarray(frame.colour).copy()
    around = cv2.dilate(where.view(np.uint8), np.ones((9, 9), np.uint8))
    lines, _ = cv2.findContours(around, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    picture[where] = _REACHED
    cv2.drawContours(picture, lines, -1, _REACHED, 1)
    return with_doubts(picture, [reason])


def outline(ellipse: Ellipse, camera: Camera) -> Ints:
    """The ellipse's boundary in pixels, (n, 1, 2) as OpenCV takes it."""
    turns = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    along, across = np.cos(ellipse.angle), np.sin(ellipse.angle)
    local = np.column_stack([ellipse.axes[0] * np.cos(turns), ellipse.axes[1] * np.sin(turns)])
    points = local @ np.array([[along, across], [-across, along]]) + np.array(ellipse.centre)
    return np.rint(project(camera, points)).astype(np.int32)[:, None, :]


def words(name: str, state: State) -> list[str]:
    """What the state says of one area alone, `dirt` aside: all that is drawn is dirty."""
    facts = sorted(fact for fact in state if fact.objects == (name,) and fact.symbol != "dirt")
    return [fact.symbol if fact.value is True else str(fact.value) for fact in facts]


def _box_of(outline: Ints) -> _Box:
    (left, top), (right, bottom) = outline.min(axis=(0, 1)).tolist(), outline.max(axis=(0, 1)).tolist()
    return left, top, right, bottom


def _free_place(around: _Box, lines: Sequence[str], taken: Sequence[_Box], size: tuple[int, ...]) -> _Box:
    """Where a label of these lines beside the box `around` covers least of what is drawn already."""
    width = max(cv2.getTextSize(line, _FONT, _FONT_SCALE, 1)[0][0] for line in lines) + 4
    height = _LINE * len(lines) + 2
    return min(_places(around, width, height, size), key=lambda place: sum(_overlap(place, t) for t in taken))


def _places(around: _Box, width: int, height: int, size: tuple[int, ...]) -> Iterator[_Box]:
    """Places of a label around a box, the nearest first, moved into the picture where they stick out."""
    left, top, right, bottom = around
    middle_x, middle_y = (left + right - width) // 2, (top + bottom - height) // 2
    for away in (2, 8, 16, 26):
        west, east = left - width - away, right + away
        north, south = top - height - away, bottom + away
        for x, y in (
            *((east, middle_y), (middle_x, north), (west, middle_y), (middle_x, south)),
            *((east, north), (east, south), (west, north), (west, south)),
        ):
            x, y = min(max(x, 0), size[1] - width), min(max(y, 0), size[0] - height)
            yield x, y, x + width, y + height


def _overlap(first: _Box, second: _Box) -> int:
    wide = min(first[2], second[2]) - max(first[0], second[0])
    high = min(first[3], second[3]) - max(first[1], second[1])
    return max(wide, 0) * max(high, 0)


def _connect(picture: Image, label: _Box, ellipse: _Box) -> None:
    """The shortest line between a label and the box of its ellipse."""
    x, y = (ellipse[0] + ellipse[2]) // 2, (ellipse[1] + ellipse[3]) // 2
    end = min(max(x, label[0]), label[2]), min(max(y, label[1]), label[3])
    start = min(max(end[0], ellipse[0]), ellipse[2]), min(max(end[1], ellipse[1]), ellipse[3])
    cv2.line(picture, start, end, _ELLIPSE, 1, cv2.LINE_AA)


def _write(picture: Image, lines: Sequence[str], box: _Box) -> None:
    left, top, right, bottom = box
    ground = picture[top:bottom, left:right]
    # Half-transparent paper: text stays readable on dark dirt, and the dirt visible below.
    ground[:] = (ground // 3 + np.uint8(170)).astype(np.uint8)
    for number, line in enumerate(lines, start=1):
        place = (left + 2, top + _LINE * number - 2)
        cv2.putText(picture, line, place, _FONT, _FONT_SCALE, _INK, 1, cv2.LINE_AA)


def _cut_out(frame: Frame, mask: Mask) -> Image:
    """The colour image where the mask holds, a dark ground elsewhere."""
    return np.where(mask[:, :, None], frame.colour, np.array(_REMOVED, np.uint8))


def _marked(dirt: Mask, seen: Mask) -> Image:
    """White dirt on a grey surface, a dark ground where nothing is seen."""
    picture = np.empty((*dirt.shape, 3), np.uint8)
    picture[:] = _REMOVED
    picture[seen] = (110, 112, 120)
    picture[dirt] = _PAPER
    return picture


def _captioned(picture: Image, caption: str) -> Image:
    strip = np.full((_CAPTION, picture.shape[1], 3), 255, np.uint8)
    cv2.putText(strip, caption, (8, 20), _FONT, 0.55, _INK, 1, cv2.LINE_AA)
    return np.vstack([strip, picture])
