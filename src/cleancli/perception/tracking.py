"""Names for areas: which area of an observation is what has become of an area seen before."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import dist

import numpy as np
from scipy.optimize import linear_sum_assignment

from cleancli.perception.area import Area
from cleancli.perception.ellipses import gap

GATE = 0.03
"""Metres between two ellipses up to which one may be what has become of the other."""

_NEVER = 1e6


@dataclass(frozen=True, slots=True)
class Stroke:
    """Where the tool went on the surface.

    `pushed` names the areas it was meant to push, in order; of several, the last is the target of a join.
    `points` (x, y) in metres are the way of the cloth's middle, `half_width` is half of the cloth's width.
    """

    pushed: tuple[str, ...]
    points: tuple[tuple[float, float], ...]
    half_width: float

    @property
    def moved(self) -> tuple[str, ...]:
        """The names of the areas that it was meant to push away; the target of a join stays."""
        return self.pushed[:-1] if len(self.pushed) > 1 else self.pushed

    def swept(self, point: tuple[float, float], beside: float = 0.0) -> bool:
        """Whether the cloth went over a point, or passed within `beside` metres of it."""
        pieces = pairwise(self.points) if len(self.points) > 1 else ((p, p) for p in self.points)
        return any(_distance(point, *piece) <= self.half_width + beside for piece in pieces)


def track(
    before: Sequence[Area], after: Sequence[Area], stroke: Stroke | None, next_number: int
) -> tuple[Area, ...]:
    """The areas of `after`, in their order, named as what has become of the named areas of `before`.

    Areas that nothing pushed, and the target of a join, keep their names where they stand: all together at
    the least sum of distances between centres, none across a gap above `GATE`. Then each pushed area gives
    its name to the largest area left that lies along the stroke or where it lay before. A name without an
    area is gone; an area without a name becomes `a<next_number>`, and so on.
    """
    pushed = () if stroke is None else stroke.moved
    names = _standing([area for area in before if area.name not in pushed], after)
    if stroke is not None:
        names |= _pushed(before, after, stroke, names)
    fresh = iter(range(next_number, next_number + len(after)))
    return tuple(
        replace(area, name=names[index] if index in names else f"a{next(fresh)}")
        for index, area in enumerate(after)
    )


def _standing(before: Sequence[Area], after: Sequence[Area]) -> dict[int, str]:
    """Index in `after` -> name, for areas that stayed where they were."""
    if not before or not after:
        return {}
    costs = np.array([[_cost(old, new) for new in after] for old in before])
    rows, columns = linear_sum_assignment(costs)
    pairs = zip(rows.tolist(), columns.tolist(), strict=True)
    return {column: before[row].name for row, column in pairs if costs[row, column] < _NEVER}


def _cost(old: Area, new: Area) -> float:
    if gap(old.ellipse, new.ellipse) > GATE:
        return _NEVER
    return dist(old.ellipse.centre, new.ellipse.centre)


def _pushed(
    before: Sequence[Area], after: Sequence[Area], stroke: Stroke, taken: Mapping[int, str]
) -> dict[int, str]:
    """Index in `after` -> name, for names of the stroke that stayed nowhere; a join's target comes first."""
    earlier = {area.name: area for area in before}
    names: dict[int, str] = {}
    order = (*stroke.pushed[-1:], *stroke.pushed[:-1])
    for name in (name for name in order if name in earlier and name not in taken.values()):
        left = (index for index in range(len(after)) if index not in taken and index not in names)
        largest = _largest_reached(left, after, earlier[name], stroke)
        if largest is not None:
            names[largest] = name
    return names


def _largest_reached(indices: Iterable[int], after: Sequence[Area], old: Area, stroke: Stroke) -> int | None:
    reached = [
        index
        for index in indices
        if stroke.swept(after[index].ellipse.centre, GATE) or gap(old.ellipse, after[index].ellipse) <= GATE
    ]
    return max(reached, key=lambda index: after[index].covered, default=None)


def _distance(point: tuple[float, float], start: tuple[float, float], end: tuple[float, float]) -> float:
    """Metres from a point to the line between two others."""
    (x, y), (x0, y0), (x1, y1) = point, start, end
    squared = (x1 - x0) ** 2 + (y1 - y0) ** 2
    share = ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / squared if squared else 0.0
    share = min(1.0, max(0.0, share))
    return dist(point, (x0 + share * (x1 - x0), y0 + share * (y1 - y0)))
