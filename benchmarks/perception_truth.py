"""What truly lies on a table of perception.py, and how what was seen compares with it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import cv2
import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.sparse.csgraph import connected_components
from scipy.spatial.distance import cdist

from cleancli.array_types import Bools, Points, Singles
from cleancli.geometry.ellipse import gap
from cleancli.geometry.rgbd import Camera
from cleancli.perception import geometry
from cleancli.perception.area import Area
from cleancli.perception.areas import enclosing_ellipses
from cleancli.perception.perceive import RIM, Observation
from cleancli.perception.symbols import are_near, is_scattered, lies_between, size_of
from cleancli.scene.calibration import Thresholds
from cleancli.scene.model import Ink, Scene
from cleancli.world import camera as world_camera
from cleancli.world import constants as par
from cleancli.world.table import PybulletTable

FOUND = 0.004
"""Metres from a particle's footprint to the middle of a dirty pixel, up to which it is found: two pixels."""
CELL = 1e-4
"""Metres: width of the cells on which covered areas are measured."""
FALSE = 0.008
"""Metres from all dirt above which a patch is false."""


@dataclass(frozen=True)
class Truth:
    """Points (n, 2) around each particle and cell of ink on the table, and which of them can be seen."""

    pieces: tuple[Points, ...]
    visible: Bools

    def those(self, chosen: Bools) -> list[Points]:
        """Some of the pieces."""
        return [piece for piece, is_chosen in zip(self.pieces, chosen, strict=True) if is_chosen]


@dataclass(frozen=True)
class Comparison:
    """Visible particles, places of those that were missed, false patches, true areas, how many were seen,
    their centres' errors in metres (infinite for areas that were not found), and by symbol how often both
    say the same, and how often that was asked."""

    visible: int
    missed: tuple[Points, ...]
    false: int
    true: tuple[Area, ...]
    seen: int
    centres: tuple[float, ...]
    symbols: dict[str, tuple[int, int]]

    @property
    def found(self) -> int:
        return self.visible - len(self.missed)

    @property
    def miscounted(self) -> int:
        return abs(len(self.true) - self.seen)


def truth_of(table: PybulletTable, eye: Camera, scene: Scene) -> Truth:
    """What lies on the table, and what `eye` can see of it."""
    _, depth = world_camera.render(table._engine, eye, scene.light)
    pieces = tuple(footprints(table))
    visible = [is_visible(piece.mean(axis=0), eye, depth, scene) for piece in pieces]
    return Truth(pieces, np.array(visible, np.bool_))


def footprints(table: PybulletTable) -> list[Points]:
    """Points (n, 2) around each particle on the table, seen from above, and around each cell of ink."""
    turns = np.linspace(0, 2 * pi, 16, endpoint=False)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    found = []
    loose = (dirt for dirt in table._scene.dirt if not isinstance(dirt, Ink))
    kinds = [dirt.of for dirt in loose for _ in range(dirt.count)]
    for body, kind in zip(table._particles, kinds, strict=True):
        place, turn = table._engine.getBasePositionAndOrientation(body)
        if place[2] < -par.TABLE_THICKNESS / 2:
            continue
        axes = np.array(table._engine.getMatrixFromQuaternion(turn)).reshape(3, 3)[:2]
        half = axes * np.array(par.PARTICLES[kind].size) / 2
        found.append(np.array(place[:2]) + circle @ np.linalg.cholesky(half @ half.T).T)
    square = par.INK_CELL / 2 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return found + [cell[:2] + square for cell in table.truth().ink]


def is_visible(place: Points, eye: Camera, depth: Singles, scene: Scene) -> bool:
    """Whether a place is in the picture, not on the rim, nor behind or just beside what stands on the
    surface."""
    inside = np.abs(place) < np.array((scene.surface.width, scene.surface.depth)) / 2 - RIM - 0.003
    column, row = np.rint(geometry.project(eye, place[None]))[0].astype(int)
    if not inside.all() or not (0 <= column < eye.width and 0 <= row < eye.height):
        return False
    reach = (Thresholds() if scene.calibration is None else scene.calibration.thresholds).object_edge + 2
    around = depth[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1]
    rows, columns = np.indices(around.shape)
    pixels = np.column_stack([columns.ravel() + max(column - reach, 0), rows.ravel() + max(row - reach, 0)])
    heights = eye.pose[2, 3] + around.ravel() * geometry.rays(eye, pixels.astype(float))[:, 2]
    return bool(heights.max() < Thresholds().heap)


