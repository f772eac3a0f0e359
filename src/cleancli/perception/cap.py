"""Caps the number of areas that are planned for: "ignoring some of the dirty areas" (§4.2.1).

Areas that are left out are seen, tracked and believed dirty like all others. Only the planner is not told of
them, until a later look in which they are not among the smallest or farthest any more.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import dist

from cleancli.perception.area import Area
from cleancli.perception.symbols import place_at_mouth
from cleancli.scene.model import Scene


def left_out(areas: Sequence[Area], scene: Scene) -> tuple[str, ...]:
    """The names of the areas beyond the scene's `most`, the first to be left out first.

    Smallest are those with the least dirt, farthest those whose centre is farthest from where a push of them
    leaves the table.
    """
    thresholds = scene.symbols

    def rank(area: Area) -> float:
        if thresholds.leave_out == "smallest":
            return area.covered
        return -dist(area.ellipse.centre, place_at_mouth(area.ellipse.centre, scene))

    number = max(0, len(areas) - thresholds.most)
    return tuple(area.name for area in sorted(areas, key=rank)[:number])
