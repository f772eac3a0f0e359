"""Where a push leaves the surface (§3.2.1): of all ways into the container, the one that is worth most, by
its length and by what else lies on it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import astuple, dataclass
from functools import lru_cache
from itertools import compress

import numpy as np

from cleancli.array_types import Floats
from cleancli.geometry.ellipse import Ellipse, Point, reaches
from cleancli.scene.model import Scene

GREATEST_SLANT = 60.0
"""Chosen: degrees from the edge's normal up to which a push goes straight over the edge."""

WORTH = 0.5
"""Chosen: metres of a longer way that one more area taken along is worth. A push of its own is longer."""

_CROSSINGS = 161  # places of the mouth that are tried
_KEPT = 1024  # ways: a plan asks for the same ones again and again


@dataclass(frozen=True, slots=True)
class WayOut:
    """The corners of a way from where it begins to where it crosses the container's mouth, and which of the
    areas that were asked about it takes along."""

    corners: tuple[Point, ...]
    takes: frozenset[Ellipse]


def way_out(start: Point, scene: Scene, dirt: Iterable[Ellipse]) -> WayOut:
    """The way from `start` into the container that is shortest, less `WORTH` metres for each area of `dirt`
    that lies on it whole: nothing of it more than the scene's `traversal` beside it.

    The whole rag, perpendicular to its way, crosses the edge within the mouth. It goes straight where that
    does not slant by more than `GREATEST_SLANT` and the slanting rag has room; otherwise it turns a rag's
    width in front of the edge.
    """
    return _way_out(start, scene, tuple(sorted(dirt, key=astuple)))


@lru_cache(maxsize=_KEPT)
def _way_out(start: Point, scene: Scene, dirt: tuple[Ellipse, ...]) -> WayOut:
    ways = _ways(np.array(start), scene)
    places = np.array([area.centre for area in dirt]).reshape(-1, 2)
    steps = np.diff(ways, axis=1)
    lengths = np.linalg.norm(steps, axis=2)
    headings = steps / np.maximum(lengths, 1e-12)[:, :, None]
    offsets = places[None, None] - ways[:, :2, None]
    along = np.einsum("wpnx,wpx->wpn", offsets, headings)
    beside = offsets[..., 0] * headings[:, :, None, 1] - offsets[..., 1] * headings[:, :, None, 0]
    outermost = np.abs(beside) + reaches(dirt, headings[..., ::-1] * (1, -1))
    lies = (along > 0) & (along < lengths[:, :, None]) & (outermost <= scene.symbols.traversal)
    takes = lies.any(axis=1)
    best = int(np.argmin(lengths.sum(axis=1) - WORTH * takes.sum(axis=1)))
    corners = tuple((float(x), float(y)) for x, y in ways[best])
    taken = frozenset(compress(dirt, takes[best]))
    return WayOut(corners if lengths[best, 0] > 0 else corners[1:], taken)


def _ways(start: Floats, scene: Scene) -> Floats:
    """(n, 3, 2) where a way begins, where it turns (or begins, if it does not), and where it crosses the
    mouth: at each place that has room for the rag, or in its middle, where none has."""
    first, last = (np.array(end) for end in scene.mouth())
    out, rag = np.array(scene.outwards()), scene.rag.width
    shares = np.linspace(0, 1, _CROSSINGS)
    places = first + shares[:, None] * (last - first)
    room = float(np.linalg.norm(last - first)) * np.minimum(shares, 1 - shares)
    distances = np.maximum(np.linalg.norm(places - start, axis=1), 1e-12)
    straightness = (places - start) @ out / distances
    slanting = rag / 2 / np.maximum(straightness, 1e-12)
    straight = (straightness >= np.cos(np.radians(GREATEST_SLANT))) & (room >= slanting)
    fits = straight | (room >= rag / 2)
    if not fits.any():
        places, straight, fits = (first + last)[None] / 2, np.zeros(1, np.bool_), np.ones(1, np.bool_)
    turns = np.where(straight[:, None], start, places - rag * out)
    ways: Floats = np.stack((np.broadcast_to(start, places.shape), turns, places), axis=1)[fits]
    return ways
