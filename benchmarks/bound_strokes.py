"""Strokes for the bound (benchmarks/bound.py): where they go, what they take into the container, how long
they take. Positions are the true ones, and nothing fails.

What a stroke takes is what lies in its corridor; whether it keeps that at its bends the stand-in for the
table tells afterwards. A stroke takes as long as plans expect of it (motion/duration.py), from the nearest
place at which a stroke before it may have ended: so its time depends on no other stroke, and a sum of times
is never more than what they take one after another.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise, product
from math import asin, atan2, cos, dist, hypot, pi, radians, sin

import numpy as np

from cleancli.array_types import Bools, Floats, Points
from cleancli.geometry.ellipse import Point
from cleancli.motion.actions import OVERSHOOT, into_container, past_edge, path_along
from cleancli.motion.duration import expected_seconds
from cleancli.motion.pace import FAST_SPEED, TRANSIT_SPEED
from cleancli.motion.path import ToolPath
from cleancli.motion.way_out import GREATEST_SLANT
from cleancli.perception.symbols import GREATEST_TURN
from cleancli.scene.model import Scene
from cleancli.world.robots.gantry import resting_pose

SLIPS = 3e-3
"""Metres within an end of the rag where a particle is not relied upon: half a lentil."""

SLIPS_BENT = 1e-2
"""The same of strokes that bend: half a flap. In the physics what is more than twice as far from both ends
keeps to the rag at bends (python benchmarks/stand_in.py --part turn)."""

MOST_TURN = radians(GREATEST_TURN)
"""The sharpest bend of a stroke: as much as `onward` allows (docs/perception.md)."""

_TINY = 1e-9
_PINNED = 1e-3  # metres within the corridor where a push's particle is put that shall just be taken


@dataclass(frozen=True, slots=True)
class Stroke:
    """The corners of a stroke into the container, the first at the dirt that lies farthest back; the number
    whose bits are the particles that it takes; and its seconds after another stroke and as the first one."""

    corners: tuple[Point, ...]
    takes: int
    seconds: float
    first: float


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """A table, the seed of the episode that it is of, and where its particles then lie, (n, 2) in metres."""

    scene: Scene
    seed: int
    places: Points


def stroke(corners: Sequence[Point], layout: Layout) -> Stroke:
    """The stroke with these corners, of which the last one is past the edge."""
    slips = SLIPS if len(corners) == 2 else SLIPS_BENT
    takes = taken(corners, layout.places, layout.scene.rag.width / 2 - slips)
    path = stroke_path(corners, layout.scene)
    first = path.waypoints[0]
    after = nearest_end((first.x, first.y), layout.scene)
    x, y, *_ = resting_pose(layout.scene).tolist()
    return Stroke(tuple(corners), bits(takes), expected_seconds(path, after), expected_seconds(path, (x, y)))


def stroke_path(corners: Sequence[Point], scene: Scene) -> ToolPath:
    """Its tool path, at the speed of the fast push."""
    return path_along(corners, scene, FAST_SPEED)


def taken(corners: Sequence[Point], places: Points, half: float) -> Bools:
    """(n,) which places lie at most `half` beside a straight piece of the stroke."""
    ends = np.array(corners)
    steps = np.diff(ends, axis=0)
    lengths = np.maximum(np.hypot(*steps.T), _TINY)
    headings = steps / lengths[:, None]
    offsets = places[None] - ends[:-1, None]
    along = (offsets * headings[:, None]).sum(axis=2)
    beside = offsets[..., 1] * headings[:, None, 0] - offsets[..., 0] * headings[:, None, 1]
    within = (along >= -_TINY) & (along <= lengths[:, None]) & (np.abs(beside) <= half + _TINY)
    return np.asarray(within.any(axis=0))


def bits(takes: Bools) -> int:
    """The number with these bits, the first the lowest."""
    return int.from_bytes(np.packbits(takes, bitorder="little").tobytes(), "little")


def nearest_end(place: Point, scene: Scene) -> Point:
    """The place nearest to this one at which a stroke can end: behind the mouth, so far past the edge."""
    (x0, y0), (x1, y1) = scene.mouth()
    out = scene.outwards()
    x = min(max(place[0], min(x0, x1)), max(x0, x1))
    y = min(max(place[1], min(y0, y1)), max(y0, y1))
    return x + OVERSHOOT * out[0], y + OVERSHOOT * out[1]


def possible(corners: Sequence[Point], crossing: Point, scene: Scene) -> bool:
    """Whether a stroke can go over these corners, all on the surface, and over the edge at `crossing`: no
    bend is too sharp, the last piece does not slant too much, and the whole rag passes within the mouth."""
    headings = [atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise((*corners, crossing))]
    turns = (abs((b - a + pi) % (2 * pi) - pi) for a, b in pairwise(headings))
    if any(turn > MOST_TURN + _TINY for turn in turns):
        return False
    (x0, y0), (x1, y1) = scene.mouth()
    out = scene.outwards()
    straightness = cos(headings[-1]) * out[0] + sin(headings[-1]) * out[1]
    room = min(hypot(crossing[0] - x, crossing[1] - y) for x, y in ((x0, y0), (x1, y1)))
    between = dist((x0, y0), (x1, y1)) >= max(dist(crossing, (x0, y0)), dist(crossing, (x1, y1)))
    slants = straightness < cos(radians(GREATEST_SLANT)) - _TINY
    return between and not slants and room >= scene.rag.width / 2 / straightness - _TINY


def nearest_pushes(layout: Layout) -> Iterator[Stroke]:
    """Pushes as the skill makes them where nothing else is dirty: from a start the shortest way out (§3.2.1).
    Each start is level with a particle, and has that one or another just within the rag."""
    scene, half = layout.scene, layout.scene.rag.width / 2 - SLIPS - _PINNED
    for place in layout.places:
        x, y = _heading(into_container(_point(place), scene, ()))
        beside = (layout.places - place) @ (-y, x)
        shifts = np.concatenate(([0.0], beside - half, beside + half))
        for shift in shifts[np.abs(shifts) <= half]:
            start = _point(place + shift * np.array((-y, x)))
            yield stroke(into_container(start, scene, ()), layout)


def straight_pushes(layout: Layout) -> Iterator[Stroke]:
    """Straight pushes with free aim: along every line whose corridor has two of its bounds at particles, at
    ends of the mouth or at the greatest slant, and some between; from each particle on it that may be the
    last. Of those that take the same, the quickest."""
    best: dict[int, tuple[float, tuple[Point, Point]]] = {}
    for heading, offset in _lines(layout):
        for takes, length, corners in _along(heading, offset, layout):
            if takes not in best or length < best[takes][0]:
                best[takes] = length, corners
    for _, corners in best.values():
        yield stroke(corners, layout)


def undominated(strokes: Iterable[Stroke]) -> list[Stroke]:
    """Those that no other one replaces: that takes as much, or more, and is as quick."""
    kept: list[Stroke] = []
    masks = np.empty(0, object)
    for one in sorted(strokes, key=lambda s: (s.seconds, s.first, -s.takes.bit_count())):
        rivals = np.flatnonzero((masks & one.takes) == one.takes) if kept else ()
        if not any(kept[k].first <= one.first for k in rivals):
            kept.append(one)
            masks = np.append(masks, one.takes)
    return kept


def _lines(layout: Layout) -> Iterator[tuple[float, float]]:
    """Headings and offsets of lines: those at which a line can't be moved on without losing or taking a
    particle, or leaving the mouth; and some between, of which one may be quicker."""
    out = atan2(*reversed(layout.scene.outwards()))
    widest = radians(GREATEST_SLANT)
    bounds = _bounds(layout)
    for (p, c), (q, d) in combinations(bounds, 2):
        step, apart = c - d, dist(p, q)
        if apart > abs(step):
            towards = atan2(p[1] - q[1], p[0] - q[0])
            for heading in (towards - asin(step / apart), towards - pi + asin(step / apart)):
                if abs((heading - out + pi) % (2 * pi) - pi) <= widest:
                    yield heading, _aside(p, heading) - c
    for (p, c), slant in product(bounds, np.linspace(-widest, widest, 25)):
        yield out + slant, _aside(p, out + slant) - c


def _bounds(layout: Layout) -> list[tuple[Point, float]]:
    """Points, and how far aside of the line each may be at most: particles at either side, and the ends of
    the mouth, outside of the rag."""
    half = layout.scene.rag.width / 2
    bounds = [(_point(p), side * (half - SLIPS)) for p in layout.places for side in (1, -1)]
    first, last = layout.scene.mouth()
    out = atan2(*reversed(layout.scene.outwards()))
    left, right = (first, last) if _aside(first, out) > _aside(last, out) else (last, first)
    return [*bounds, (left, half), (right, -half)]


def _along(heading: float, offset: float, layout: Layout) -> Iterator[tuple[int, float, tuple[Point, Point]]]:
    """Strokes along a line, one for each particle in its corridor that may be the last: what it takes, a
    measure of its time, and its corners; none if the line does not cross the mouth."""
    scene, direction = layout.scene, np.array((cos(heading), sin(heading)))
    normal = np.array((-direction[1], direction[0]))
    edge, out = np.array(scene.mouth()[0]), np.array(scene.outwards())
    crossing = offset * normal + (edge - offset * normal) @ out / (direction @ out) * direction
    if not possible((_point(crossing - direction),), _point(crossing), scene):
        return
    end = past_edge(_point(crossing - direction), _point(crossing), scene)
    beside = np.abs(layout.places @ normal - offset) <= scene.rag.width / 2 - SLIPS + _TINY
    along = layout.places @ direction
    numbers = np.flatnonzero(beside & (along < end @ direction))
    takes = 0
    for number in numbers[np.argsort(-along[numbers])]:
        takes |= 1 << int(number)
        start = _point(offset * normal + along[number] * direction)
        length = dist(start, end) + dist(start, nearest_end(start, scene)) * FAST_SPEED / TRANSIT_SPEED
        yield takes, length, (start, end)


def _heading(corners: Sequence[Point]) -> Point:
    """The unit vector along the first piece of a stroke."""
    (x0, y0), (x1, y1) = corners[:2]
    length = hypot(x1 - x0, y1 - y0)
    return (x1 - x0) / length, (y1 - y0) / length


def _aside(place: Point, heading: float) -> float:
    """How far to the left of the origin a place is for who goes in this direction."""
    return cos(heading) * place[1] - sin(heading) * place[0]


def _point(place: Floats) -> Point:
    return float(place[0]), float(place[1])
