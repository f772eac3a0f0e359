"""The strategies that planning is compared with (§6): reactive, a fixed wipe, and Hess et al. (2013).

They know where areas are, and nothing of what actions do. What is excluded they leave out.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, dist

import numpy as np

from cleancli.array_types import Floats, Points
from cleancli.execution.episode_state import Move
from cleancli.execution.setup import Decision, DecisionContext, EpisodeOptions, Job
from cleancli.execution.tsp import shortest_path
from cleancli.geometry.ellipse import Ellipse, boundary
from cleancli.motion.actions import TO_ZONE, gathering, into_container, path_along, tool_path
from cleancli.motion.corners import direction
from cleancli.motion.path import ToolPath
from cleancli.motion.pick_up import pick_up
from cleancli.motion.wiping import up_and_down, wiping
from cleancli.perception.area import Area
from cleancli.perception.symbols import place_at_mouth
from cleancli.scene.model import Scene

SPECK = 1e-3
"""Metres of half the size of dirt that stands for the beginning of a line into the zone."""

OVERLAP = 0.02
"""Metres by which neighbouring lines of the wipe overlap: more than the tool's error. Chosen."""


def nearest_first(now: DecisionContext, options: EpisodeOptions) -> Decision:
    """Reactive (§6): clean the area farthest from the goal, then always the one nearest to the arm; wiping
    has no goal."""
    scene = _scene(now)
    for action in now.job.cleaning:
        left = [area for area in now.situation.areas if (action, (area.name,)) not in now.excluded]
        if left and now.number == 0 and now.job is not Job.WIPE:
            return _clean(action, max(left, key=lambda area: _to_goal(area, now.job, scene)))
        if left:
            here = now.tool or (0.0, 0.0)
            return _clean(action, min(left, key=lambda area: dist(area.ellipse.centre, here)))
    return Decision(())


def gather_all(now: DecisionContext, options: EpisodeOptions) -> Decision:
    """Hess et al. (2013) as §6 does it: push all along the shortest path through all areas, then clean once.

    The path ends at the area nearest to the goal, where one cleaning action is then due. What is left is
    gathered again. Wiping gathers nothing: then all is wiped along that path.
    """
    scene = _scene(now)
    areas = now.situation.areas
    if len(areas) > 1:
        points = np.array([area.ellipse.centre for area in areas])
        end = min(range(len(areas)), key=lambda index: _to_goal(areas[index], now.job, scene))
        order = tuple(areas[index] for index in shortest_path(points, end, now.seed))
        names, ellipses = tuple(area.name for area in order), tuple(area.ellipse for area in order)
        if ("gather", names) not in now.excluded:
            if now.job is Job.WIPE:
                return Decision((Move("gather", names, wiping(ellipses, scene, ())),))
            path = path_along(gathering(ellipses), scene)
            return Decision((Move("gather", names, path), Move(now.job.cleaning[0], names[-1:])))
    return nearest_first(now, options)


def wipe_all(now: DecisionContext, options: EpisodeOptions) -> Decision:
    """A fixed program (§6): straight lines over the bounding box of the dirt, one beside the other.

    To the container each line leads from the far end of the box; lines beside the mouth bend before the edge.
    The first is the one on the right of the robot, which looks at the surface from behind the container. With
    a dustpan, each line leads from right to left, where the dustpan waits; the first is the farthest. Ink is
    wiped up and down each line. To a zone each leads from the side of the box that is away from it.
    """
    if not now.situation.areas:
        return Decision(())
    scene = _scene(now)
    points = np.concatenate([boundary(area.ellipse) for area in now.situation.areas])
    out = _goal_ahead(points, now.job, scene)
    left = np.array((out[1], -out[0]))
    ahead, aside = points @ out, points @ left
    if now.job is Job.DUSTPAN:
        begin, end = aside.min() * left, aside.max() * left
        rows = [row * out for row in _rows(ahead, scene.rag.width)]
        paths = [_to_dustpan(row + begin, row + end, scene) for row in rows]
    else:
        far, near = ahead.min() * out, ahead.max() * out
        rows = [row * left for row in _rows(aside, scene.rag.width)]
        paths = [_line(far + row, near + row, row, now.job, scene) for row in rows]
    return Decision(tuple(Move("wipe", (), path) for path in paths))


def _goal_ahead(points: Points, job: Job, scene: Scene) -> Floats:
    """The unit vector (2,) in which the goal of dirt at points (n, 2) lies."""
    if job is not Job.ZONE or scene.zone is None:
        return np.array(scene.outwards())
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    return np.array(direction(_pair(middle), scene.zone.centre))


def _rows(places: Floats, width: float) -> list[float]:
    """The middles of as few lines of some width as cover all places (n,) with an overlap, in order; without
    those below which none lies."""
    low, high = float(places.min()), float(places.max())
    pitch = max(width - OVERLAP, width / 2)
    number = max(1, ceil((high - low - width) / pitch) + 1)
    middle = (low + high) / 2
    rows = [middle + pitch * (index - (number - 1) / 2) for index in range(number)]
    return [row for row in rows if (np.abs(places - row) <= width / 2).any()]


def _line(far: Floats, near: Floats, row: Floats, job: Job, scene: Scene) -> ToolPath:
    """Up and down between both ends of a line where ink is wiped away; otherwise from the far one out, or
    into the zone."""
    if job is Job.ZONE:
        return tool_path(TO_ZONE[0], (Ellipse(_pair(far + row), (SPECK, SPECK), 0.0),), scene)
    if job is Job.WIPE:
        return up_and_down(((_pair(far), _pair(near)),), scene)
    return _line_out(far, row, scene)


def _line_out(start: Floats, row: Floats, scene: Scene) -> ToolPath:
    """Straight on until a rag's width before the edge, and from there into the container."""
    out = np.array(scene.outwards())
    edge = float(np.array(scene.mouth()[0]) @ out)
    before = max(edge - scene.rag.width, float(start @ out)) * out + row
    return path_along((_pair(start), *into_container(_pair(before), scene, ())), scene)


def _to_dustpan(begin: Floats, end: Floats, scene: Scene) -> ToolPath:
    middle, half = (begin + end) / 2, (end - begin) / 2
    angle = float(np.arctan2(half[1], half[0]))
    return pick_up((Ellipse(_pair(middle), (float(np.linalg.norm(half)), 1e-3), angle),), scene)


def _clean(action: str, area: Area) -> Decision:
    return Decision((Move(action, (area.name,)),))


def _to_goal(area: Area, job: Job, scene: Scene) -> float:
    if job is Job.ZONE and scene.zone is not None:
        return dist(area.ellipse.centre, scene.zone.centre)
    return dist(area.ellipse.centre, place_at_mouth(area.ellipse.centre, scene))


def _scene(now: DecisionContext) -> Scene:
    assert now.scene is not None, "strategies that need places are not offered without"
    return now.scene


def _pair(point: Sequence[float] | Floats) -> tuple[float, float]:
    return float(point[0]), float(point[1])
