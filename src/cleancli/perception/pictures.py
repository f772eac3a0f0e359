"""Pictures for people: areas drawn on what the camera saw, and the steps of perception (Fig. 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from textwrap import wrap

import cv2
import numpy as np

from cleancli.array_types import Depth, Image, Ints, Mask, Points
from cleancli.geometry.ellipse import Ellipse
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import State
from cleancli.perception import marks
from cleancli.perception.area import Area
from cleancli.perception.geometry import project
from cleancli.perception.labels import box_of, placed
from cleancli.perception.perceive import Observation

__all__ = [
    "boundary",
    "busy",
    "contact_sheet",
    "draw",
    "margins",
    "not_clean",
    "outline",
    "project",
    "with_doubts",
    "words",
]

_INK = (15, 15, 15)
_DOUBT = (200, 30, 40)
_PAPER = (255, 255, 255)
_REMOVED = (40, 44, 60)
_REACHED = (230, 30, 40)
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_FONT_SCALE = 0.38
_LINE = 13  # pixels from one line of a label to the next
_LETTER = 7  # pixels that a letter is wide
_CAPTION = 30  # height of a caption's strip in pixels


def draw(
    frame: Frame,
    areas: Sequence[Area],
    state: State = frozenset(),
    stroke: Points | None = None,
    dirt: Mask | None = None,
) -> Image:
    """The colour image with each area's ellipse, its name and what `state` says of it alone, and the way of
    the tool through `stroke` (n, 2); RGB. Names keep off what is drawn, and off `dirt` (height, width)."""
    picture = np.ascontiguousarray(frame.colour).copy()
    # A line beside the dirt, not on it.
    beside = marks.BESIDE * marks.scale_of(picture)
    outlines = [marks.grown(outline(area.ellipse, frame.camera), beside) for area in areas]
    way = None if stroke is None else project(frame.camera, stroke)
    for line in outlines:
        marks.line(picture, line, marks.ELLIPSE, closed=True)
    if way is not None:
        marks.arrow(picture, way, marks.STROKE)
    lines = [[area.name, *words(area.name, state)] for area in areas]
    sizes = [marks.size_of(each, marks.scale_of(picture)) for each in lines]
    around = [box_of(line[:, 0, :].astype(np.int64)) for line in outlines]
    boxes = placed(sizes, around, busy(picture.shape[:2], outlines, way, dirt))
    for box, named in zip(boxes, around, strict=True):
        marks.connect(picture, box, named, marks.ELLIPSE)
    for box, texts in zip(boxes, lines, strict=True):
        marks.label(picture, texts, box)
    return picture


def busy(size: tuple[int, ...], outlines: Sequence[Ints], way: Points | None, dirt: Mask | None) -> Mask:
    """Which pixels (height, width) no name should cover: ellipses, a way with its heads, and dirt."""
    drawn = np.zeros(size, np.uint8)
    for line in outlines:
        cv2.fillPoly(drawn, [line], 1)
        cv2.polylines(drawn, [line], True, 1, 4 * marks.WIDTH)
    if way is not None:
        cv2.polylines(drawn, [np.rint(way).astype(np.int32)[:, None, :]], False, 1, 2 * round(marks.HEAD))
    return np.asarray(drawn > 0 if dirt is None else (drawn > 0) | dirt)


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
        _captioned(
            draw(replace(frame, camera=observation.camera), areas, state, dirt=steps.believed),
            f"(f) ellipses: {counted}",
        ),
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
        cv2.putText(strip, line, (4, _LINE * number), _FONT, _FONT_SCALE, _DOUBT, 1, cv2.LINE_AA)
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
    return np.rint(project(camera, boundary(ellipse))).astype(np.int32)[:, None, :]


def boundary(ellipse: Ellipse) -> Points:
    """Points (n, 2) around the ellipse, metres."""
    turns = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    along, across = np.cos(ellipse.angle), np.sin(ellipse.angle)
    local = np.column_stack([ellipse.axes[0] * np.cos(turns), ellipse.axes[1] * np.sin(turns)])
    points: Points = local @ np.array([[along, across], [-across, along]]) + np.array(ellipse.centre)
    return points


def words(name: str, state: State) -> list[str]:
    """What the state says of one area alone, `dirt` aside: all that is drawn is dirty."""
    facts = sorted(fact for fact in state if fact.objects == (name,) and fact.symbol != "dirt")
    return [fact.symbol if fact.value is True else str(fact.value) for fact in facts]


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
