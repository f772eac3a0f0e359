"""Pushing into a zone of the surface: from which side, from where and how far.

The rag stops as soon as both ends of what it pushes are within the zone, so that what lies there already is
pushed on as little as can be. No stroke goes over the zone and on.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import astuple, dataclass
from functools import lru_cache
from itertools import compress

import numpy as np

from cleancli.array_types import Bools, Floats, Points
from cleancli.geometry.ellipse import Ellipse, Point, reaches
from cleancli.motion.corners import CLEARANCE
from cleancli.motion.path import EDGE_MARGIN
from cleancli.scene.model import Scene, Zone

# Chosen, all that follows, in metres but for the two factors.
WITHIN = 0.006  # from the zone's sides to both ends of what the rag pushes, where it stops
BESIDE = 0.008  # on either side of the rag as it comes down, and before and behind it, nothing may lie
BACK = 0.20  # so far behind its dirt the rag comes down at most, where other dirt lies in its way
ROOM = 0.06  # before the rag, within the zone, for what it pushes and what lies there
WORTH = 0.5  # of a longer way that one more area taken along is worth
LANDING_ON_DIRT = 2.0  # of a longer way that is as bad as coming down on other dirt
DEEPER = 5.0  # times its length that a way within the zone counts: it pushes on what lies there
CRAMPED = 10.0  # times its length that a lack of room counts

_AIMS = 15  # places of the zone to aim at, along each side
_STEP = 0.004  # between places that are tried for where the rag comes down, and where it stops
_KEPT = 1024  # ways: a plan asks for the same ones again and again


@dataclass(frozen=True, slots=True)
class WayIn:
    """Where the rag comes down and where it stops, and which of the areas that were asked about it takes
    along."""

    begin: Point
    end: Point
    takes: frozenset[Ellipse]


def inwards(zone: Zone, points: Points) -> Floats:
    """For points (n, 2): how far each lies within the zone from its nearest side, (n,) metres; negative
    outside."""
    cos, sin = np.cos(zone.turn), np.sin(zone.turn)
    local = (points - np.array(zone.centre)) @ np.array(((cos, -sin), (sin, cos)))
    deep: Floats = zone.side / 2 - np.abs(local).max(axis=1)
    return deep


def corners(zone: Zone) -> Points:
    """(4, 2) the zone's corners, counter-clockwise."""
    cos, sin = np.cos(zone.turn), np.sin(zone.turn)
    square = zone.side / 2 * np.array(((1, 1), (-1, 1), (-1, -1), (1, -1)))
    return np.asarray(np.array(zone.centre) + square @ np.array(((cos, sin), (-sin, cos))))


def way_in(area: Ellipse, scene: Scene, others: Iterable[Ellipse]) -> WayIn:
    """The straight way over the middle of an area into the scene's zone that is shortest, less `WORTH` metres
    for each other area that lies on it whole: nothing of it more than the scene's `traversal` beside it.

    A way within the zone, and a lack of room before the rag there, make it longer (`DEEPER`, `CRAMPED`). It
    begins behind the area where nothing lies, farther back if it must. Raises ValueError without a zone.
    """
    if scene.zone is None:
        raise ValueError(f"the scene `{scene.name}` has no zone")
    return _way_in(area, scene, scene.zone, tuple(sorted(others, key=astuple)))