def true_areas(pieces: Sequence[Points], link: float) -> list[Area]:
    """The areas of §3.1 by their definition: footprints with gaps below `link`, the ellipse around them."""
    if not pieces:
        return []
    owner = np.repeat(np.arange(len(pieces)), [len(piece) for piece in pieces])
    near = cdist(np.vstack(pieces), np.vstack(pieces)) < link
    first, second = np.nonzero(near)
    graph = np.zeros((len(pieces), len(pieces)), np.bool_)
    graph[owner[first], owner[second]] = True
    count, labels = connected_components(graph, directed=False)
    groups = [[pieces[i] for i in np.flatnonzero(labels == label).tolist()] for label in range(count)]
    ellipses = enclosing_ellipses([np.vstack(group) for group in groups])
    return [Area(ellipse, covered(group)) for ellipse, group in zip(ellipses, groups, strict=True)]


def covered(group: Sequence[Points]) -> float:
    """Square metres of the union, on cells of a tenth of a millimetre."""
    corners = np.vstack(group)
    low = corners.min(axis=0)
    width, height = np.ceil((corners.max(axis=0) - low) / CELL).astype(int) + 1
    cells = np.zeros((height, width), np.uint8)
    for piece in group:
        # The cells of the corners are filled, too: half a cell too far out.
        outward = piece - piece.mean(axis=0)
        inner = piece - outward * (CELL / 2 / np.linalg.norm(outward, axis=1))[:, None]
        cv2.fillConvexPoly(cells, np.rint((inner - low) / CELL).astype(np.int32), 1)
    return float(cells.sum()) * CELL**2


def compared(truth: Truth, seen: Observation, scene: Scene) -> Comparison:
    """Counts and errors of one table."""
    middles, patches = dirty(seen)
    found = np.array([len(middles) > 0 and cdist(p, middles).min() < FOUND for p in truth.pieces], np.bool_)
    all_dirt = np.vstack(truth.pieces) if truth.pieces else np.full((1, 2), np.inf)
    # What lies where it may be visible or not is part of an area if it was seen.
    true = true_areas(truth.those(truth.visible | found), scene.symbols.link)
    pairs = matched(true, seen.areas)
    errors = [float(np.hypot(*np.subtract(t.ellipse.centre, s.ellipse.centre))) for t, s in pairs]
    return Comparison(
        visible=int(truth.visible.sum()),
        missed=tuple(piece.mean(axis=0) for piece in truth.those(truth.visible & ~found)),
        false=sum(bool(cdist(patch, all_dirt).min() > FALSE) for patch in patches),
        true=tuple(true),
        seen=len(seen.areas),
        centres=(*errors, *(float("inf") for _ in range(len(true) - len(pairs)))),
        symbols=agreement(pairs, scene),
    )


def dirty(seen: Observation) -> tuple[Points, list[Points]]:
    """The places of all dirty pixels, (n, 2), and those of each patch."""
    mask = seen.steps.believed
    count, labels = cv2.connectedComponents(mask.view(np.uint8), connectivity=8)
    rows, columns = np.nonzero(mask)
    pixels = np.column_stack([columns, rows]).astype(float)
    places = geometry.on_plane(seen.camera, LEVEL, pixels) if len(pixels) else np.empty((0, 2))
    of = labels[rows, columns]
    return places, [places[of == label] for label in range(1, count)]


LEVEL = geometry.Plane.below(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.0, np.array([1.0, 0.0, 0.0]))


def matched(true: Sequence[Area], seen: Sequence[Area]) -> list[tuple[Area, Area]]:
    """Pairs that mean the same dirt: all together at the least distances, none across more than 3 cm."""
    if not true or not seen:
        return []
    apart = cdist([a.ellipse.centre for a in true], [a.ellipse.centre for a in seen])
    rows, columns = linear_sum_assignment(apart)
    pairs = [(true[r], seen[c]) for r, c in zip(rows, columns, strict=True)]
    return [(t, s) for t, s in pairs if gap(t.ellipse, s.ellipse) <= 0.03]


def agreement(pairs: Sequence[tuple[Area, Area]], scene: Scene) -> dict[str, tuple[int, int]]:
    """As in `Comparison`. Of `near` and `traversal`, only
    where at least one of both says yes: else all that is far apart would count."""
    limits = scene.symbols
    size = [size_of(t, limits) == size_of(s, limits) for t, s in pairs]
    scattered = [is_scattered(t, limits) == is_scattered(s, limits) for t, s in pairs]
    near = [
        tuple(are_near(a[side].ellipse, b[side].ellipse, limits) for side in (0, 1))
        for a, b in itertools.combinations(pairs, 2)
    ]
    between = [
        tuple(
            lies_between(m[s].ellipse, a[s].ellipse.centre, b[s].ellipse.centre, limits.traversal)
            for s in (0, 1)
        )
        for a, b, m in itertools.permutations(pairs, 3)
    ]
    said = {"near": near, "traversal": between}
    return (
        {"size": (sum(size), len(size)), "scattered": (sum(scattered), len(scattered))}
        | {
            name: (sum(t == s for t, s in both if t or s), sum(t or s for t, s in both))
            for name, both in said.items()
        }
        | {f"{name}, all": (sum(t == s for t, s in both), len(both)) for name, both in said.items()}
    )
