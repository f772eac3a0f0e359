"""What an observation does not show because the arm hides it, and what to believe of it (§4.2.3).

`remember(before, observation, surface, stroke, next_number) -> Known` takes the place of `track`
where the tool may be in view: it names the areas seen, keeps those that are hidden as they were believed, and
says which part of the surface nothing is known about. It is pure, and quick beside `perceive`:

    observation = perceive(frames, scene, rng)
    known = remember(areas_before, observation, scene.surface, stroke, next_number)
    known.areas         # named, from west to east: seen and remembered alike
    known.hidden["a3"]  # 0: seen whole; 1: only remembered; between: seen in part
    known.unseen.share, known.unseen.outlines(), known.unseen.share_of(ellipse)
    known.changes       # "a3 split into a3, a9", "a2 merged into a5"
    known.next_number   # what to hand in with the next observation

With nothing in front of the surface it gives what `track` gives.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil

import cv2
import numpy as np

from cleancli.array_types import Mask, Points
from cleancli.geometry.ellipse import Ellipse, boundary, contains, points_within
from cleancli.perception.area import Area
from cleancli.perception.areas import enclosing_ellipses
from cleancli.perception.geometry import project
from cleancli.perception.perceive import RIM, Observation
from cleancli.perception.tracking import AreaChange, Stroke, track
from cleancli.scene.model import Surface

CELL = 0.005
"""Metres: width of the cells that are told apart as seen or unseen; three pixels at 0.9 m."""

HARDLY = 0.1
"""Share of an area up to which being hidden does not count: the edge of what hides it jitters."""

MOSTLY = 0.5
"""Share of an area from which it is believed though nothing is seen of it."""

PIECE = 0.25
"""Share of what is seen that lies in a partly hidden area's ellipse, from which it is a part of that area."""

INSIDE = 0.75
"""Share of such a part that lies in the ellipse, from which it says nothing new."""


