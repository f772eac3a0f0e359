"""The quickest strokes that take all particles (benchmarks/bound.py): of given ones by an integer program,
and with free bends by annealing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist, inf

import numpy as np
from bound_strokes import Layout, Stroke, possible, stroke
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array, hstack

from cleancli.geometry.ellipse import Point
from cleancli.motion.actions import past_edge
from cleancli.motion.path import EDGE_MARGIN

NODES = 2_000
"""Of the integer program's tree. It is stopped by their number and not by time, so that it ends alike on
every machine; what it has proven by then is the bound."""

GAP = 1e-3
"""Share of the seconds by which the integer program's answer may exceed what it has proven."""

HOTTEST, COLDEST = 3.0, 0.05
"""Seconds that annealing loses as easily at its beginning and at its end."""

SHIFT = 0.03
"""Metres by which annealing moves a corner (standard deviation)."""

SHORTEST = 0.03
"""Metres of the shortest piece of a stroke that annealing considers: the rag turns within about as much."""

Corners = tuple[Point, ...]


@dataclass(frozen=True, slots=True)
class Cover:
    """Strokes that take all particles, in the order in which they are made; seconds of all, and the `least`
    seconds that any choice of the strokes offered needs."""

    strokes: tuple[Stroke, ...]
    seconds: float
    least: float


def quickest(offered: Sequence[Stroke], count: int) -> Cover:
    """The strokes of those offered that take particles 0 to `count` - 1 in the shortest time, one of them
    made first: a set cover, by integer programming. Raises ValueError where they don't take all."""
    if not count:
        return Cover((), 0.0, 0.0)
    takes = csr_array(np.array([[s.takes >> k & 1 for s in offered] for k in range(count)], np.float64))
    is_first = np.repeat([0.0, 1.0], len(offered))
    seconds = np.array([*(s.seconds for s in offered), *(s.first for s in offered)])
    found = milp(
        seconds,
        integrality=1,
        bounds=Bounds(0, 1),
        constraints=(
            LinearConstraint(hstack((takes, takes)), lb=1),
            LinearConstraint(is_first, lb=1, ub=1),
        ),
        options={"node_limit": NODES, "mip_rel_gap": GAP},
    )
    if found.x is None:
        raise ValueError("no choice of these strokes takes all")
    chosen = np.flatnonzero(found.x > 0.5).tolist()
    first = next(number for number in chosen if number >= len(offered)) - len(offered)
    others = [offered[number] for number in chosen if number < len(offered)]
    return Cover(_ordered(offered[first], others), float(found.fun), float(found.mip_dual_bound))


def _ordered(first: Stroke, others: Iterable[Stroke]) -> tuple[Stroke, ...]:
    """After each stroke the one to which the way is shortest, beside the way back along that one itself."""
    order, left = [first], list(others)
    while left:
        end = order[-1].corners[-1]
        following = min(left, key=lambda s: dist(end, s.corners[0]) - dist(s.corners[-1], s.corners[0]))
        left.remove(following)
        order.append(following)
    return tuple(order)