@lru_cache(maxsize=_KEPT)
def _way_in(area: Ellipse, scene: Scene, zone: Zone, others: tuple[Ellipse, ...]) -> WayIn:
    middle, half = np.array(area.centre), scene.rag.width / 2
    headings = _headings(middle, zone)
    across = headings[:, ::-1] * (-1, 1)
    places = np.array([other.centre for other in others]).reshape(-1, 2) - middle
    along, aside = places @ headings.T, places @ across.T
    long, broad = reaches(others, headings).T, reaches(others, across).T
    behind = reaches((area,), headings)[:, 0] + CLEARANCE
    backs, free = _backs(behind, along, np.abs(aside), long, broad, _room(middle, headings, scene), scene)
    passes = _inner(middle, headings, zone, np.zeros((2, len(headings))))
    entered = _first(passes >= 0)
    on = (along > -backs) & (along < entered) & (np.abs(aside) + broad <= scene.symbols.traversal)
    own = np.minimum(reaches((area,), across)[:, 0], half)
    right = np.minimum(-own, np.where(on, aside - broad, 0.0).min(axis=0, initial=0.0))
    left = np.maximum(own, np.where(on, aside + broad, 0.0).max(axis=0, initial=0.0))
    deep = _inner(middle, headings, zone, np.stack((right, left)))
    stops = _first(deep >= np.minimum(WITHIN, deep.max(axis=0)))
    room = _STEP * (deep >= 0).sum(axis=0) - (stops - _first(deep >= 0))
    cost = backs + stops + DEEPER * (stops - entered) + CRAMPED * np.maximum(ROOM - room, 0.0)
    best = int(np.argmin(cost - WORTH * on.sum(axis=0) + LANDING_ON_DIRT * ~free))
    begin, end = middle - backs[best] * headings[best], middle + stops[best] * headings[best]
    taken = frozenset(compress(others, on[:, best]))
    return WayIn((float(begin[0]), float(begin[1])), (float(end[0]), float(end[1])), taken)


def _headings(middle: Floats, zone: Zone) -> Floats:
    """(n, 2) directions from an area's middle to places all over the zone but its rim."""
    shares = np.linspace(-1, 1, _AIMS)
    grid = np.stack(np.meshgrid(shares, shares), axis=-1).reshape(-1, 2) * (zone.side / 2 - WITHIN)
    cos, sin = np.cos(zone.turn), np.sin(zone.turn)
    steps = np.array(zone.centre) + grid @ np.array(((cos, sin), (-sin, cos))) - middle
    lengths = np.linalg.norm(steps, axis=1)
    there = lengths > _STEP
    headings: Floats = steps[there] / lengths[there, None]
    return headings


def _inner(middle: Floats, headings: Floats, zone: Zone, ends: Floats) -> Floats:
    """(k, n) how far within the zone both ends of what is pushed are, metres, after k steps on each way;
    `ends` (2, n) by how far they are aside of it."""
    farthest = float(np.linalg.norm(np.array(zone.centre) - middle)) + zone.side
    steps = _STEP * np.arange(int(np.ceil(farthest / _STEP)) + 1)
    places = middle + steps[:, None, None] * headings
    across = headings[:, ::-1] * (-1, 1)
    first, second = (
        inwards(zone, (places + end[:, None] * across).reshape(-1, 2)).reshape(places.shape[:2])
        for end in ends
    )
    deep: Floats = np.minimum(first, second)
    return deep


def _first(reached: Bools) -> Floats:
    """(n,) metres on each way to the first step (k, n) for which something holds."""
    return np.asarray(_STEP * reached.argmax(axis=0))


def _backs(
    behind: Floats, along: Floats, beside: Floats, long: Floats, broad: Floats, room: Floats, scene: Scene
) -> tuple[Floats, Bools]:
    """(n,) how far behind the area's middle the rag comes down on each way, and whether nothing lies there;
    other areas (m, n) by how far they are along and beside each way, and how far they reach so."""
    steps = np.arange(0, BACK, _STEP)
    tried = np.minimum(behind + steps[:, None], np.maximum(room, 0.0))
    within = np.abs(along + tried[:, None]) < long + CLEARANCE / 2 + BESIDE
    below = beside < broad + scene.rag.width / 2 + BESIDE
    free: Bools = np.logical_not((within & below).any(axis=1))
    first = free.argmax(axis=0)
    ways = np.arange(len(behind))
    return tried[first, ways], free[first, ways]


def _room(middle: Floats, headings: Floats, scene: Scene) -> Floats:
    """(n,) how far behind the area's middle the surface goes on, on each way."""
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 - EDGE_MARGIN
    with np.errstate(divide="ignore"):
        gaps = np.where(headings > 0, half + middle, half - middle) / np.abs(headings)
    return np.asarray(gaps.min(axis=1))
