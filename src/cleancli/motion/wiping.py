"""Wiping areas away where they are, as ink on a board (§3.1): strokes back and forth over the whole of each,
without lifting the rag between them. Nothing is pushed anywhere."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import ceil, dist, pi

import numpy as np

from cleancli.array_types import Bools, Floats, Points
from cleancli.geometry.ellipse import Ellipse, Point, boundary
from cleancli.motion.pace import FAST_SPEED
from cleancli.motion.path import EDGE_MARGIN, Interpolation, ToolPath, along
from cleancli.scene.model import Scene

PASSES = 4
"""Over each place, an even number: the rag is back where it began. Chosen: a pass takes up to three quarters
of what it finds, so three leave 2 %, and each place may lie below a seam of the cloth once."""

# Chosen, all that follows, in metres.
DRIFT = 4e-3  # sideways from one end of a pass to the other: no place lies below the same seam each time
MARGIN = 0.01  # of the rag at each of its ends, which is not relied upon: more than the tool's error
BEYOND = 0.01  # so far a pass goes on past the area

_SHIFTS = 21  # sideways places of the lanes that are tried
_KEPT = 1024  # strokes: a plan asks for the same ones again and again

Lane = tuple[Point, Point]
"""The middle of a strip that the rag goes up and down, from one end to the other."""


@dataclass(frozen=True, slots=True)
class Strokes:
    """The lanes that wipe one area, side by side, and which of the other areas lie wholly below them."""

    lanes: tuple[Lane, ...]
    covers: frozenset[Ellipse]

    def reversed(self) -> Strokes:
        """The same lanes, begun at their other ends."""
        return Strokes(tuple((end, begin) for begin, end in self.lanes), self.covers)


def strokes_over(area: Ellipse, scene: Scene, others: Iterable[Ellipse]) -> Strokes:
    """As few lanes along the area's longer axis as the rag needs to pass over all of it, shifted sideways, as
    far as there is room, to cover as many of the `others` as they can."""
    return _strokes_over(area, scene, tuple(sorted(others, key=lambda other: other.centre)))


def wiping(areas: Sequence[Ellipse], scene: Scene, others: Iterable[Ellipse]) -> ToolPath:
    """The path of wiping these areas one after the other; each is begun, and left, at the end that makes the
    ways between them shortest. `others` are all other areas."""
    there = {*areas, *others}
    first, *rest = (strokes_over(area, scene, there - {area}) for area in areas)
    chosen = min((_chained((begin, *rest)) for begin in (first, first.reversed())), key=_between)
    return up_and_down([lane for strokes in chosen for lane in strokes.lanes], scene)


def up_and_down(lanes: Iterable[Lane], scene: Scene) -> ToolPath:
    """The path along these lanes, each there and back until it is wiped."""
    return along(_poses(lanes, scene), FAST_SPEED, Interpolation.STRAIGHT)


@lru_cache(maxsize=_KEPT)
def _strokes_over(area: Ellipse, scene: Scene, others: tuple[Ellipse, ...]) -> Strokes:
    long, short = area.axes
    width = max(scene.rag.width - 2 * MARGIN, scene.rag.width / 2)
    number = max(1, ceil(2 * short / width - 1e-9))
    room = number * width / 2 - short
    comb = width * (np.arange(number) - (number - 1) / 2)
    shifts = sorted(np.linspace(-room, room, _SHIFTS).tolist(), key=abs)  # of equals, the least is taken
    lanes = [(middles := comb + shift, _half_lengths(middles, width, long, short)) for shift in shifts]
    outlines = [_seen_from(area, boundary(other)) for other in others]
    covered = [[_below(outline, *each, width) for outline in outlines] for each in lanes]
    best = max(range(len(lanes)), key=lambda k: sum(covered[k]))
    found = frozenset(other for other, below in zip(others, covered[best], strict=True) if below)
    return Strokes(tuple(_lane(area, *each) for each in zip(*lanes[best], strict=True)), found)


def _half_lengths(middles: Floats, width: float, long: float, short: float) -> Floats:
    """(n,) how far lanes reach from the middle to each side: as far as the ellipse does somewhere on them."""
    inner = np.clip((np.abs(middles) - width / 2) / max(short, 1e-9), 0, 1)
    reach: Floats = long * np.sqrt(1 - inner**2) + BEYOND
    return reach


def _below(outline: Points, middles: Floats, halves: Floats, width: float) -> bool:
    """Whether each point of an outline (m, 2), along and across the lanes, lies on one of them."""
    along, across = np.abs(outline[:, :1]), np.abs(outline[:, 1:] - middles)
    on: Bools = (along <= halves) & (across <= width / 2)
    return bool(on.any(axis=1).all())


def _lane(area: Ellipse, middle: float, half: float) -> Lane:
    along, across = _axes(area)
    centre = np.array(area.centre) + middle * across
    begin, end = centre - half * along, centre + half * along
    return (float(begin[0]), float(begin[1])), (float(end[0]), float(end[1]))


def _seen_from(area: Ellipse, points: Points) -> Points:
    """Points (n, 2) by how far they are along and across an area, from its centre."""
    return np.asarray((points - np.array(area.centre)) @ np.column_stack(_axes(area)))


def _axes(area: Ellipse) -> tuple[Floats, Floats]:
    along = np.array((np.cos(area.angle), np.sin(area.angle)))
    return along, np.array((-along[1], along[0]))


def _chained(each: Sequence[Strokes]) -> tuple[Strokes, ...]:
    """The strokes in their order, each but the first begun at the end nearer to where the one before ends."""
    chain = [each[0]]
    for strokes in each[1:]:
        chain.append(min(strokes, strokes.reversed(), key=lambda one: _between((chain[-1], one))))
    return tuple(chain)


def _between(chain: Sequence[Strokes]) -> float:
    """Metres from where each strokes end, which is where their last lane begins, to where the next begin."""
    return sum(dist(before.lanes[-1][0], after.lanes[0][0]) for before, after in pairwise(chain))


def _poses(lanes: Iterable[Lane], scene: Scene) -> list[tuple[float, float, float]]:
    """x, y and yaw at both ends of each pass. What is wiped is pushed nowhere, so that the rag need not turn
    round to go back, and turns as little as it can from lane to lane."""
    poses: list[tuple[float, float, float]] = []
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 - EDGE_MARGIN
    for begin, end in lanes:
        step = np.subtract(end, begin)
        yaw = float(np.arctan2(step[1], step[0]))
        before = poses[-1][2] if poses else 0.0
        yaw += pi * round((before - yaw) / pi)
        across = np.array((-step[1], step[0])) / max(float(np.linalg.norm(step)), 1e-12)
        for number in range(PASSES + 1):
            drift = (number - PASSES / 2) * DRIFT
            x, y = np.clip((begin, end)[number % 2] + drift * across, -half, half)
            poses.append((float(x), float(y), yaw))
    return poses