class Annealing:
    """Looks for quick sets of strokes that bend at most `bends` times. What no stroke takes costs what the
    quickest of the `given` ones needs that takes it, so every set is worth something.

    A set is a tuple of strokes by their corners, the last of which is where the edge is crossed.
    """

    def __init__(self, layout: Layout, given: Sequence[Stroke], bends: int, rng: np.random.Generator) -> None:
        self._layout, self._bends, self._rng = layout, bends, rng
        self._alone = [min(s.seconds for s in given if s.takes >> k & 1) for k in range(len(layout.places))]
        self._made: dict[Corners, Stroke | None] = {}

    @property
    def seen(self) -> list[Stroke]:
        """All strokes that were tried and can be made: the integer program chooses of them afterwards."""
        return [made for made in self._made.values() if made is not None]

    def run(self, strokes: Iterable[Stroke], steps: int) -> None:
        """Anneal from these strokes, by so many changes that are tried."""
        begin = (self._crossing(s.corners) for s in strokes)
        now = tuple(corners for corners in begin if self._stroke(corners) is not None)
        if not now:
            return
        cost = self._cost(now)
        for step in range(steps):
            heat = HOTTEST * (COLDEST / HOTTEST) ** (step / steps)
            changed = self._changed(now)
            worth = self._cost(changed)
            if worth <= cost + heat * self._rng.standard_exponential():
                now, cost = changed, worth

    def _cost(self, strokes: tuple[Corners, ...]) -> float:
        """Seconds of all; infinite if a stroke can't be made."""
        made = [self._stroke(corners) for corners in strokes]
        possible_ones = [m for m in made if m is not None]
        if len(possible_ones) < len(made) or not made:
            return inf
        taken = 0
        for one in possible_ones:
            taken |= one.takes
        alone = sum(seconds for k, seconds in enumerate(self._alone) if not taken >> k & 1)
        begin = min(one.first - one.seconds for one in possible_ones)
        return sum(one.seconds for one in possible_ones) + alone + begin

    def _stroke(self, corners: Corners) -> Stroke | None:
        if corners not in self._made:
            self._made[corners] = self._make(corners)
        return self._made[corners]

    def _make(self, corners: Corners) -> Stroke | None:
        """The stroke that goes on past the edge; None if it can't be made."""
        *inner, crossing = corners
        surface = self._layout.scene.surface
        low = EDGE_MARGIN - np.array((surface.width, surface.depth)) / 2
        if not 0 < len(inner) <= self._bends + 1 or (np.abs(inner) > -low).any():
            return None
        if min(dist(a, b) for a, b in pairwise(corners)) < SHORTEST:
            return None
        if not possible(inner, crossing, self._layout.scene):
            return None
        return stroke((*inner, past_edge(inner[-1], crossing, self._layout.scene)), self._layout)

    def _crossing(self, corners: Corners) -> Corners:
        """The corners with the end that is past the edge replaced by where the edge is crossed."""
        *inner, end = corners
        edge, out = self._layout.scene.mouth()[0], self._layout.scene.outwards()
        beyond = (end[0] - edge[0]) * out[0] + (end[1] - edge[1]) * out[1]
        along = (end[0] - inner[-1][0]) * out[0] + (end[1] - inner[-1][1]) * out[1]
        share = beyond / along
        return (*inner, (end[0] + share * (inner[-1][0] - end[0]), end[1] + share * (inner[-1][1] - end[1])))

    def _changed(self, strokes: tuple[Corners, ...]) -> tuple[Corners, ...]:
        """The set with one stroke changed, left out, added, or joined to another."""
        rng, number = self._rng, int(self._rng.integers(len(strokes)))
        others = strokes[:number] + strokes[number + 1 :]
        match int(rng.integers(10)):
            case 0:
                return others
            case 1:
                return (*strokes, (self._particle(), strokes[number][-1]))
            case 2 if others:
                other = int(rng.integers(len(others)))
                joined = (*strokes[number][:-1], *others[other])
                return (*others[:other], joined, *others[other + 1 :])
            case 3 | 4 | 5:
                return (*others, self._bent(strokes[number]))
            case _:
                return (*others, self._moved(strokes[number]))

    def _bent(self, corners: Corners) -> Corners:
        """With a corner more, at a particle, or with one less."""
        place = int(self._rng.integers(len(corners)))
        if self._rng.random() < 0.5:
            return (*corners[:place], *corners[place + 1 :]) if place + 1 < len(corners) else corners
        return (*corners[:place], self._particle(), *corners[place:])

    def _moved(self, corners: Corners) -> Corners:
        """With one corner a bit elsewhere; where the edge is crossed stays on the edge."""
        place = int(self._rng.integers(len(corners)))
        dx, dy = self._rng.normal(0, SHIFT, 2).tolist()
        if place + 1 == len(corners):
            out = self._layout.scene.outwards()
            dx, dy = dx * abs(out[1]), dy * abs(out[0])
        x, y = corners[place]
        return (*corners[:place], (x + dx, y + dy), *corners[place + 1 :])

    def _particle(self) -> Point:
        x, y = self._layout.places[self._rng.integers(len(self._layout.places))].tolist()
        return x, y