@dataclass(frozen=True, slots=True)
class Unseen:
    """Which part of the surface an observation tells nothing about.

    `cells` (rows, columns) of about `CELL` metres a side are True where nothing is known; row 0 lies in the
    south, column 0 in the west. They cover the surface but for its rim, from corner `low` to `high`, (x, y).
    """

    cells: Mask
    low: tuple[float, float]
    high: tuple[float, float]

    @property
    def share(self) -> float:
        """The share of the surface that is unseen."""
        return float(self.cells.mean())

    def at(self, points: Points) -> Mask:
        """Whether the surface is unseen at points (n, 2) in metres; on the rim, as at the nearest cell."""
        rows, columns = self.cells.shape
        inside = (points - self.low) / np.subtract(self.high, self.low)
        column = np.clip((inside[:, 0] * columns).astype(int), 0, columns - 1)
        row = np.clip((inside[:, 1] * rows).astype(int), 0, rows - 1)
        return np.asarray(self.cells[row, column])

    def share_of(self, ellipse: Ellipse) -> float:
        """The share of an ellipse that is unseen."""
        return float(self.at(points_within(ellipse)).mean())

    def outlines(self) -> tuple[tuple[tuple[float, float], ...], ...]:
        """The unseen part as polygons of corners (x, y) in metres, the largest first; holes are left out."""
        # Twice as fine, so that contours, which run through the middles of cells, come near their borders.
        fine = np.repeat(np.repeat(self.cells, 2, axis=0), 2, axis=1).view(np.uint8)
        contours, _ = cv2.findContours(fine, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        size = np.subtract(self.high, self.low) / fine.shape[::-1]
        return tuple(
            tuple((float(x), float(y)) for x, y in (contour[:, 0, :] + 0.5) * size + self.low)
            for contour in sorted(contours, key=cv2.contourArea, reverse=True)
        )


@dataclass(frozen=True, slots=True)
class Known:
    """What is known of the surface from an observation and from what was known before it.

    `areas` are named, from west to east. `hidden`: by name, the share of the area that is only remembered,
    from 0 (seen whole) to 1 (not seen at all). `changes`: which areas split or merged. The next new name is
    `a<next_number>`.
    """

    areas: tuple[Area, ...]
    hidden: Mapping[str, float]
    unseen: Unseen
    changes: tuple[AreaChange, ...]
    next_number: int


def remember(
    before: Sequence[Area],
    observation: Observation,
    surface: Surface,
    stroke: Stroke | None,
    next_number: int,
) -> Known:
    """Name what is seen as what has become of the named areas of `before`, and keep what is hidden.

    - An area of which at most the share `HARDLY` is hidden is in plain view: if it is not seen, it is gone.
    - One that is seen in part stays as it was believed if what is seen lies in its ellipse, and is at least
      half as much as that should hold. If not, it becomes one ellipse around what is seen and what is hidden.
    - One of which nothing is seen stays as it was believed if the share `MOSTLY` or more is hidden. If less
      is, its larger part is clean in plain view, and it is gone.
    - One that `stroke` was to push away, and went over, is not where it was: it is only what is seen of it.

    New names begin with `a<next_number>`.
    """
    unseen = find_unseen(observation, surface)
    covered = {area.name: unseen.share_of(area.ellipse) for area in before}
    behind = [area for area in before if covered[area.name] > HARDLY and not _left(area, stroke)]
    pieces = _pieces(behind, observation.areas)
    kept = _kept(behind, pieces, unseen, covered)
    taken = [piece for several in pieces.values() for piece in several]
    rest = [area for area in observation.areas if area not in taken]
    tracked = track([area for area in before if area.name not in kept], rest, stroke, next_number)
    found = [*kept.values(), *((area, 0.0) for area in tracked.areas)]
    found.sort(key=lambda known: known[0].ellipse.centre)
    areas = tuple(area for area, _ in found)
    hidden = {area.name: share for area, share in found}
    return Known(areas, hidden, unseen, tracked.changes, tracked.next_number)


def _kept(
    behind: Sequence[Area],
    pieces: Mapping[str, Sequence[Area]],
    unseen: Unseen,
    covered: Mapping[str, float],
) -> dict[str, tuple[Area, float]]:
    """By name, those of the areas with a hidden part that are still believed to be there."""
    beliefs = {a.name: _believed(a, pieces[a.name], unseen, covered[a.name]) for a in behind}
    return {name: belief for name, belief in beliefs.items() if belief is not None}


def _believed(area: Area, seen: Sequence[Area], unseen: Unseen, hidden: float) -> tuple[Area, float] | None:
    """What is believed of an area of which the share `hidden` is hidden, and what share of that is only
    remembered; None where it is gone. `seen`: what is seen of it."""
    if seen:
        return _completed(area, seen, unseen, hidden), hidden
    return (area, 1.0) if hidden >= MOSTLY else None


def find_unseen(observation: Observation, surface: Surface) -> Unseen:
    """The part of the surface that is hidden or lies outside the image."""
    high = surface.width / 2 - RIM, surface.depth / 2 - RIM
    columns, rows = (max(1, ceil(2 * side / CELL)) for side in high)
    x = (np.arange(columns) + 0.5) / columns * 2 * high[0] - high[0]
    y = (np.arange(rows) + 0.5) / rows * 2 * high[1] - high[1]
    middles = np.column_stack([grid.ravel() for grid in np.meshgrid(x, y)])
    camera = observation.camera
    pixels = np.rint(project(camera, middles)).astype(int)
    column, row = pixels.T
    shown = (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
    cells = np.ones(len(middles), np.bool_)
    cells[shown] = observation.hidden_mask[row[shown], column[shown]]
    return Unseen(cells.reshape(rows, columns), (-high[0], -high[1]), high)


def _left(area: Area, stroke: Stroke | None) -> bool:
    """Whether the area was to be pushed away, and the cloth went over its centre."""
    if stroke is None or area.name not in stroke.moved:
        return False
    return bool(stroke.swept(np.array([area.ellipse.centre]))[0])


def _pieces(behind: Sequence[Area], seen: Sequence[Area]) -> dict[str, list[Area]]:
    """For each area with a hidden part, the areas seen of which `PIECE` or more lies in its ellipse; where
    several ellipses hold so much of one, it goes to that which holds most."""
    pieces: dict[str, list[Area]] = {area.name: [] for area in behind}
    for piece in seen:
        shares = {area.name: _share_within(area.ellipse, piece.ellipse) for area in behind}
        owner = max(shares, key=lambda name: shares[name], default=None)
        if owner is not None and shares[owner] >= PIECE:
            pieces[owner].append(piece)
    return pieces


def _completed(area: Area, seen: Sequence[Area], unseen: Unseen, hidden: float) -> Area:
    """The area as it was believed, or as what is seen of it and what of it is hidden, if those don't agree.

    Completing it at every look would let it grow: ellipses of pieces stick out of the whole's.
    """
    expected = (1 - hidden) * area.covered
    covered = sum(piece.covered for piece in seen)
    if covered > expected / 2 and all(_share_within(area.ellipse, piece.ellipse) > INSIDE for piece in seen):
        return area
    own = np.vstack([boundary(area.ellipse), points_within(area.ellipse)])
    points = np.vstack([own[unseen.at(own)], *(boundary(piece.ellipse) for piece in seen)])
    hull = cv2.convexHull(points.astype(np.float32))[:, 0, :].astype(np.float64)
    (ellipse,) = enclosing_ellipses([hull])
    return replace(area, ellipse=ellipse, covered=covered + hidden * area.covered)


def _share_within(whole: Ellipse, piece: Ellipse) -> float:
    return float(contains(whole, points_within(piece)).mean())
