"""One action, tried on one layout: what truly became of the dirt that it was meant for (§3.3.2).

Here, as in a report, the truth is asked: no plan and no rule is made from what this module finds by itself.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from dataclasses import dataclass, replace
from multiprocessing import get_context
from typing import TypeVar

import numpy as np

from cleancli.array_types import Bools, Points
from cleancli.execution.seeds import Stream, derived
from cleancli.geometry.ellipse import Ellipse, contains
from cleancli.motion.actions import ARITIES, tool_path
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area
from cleancli.perception.look import FRAMES_PER_LOOK
from cleancli.perception.perceive import perceive
from cleancli.perception.surface import NoSurface
from cleancli.perception.tracking import track
from cleancli.scene.model import Scene
from cleancli.world.robot import Status, finish
from cleancli.world.table import PybulletTable, Truth

GATHERING = ("join2", "join3", "groupScattered")
"""The actions that leave dirt on the surface on purpose (§3.2.3)."""

MARGIN = 0.005
"""Metres around an area's ellipse within which a particle's middle belongs to it."""


class TrialResult(enum.Enum):
    """How a trial ended; docs/physics.md defines the first three."""

    NONE_LEFT = "none left"
    SOME_LEFT = "some left"
    SPREAD_OUT = "spread out"
    FAILED = "failed"  # the robot could not follow its path
    NOT_TRIED = "not tried"  # too few areas were seen, or not the ones asked for


COUNTED = (TrialResult.NONE_LEFT, TrialResult.SOME_LEFT, TrialResult.SPREAD_OUT)
"""The outcomes of which shares are given; in the other trials nothing was done."""


@dataclass(frozen=True, slots=True)
class Trial:
    """One try. `targets`: how many pieces of dirt the action was meant for, particles or cells of ink; `left`
    of them on the table. `lost`: particles on the floor, None where nobody knows. `before` and `after`
    (n, 2): where all dirt lay on the table; `stroke` (n, 2): where the tool was meant to go on the surface.
    `seconds` of robot time. `failure`: why the robot could not follow its path, or nothing."""

    seed: int
    outcome: TrialResult
    targets: int
    left: int
    lost: int | None
    seconds: float
    before: Points
    after: Points
    stroke: Points
    failure: str = ""


def attempt(
    scene: Scene,
    action: str,
    names: Sequence[str],
    seed: int,
    path_of: Callable[[str, tuple[Ellipse, ...], Scene], ToolPath] = tool_path,
) -> Trial:
    """Look once, carry the action out on the areas of these `names` (the first ones seen, if there are none),
    and see what is left of their dirt. The seed decides where the dirt lies, and all noise.

    Raises NoSkill if the scene's robot doesn't have the action.
    """
    arity = ARITIES[action]
    with closing(PybulletTable(scene, derived(seed, Stream.WORLD))) as table:
        rng = np.random.default_rng(derived(seed, Stream.PERCEPTION))
        frames = [table.observe() for _ in range(FRAMES_PER_LOOK)]
        start = table.truth()
        try:
            chosen = chosen_areas(track((), perceive(frames, scene, rng).areas, None, 1).areas, names, arity)
        except NoSurface:
            chosen = ()
        if len(chosen) < arity:
            lay = _on_surface(start), _on_surface(start)
            return Trial(seed, TrialResult.NOT_TRIED, 0, 0, 0, 0.0, *lay, np.empty((0, 2)))
        ellipses = tuple(area.ellipse for area in chosen)
        targets = _within(start.positions[:, :2], ellipses)
        path = path_of(action, ellipses, scene)
        table.start(path)
        status = finish(table)
        end = table.truth()
        before = _meant(start, targets, ellipses)
        after = _meant(end, targets & _on_table(end), ellipses)
        outcome = TrialResult.FAILED
        if status is not Status.FAILED:
            outcome = judge(before, after, action in GATHERING, arity, scene.symbols.link)
        sizes = len(before), len(after), end.on_floor
        lay = _on_surface(start), _on_surface(end)
        return Trial(
            seed, outcome, *sizes, table.clock, *lay, np.array(path.stroke).reshape(-1, 2), table.failure
        )


def judge(before: Points, after: Points, gathering: bool, areas: int, link: float) -> TrialResult:
    """What became of the dirt of so many areas, which lay at `before` (n, 2); `after` (m, 2) is where what is
    left of it lies on the table. Middles closer than `link` make one group."""
    groups = len(linked(after, link))
    has_shrunk = gathering and groups == areas == 1 and extent(after) < extent(before)
    return ended(groups, gathering, areas, has_shrunk)


def ended(groups: int, gathering: bool, areas: int, has_shrunk: bool) -> TrialResult:
    """What became of the dirt of so many areas that is now so many groups; `has_shrunk`: a group that was
    one area reaches less far than that did."""
    if groups > areas:
        return TrialResult.SPREAD_OUT
    if gathering:
        together = groups == 0 or (groups == 1 and (areas > 1 or has_shrunk))
        return TrialResult.NONE_LEFT if together else TrialResult.SOME_LEFT
    return TrialResult.SOME_LEFT if groups else TrialResult.NONE_LEFT


def linked(points: Points, link: float) -> tuple[tuple[int, ...], ...]:
    """Groups of points (n, 2), by number: chains of points closer than `link` lead through all of a group."""
    left = set(range(len(points)))
    groups = []
    while left:
        reached = [min(left)]
        left.remove(reached[0])
        for point in reached:
            gaps = np.linalg.norm(points - points[point], axis=1)
            found = [other for other in left if gaps[other] < link]
            left.difference_update(found)
            reached += found
        groups.append(tuple(sorted(reached)))
    return tuple(groups)


def extent(points: Points) -> float:
    """The largest distance between two of the points (n, 2); 0 for fewer than two."""
    if len(points) < 2:
        return 0.0
    return float(np.linalg.norm(points[:, None] - points[None], axis=2).max())


def chosen_areas(seen: Sequence[Area], names: Sequence[str], arity: int) -> tuple[Area, ...]:
    """The areas asked for, as far as they were seen; the first `arity`, where none were asked for."""
    if not names:
        return tuple(seen[:arity])
    found = {area.name: area for area in seen}
    return tuple(found[name] for name in names if name in found)


def _within(points: Points, ellipses: Sequence[Ellipse]) -> Bools:
    """Which points (n, 2) belong to any of the ellipses, (n,)."""
    wider = [replace(e, axes=(e.axes[0] + MARGIN, e.axes[1] + MARGIN)) for e in ellipses]
    return np.asarray(np.any([contains(ellipse, points) for ellipse in wider], axis=0))


def _on_table(truth: Truth) -> Bools:
    """Which particles are still on the table, and not in its zone, (total,)."""
    same = (truth.positions[:, None] == truth.left[None]).all(axis=2)
    return np.asarray(same.any(axis=1))


def _meant(truth: Truth, targets: Bools, ellipses: Sequence[Ellipse]) -> Points:
    """Where these particles lie, and the ink within the ellipses, (n, 2)."""
    return np.concatenate((truth.positions[targets, :2], truth.ink[_within(truth.ink[:, :2], ellipses), :2]))


def _on_surface(truth: Truth) -> Points:
    """Where all dirt of the table lies, (n, 2)."""
    return np.concatenate((truth.left[:, :2], truth.ink[:, :2]))


_Outcome = TypeVar("_Outcome")


def in_order(try_one: Callable[[int], _Outcome], seeds: Sequence[int], jobs: int) -> Iterator[_Outcome]:
    """What came of these seeds in their order, so many at a time."""
    if jobs == 1:
        yield from map(try_one, seeds)
        return
    # A fork would share what the engine and OpenCV have loaded; a fresh process shares nothing.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(try_one, seeds)
