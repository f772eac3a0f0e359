"""Maps of the surface: where particles lay before and after an action, and what a robot reaches."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from cleancli.array_types import Bools, Image, Points
from cleancli.execution.trials import Trial
from cleancli.motion.zone import corners as corners_of
from cleancli.scene.model import Scene

SCALE = 800  # pixels per metre
BORDER = 30  # pixels around the surface
REACHED, UNREACHED = (150, 205, 150), (235, 150, 140)
ZONE = (60, 170, 90)
BEFORE, AFTER = (70, 110, 200), (200, 60, 50)
_FONT = cv2.FONT_HERSHEY_SIMPLEX


def overlay(scene: Scene, panels: Sequence[tuple[str, Sequence[Trial]]]) -> Image:
    """One map of the surface for each titled list of trials, side by side; RGB.

    Blue rings are where particles lay before, red dots where those that stayed on the table lay after.
    """
    return np.hstack([_panel(scene, title, trials) for title, trials in panels])


def reach_map(scene: Scene, places: Points, reached: Bools) -> Image:
    """The surface with every place (n, 2) green where the robot reaches it, (n,), and red elsewhere; RGB."""
    picture = _surface(scene)
    for place, is_reached in zip(_pixels(places, scene), reached, strict=True):
        cv2.circle(picture, place, 5, REACHED if is_reached else UNREACHED, -1, cv2.LINE_AA)
    return _titled(picture, f"{scene.robot} reaches {reached.mean():.0%} of the surface")


def _panel(scene: Scene, title: str, trials: Sequence[Trial]) -> Image:
    picture = _surface(scene)
    for trial in trials:
        for place in _pixels(trial.before, scene):
            cv2.circle(picture, place, 3, BEFORE, 1, cv2.LINE_AA)
    for trial in trials:
        for place in _pixels(trial.after, scene):
            cv2.circle(picture, place, 2, AFTER, -1, cv2.LINE_AA)
    return _titled(picture, title)


def _surface(scene: Scene) -> Image:
    """The outline of the surface, the mouth of the container, and the zone, if there is one."""
    size = np.array((scene.surface.width, scene.surface.depth))
    wide, high = (np.ceil(size * SCALE).astype(int) + 2 * BORDER).tolist()
    picture = np.full((high, wide, 3), 255, np.uint8)
    corners = _pixels(np.array([-size, size]) / 2, scene)
    cv2.rectangle(picture, corners[0], corners[1], (120, 120, 120), 1)
    mouth = _pixels(np.array(scene.mouth()), scene)
    cv2.line(picture, mouth[0], mouth[1], (62, 96, 150), 5)
    if scene.zone is not None:
        cv2.polylines(picture, [np.array(_pixels(corners_of(scene.zone), scene))], True, ZONE, 1, cv2.LINE_AA)
    return picture


def _titled(picture: Image, title: str) -> Image:
    cv2.putText(picture, title, (BORDER, BORDER - 10), _FONT, 0.5, (20, 20, 20), 1, cv2.LINE_AA)
    return picture


def _pixels(points: Points, scene: Scene) -> list[tuple[int, int]]:
    """Scene points (n, 2) in the picture; north is up."""
    corner = np.array((-scene.surface.width / 2, scene.surface.depth / 2))
    placed = (points - corner) * (SCALE, -SCALE) + BORDER
    return [(int(x), int(y)) for x, y in np.rint(placed)]
