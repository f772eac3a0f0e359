"""What the bound's strokes and the strategies do on the fast stand-in for the table (docs/world.md), with
some of what makes it hard switched off (benchmarks/bound.py)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from functools import lru_cache
from unittest.mock import patch

import numpy as np
from bound_strokes import Layout, Stroke, bits, stroke_path
from episodes import Job
from strategies import Row, run_stand_in

from cleancli.array_types import Bools, Floats
from cleancli.execution.seeds import Stream, derived
from cleancli.geometry.ellipse import Point
from cleancli.scene.model import Scene
from cleancli.world import constants as par
from cleancli.world.kinematic import KinematicTable
from cleancli.world.robot import finish
from cleancli.world.robots.gantry import resting_pose
from cleancli.world.table import PybulletTable, Truth

VARIANTS = ("stand-in", "no errors", "no errors, nothing hidden")
"""What a strategy plays: with all errors of its strokes; without; and without anything hidden either."""


class Unhidden(KinematicTable):
    """A table on which looks see all: they find the tool at rest, beside the table, wherever it is."""

    @property
    def pose(self) -> Floats:
        """Where the tool rests, (4,)."""
        return resting_pose(self._scene)


def layout_of(scene: Scene, seed: int) -> Layout:
    """Where the particles lie when an episode with this seed begins."""
    return Layout(scene, seed, _table(scene, seed).dirt)


@lru_cache(maxsize=4096)
def is_sound(one: Stroke, layout: Layout) -> bool:
    """Whether the stroke takes from the untouched table what it is meant to, and moves nothing else without
    taking it: then it does the same after other sound strokes."""
    truth = _played((one,), layout)[0]
    gone, moved = _gone(truth, layout.scene), (truth.positions[:, :2] != layout.places).any(axis=1)
    return not one.takes & ~bits(gone) and not (moved & ~gone).any() and not truth.on_floor


def carried_out(strokes: Iterable[Stroke], layout: Layout) -> tuple[float, int]:
    """Seconds from rest to the end of the last stroke, without errors, and how many particles are then not in
    the container."""
    truth, seconds = _played(strokes, layout)
    return seconds, truth.total - truth.in_container


def carried_out_in_physics(strokes: Iterable[Sequence[Point]], scene: Scene, seed: int) -> tuple[float, int]:
    """The same of strokes with these corners on the simulated table itself."""
    with closing(PybulletTable(scene, derived(seed, Stream.WORLD))) as table, without_errors():
        for corners in strokes:
            table.start(stroke_path(corners, scene))
            finish(table)
        truth = table.truth()
        return table.clock, truth.total - truth.in_container


def episode(job: Job, variant: str) -> Row:
    """An episode of a strategy on the stand-in, with what the variant switches off."""
    if variant == VARIANTS[0]:
        return run_stand_in(job)
    with without_errors():
        return run_stand_in(job, KinematicTable if variant == VARIANTS[1] else Unhidden)


@contextmanager
def without_errors() -> Iterator[None]:
    """While no stroke has an error."""
    with patch.multiple(par, HEIGHT_NOISE=0.0, SIDE_NOISE=0.0, YAW_NOISE=0.0):
        yield


def _played(strokes: Iterable[Stroke], layout: Layout) -> tuple[Truth, float]:
    table = _table(layout.scene, layout.seed)
    with without_errors():
        for one in strokes:
            table.start(stroke_path(one.corners, layout.scene))
            finish(table)
    return table.truth(), table.clock


def _table(scene: Scene, seed: int) -> KinematicTable:
    return KinematicTable(scene, derived(seed, Stream.WORLD))


def _gone(truth: Truth, scene: Scene) -> Bools:
    """(n,) which particles lie no longer on the surface."""
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    return np.asarray((np.abs(truth.positions[:, :2]) > half).any(axis=1))
