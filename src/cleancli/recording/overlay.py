"""Maps of the surface: where particles lay before and after an action, and what a robot reaches."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

import cv2
import numpy as np

from cleancli.array_types import Bools, Image, Points
from cleancli.execution.trials import Trial
from cleancli.motion.zone import corners as corners_of
from cleancli.scene.model import Scene

SCALE = 800  # pixels per metre
BORDER = 30  # pixels around the surface
BAR = 0.10
"""Metres of the scale bar."""

ROW, SWATCH, GAP = 26, 30, 18  # of the legend: height of a row, width of a sign, and between entries, pixels
REACHED, UNREACHED = (150, 205, 150), (235, 150, 140)
ZONE = (60, 170, 90)
BEFORE, AFTER = (70, 110, 200), (200, 60, 50)
WAY, MOUTH, BLACK = (110, 104, 118), (62, 96, 150), (20, 20, 20)
_FONT = cv2.FONT_HERSHEY_SIMPLEX

Pixel = tuple[int, int]
Sign = Callable[[Image, Pixel, Pixel], None]
"""Draws what a legend explains into a picture, between the left and the right end of its swatch."""


def overlay(scene: Scene, panels: Sequence[tuple[str, Sequence[Trial]]]) -> Image:
    """One map of the surface for each titled list of trials, side by side, with a legend below; RGB.

    Blue rings are where particles lay before, red dots where those that stayed on the table lay after, and
    arrows where the tool was on the surface.
    """
    return np.hstack([_panel(scene, title, trials) for title, trials in panels])


def reach_map(scene: Scene, places: Points, reached: Bools) -> Image:
    """The surface with every place (n, 2) green where the robot reaches it, (n,), and red elsewhere; RGB."""
    picture = _surface(scene)
    for place, is_reached in zip(_pixels(places, scene), reached, strict=True):
        cv2.circle(picture, place, 5, REACHED if is_reached else UNREACHED, -1, cv2.LINE_AA)
    return _titled(picture, f"{scene.robot} reaches {reached.mean():.0%} of the surface")


def entries(scene: Scene) -> tuple[tuple[Sign, str], ...]:
    """What the legend of a map explains: a sign and its text for each kind of thing that is drawn."""
    zone = () if scene.zone is None else ((_line(ZONE, 1), "zone"),)
    return (
        (_middle(_before), "before"),
        (_middle(_after), "after, still on the table"),
        (_way_of, "the tool on the surface"),
        (_line(MOUTH, 5), "container"),
        *zone,
        (_bar, f"{BAR * 100:.0f} cm"),
    )


def legend(scene: Scene, width: int) -> Image:
    """The entries in rows that are at most so many pixels wide."""
    rows: list[list[tuple[Sign, str, int]]] = [[]]
    left = BORDER
    for sign, text in entries(scene):
        wide = _swatch(sign) + GAP // 2 + cv2.getTextSize(text, _FONT, 0.45, 1)[0][0] + GAP
        if left + wide > width and rows[-1]:
            rows.append([])
            left = BORDER
        rows[-1].append((sign, text, left))
        left += wide
    picture = np.full((ROW * len(rows) + BORDER // 2, width, 3), 255, np.uint8)
    for number, row in enumerate(rows):
        middle = ROW * number + ROW // 2
        for sign, text, begin in row:
            end = begin + _swatch(sign)
            sign(picture, (begin, middle), (end, middle))
            place = end + GAP // 2, middle + 5
            cv2.putText(picture, text, place, _FONT, 0.45, BLACK, 1, cv2.LINE_AA)
    return picture


def _panel(scene: Scene, title: str, trials: Sequence[Trial]) -> Image:
    picture = _surface(scene)
    for trial in trials:
        for begin, end in pairwise(_pixels(trial.stroke, scene)):
            _way_of(picture, begin, end)
    for trial in trials:
        _each(_before, picture, _pixels(trial.before, scene))
    for trial in trials:
        _each(_after, picture, _pixels(trial.after, scene))
    return np.vstack([_titled(picture, title), legend(scene, picture.shape[1])])


def _surface(scene: Scene) -> Image:
    """The outline of the surface, the mouth of the container, and the zone, if there is one."""
    size = np.array((scene.surface.width, scene.surface.depth))
    wide, high = (np.ceil(size * SCALE).astype(int) + 2 * BORDER).tolist()
    picture = np.full((high, wide, 3), 255, np.uint8)
    corners = _pixels(np.array([-size, size]) / 2, scene)
    cv2.rectangle(picture, corners[0], corners[1], (120, 120, 120), 1)
    mouth = _pixels(np.array(scene.mouth()), scene)
    cv2.line(picture, mouth[0], mouth[1], MOUTH, 5)
    if scene.zone is not None:
        cv2.polylines(picture, [np.array(_pixels(corners_of(scene.zone), scene))], True, ZONE, 1, cv2.LINE_AA)
    return picture


def _titled(picture: Image, title: str) -> Image:
    cv2.putText(picture, title, (BORDER, BORDER - 10), _FONT, 0.5, BLACK, 1, cv2.LINE_AA)
    return picture


def _each(mark: Callable[[Image, Pixel], None], picture: Image, places: Iterable[Pixel]) -> None:
    for place in places:
        mark(picture, place)


def _before(picture: Image, place: Pixel) -> None:
    cv2.circle(picture, place, 3, BEFORE, 1, cv2.LINE_AA)


def _after(picture: Image, place: Pixel) -> None:
    cv2.circle(picture, place, 2, AFTER, -1, cv2.LINE_AA)


def _way_of(picture: Image, begin: Pixel, end: Pixel) -> None:
    """A piece of a way; the head is as long on long pieces as on short ones."""
    tip = 8 / max(8.0, float(np.hypot(end[0] - begin[0], end[1] - begin[1])))
    cv2.arrowedLine(picture, begin, end, WAY, 1, cv2.LINE_AA, tipLength=tip)


def _middle(mark: Callable[[Image, Pixel], None]) -> Sign:
    return lambda picture, begin, end: mark(picture, ((begin[0] + end[0]) // 2, begin[1]))


def _line(colour: tuple[int, int, int], width: int) -> Sign:
    def draw(picture: Image, begin: Pixel, end: Pixel) -> None:
        cv2.line(picture, begin, end, colour, width, cv2.LINE_AA)

    return draw


def _bar(picture: Image, begin: Pixel, end: Pixel) -> None:
    """The scale: as long as so many metres are on the map."""
    cv2.line(picture, begin, end, BLACK, 2)
    for x, y in (begin, end):
        cv2.line(picture, (x, y - 5), (x, y + 5), BLACK, 2)


def _swatch(sign: Sign) -> int:
    """How wide a sign of the legend is, pixels."""
    return round(BAR * SCALE) if sign is _bar else SWATCH


def _pixels(points: Points, scene: Scene) -> list[Pixel]:
    """Scene points (n, 2) in the picture; north is up."""
    corner = np.array((-scene.surface.width / 2, scene.surface.depth / 2))
    placed = (points - corner) * (SCALE, -SCALE) + BORDER
    return [(int(x), int(y)) for x, y in np.rint(placed)]
