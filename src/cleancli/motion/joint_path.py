"""From tool poses to the joints of an arm: along a straight line, along the bow of a joint-space motion
(§3.2.1), and through the air between strokes. What can't be done is refused before anything moves
(`Unreachable`)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.motion.arm import (
    BRANCHES,
    SWIVELS,
    Arm,
    costs,
    everywhere,
    forward,
    inverse,
    poses,
    swivel_of,
    why_not,
)
from cleancli.motion.clearance import clear
from cleancli.motion.legs import LEVER, SPACING, Leg, lengths
from cleancli.motion.path import Interpolation, Unreachable
from cleancli.motion.search import way
from cleancli.motion.timing import Course

TILTS = tuple(np.radians((0.0, 10.0, -10.0, 20.0, -20.0)))  # of the tool, tried in this order, chosen
SWIVEL_RATE = 8.0  # rad the elbow may swivel a metre of tool path, chosen
LARGEST_STEP = 0.15  # rad a joint may turn between neighbouring poses of a stroke: more is a jump, chosen
LARGEST_TURN = 0.5  # rad the tool of a joint-space motion may turn away from its push meanwhile, chosen
AIR = 0.025  # the rag keeps so far above the surface between strokes, chosen
RAISE = 0.10  # a way through the air that would come too low is raised by this in its middle, chosen
_COARSE = 8  # poses of a line apart that are looked at to choose a branch
_AIR_STEP = 0.04  # rad between joints of a way through the air
_ROUNDS = 800  # of OMPL: far more than it needed in any of 300 strokes (docs/world.md)
COMFORT = 0.3  # seconds that one unit of `costs` is worth when a joint-space motion is chosen, chosen
_AT_ONCE = 100  # poses, for the sake of memory
_PAIRS = 200


@dataclass(frozen=True, slots=True)
class Lean:
    """How a tool may lean on its way: its tilt from `least` to `most`, and `aside` either way, radians."""

    least: float
    most: float
    aside: float


ANY_LEAN = Lean(-np.pi, np.pi, np.pi)


def stroke(
    arm: Arm, legs: Sequence[Leg], interpolation: Interpolation, here: Floats, seed: int
) -> tuple[Floats, ...]:
    """Joints (n, 7) for each leg of an action's path, beginning and ending above the surface.

    Of the many ways one is preferred whose beginning is near the joints `here` (7,). Raises Unreachable.
    `seed` feeds the planner's draws.
    """
    failures = []
    for tilt in TILTS:
        try:
            if interpolation is Interpolation.STRAIGHT:
                return _split(straight(arm, _joined(legs), tilt, here, seed), legs)
            return _split(bowed(arm, legs, tilt, here), legs)
        except Unreachable as failure:
            failures.append(failure)
    raise failures[0]


def straight(arm: Arm, points: Floats, tilt: float, here: Floats, seed: int) -> Floats:
    """Joints (n, 7) that bring the tool exactly to each of `points` (n, 4): x, y, z, yaw.

    The elbow keeps one swivel where that is possible. Otherwise OMPL plans how it swivels: a way through the
    plane of tool way and swivel, on one branch of the inverse kinematics, that keeps all limits, no joint
    jumping. The way of the tool is counted in radians that the elbow may swivel on it.
    """
    ways = SWIVEL_RATE * np.append(0, np.cumsum(lengths(points)))
    some = [*range(0, len(points) - 1, _COARSE), len(points) - 1]
    frames = poses(points[some], np.full(len(some), tilt))
    found = everywhere(arm, frames)
    cost = _free_costs(arm, found)
    _refuse_unreached(arm, points[some], frames, cost)
    cost[0] += _seconds(arm, here, found[0]) / COMFORT
    box = np.array((0, -np.pi)), np.array((ways[-1], np.pi))
    steps = [(branch, partial(_may_follow, arm, points, ways, tilt, branch)) for branch in _ranked(cost)]
    for branch, may_go in steps:
        both = _places(ways[-1], cost[0, :, branch] + cost[-1, :, branch])
        for _, swivel in both:
            if may_go(np.array((0.0, swivel)), np.array((ways[-1], swivel))):
                return _solved(arm, points, tilt, np.full(len(points), swivel), branch)
    for branch, may_go in steps:
        starts, goals = _places(0.0, cost[0, :, branch]), _places(ways[-1], cost[-1, :, branch])
        path = way(box, starts, goals, may_go, seed, _ROUNDS)
        if path is not None:
            return _solved(arm, points, tilt, np.interp(ways, path[:, 0], path[:, 1]), branch)
    raise Unreachable(points[0, 0], points[0, 1], "no way along the whole stroke keeps the joints' limits")


def bowed(arm: Arm, legs: Sequence[Leg], tilt: float, here: Floats) -> Floats:
    """As `straight`, but level legs go as motions that are straight in joint space would take the tool.

    Such a motion would also lift the tool off the surface, or press it in: its height and tilt are corrected,
    its bow over the surface and its turn are left (docs/world.md says how large they are).
    """
    points = _joined(legs)
    level = np.concatenate([np.full(len(leg.points), leg.level) for leg in legs])
    ways = np.append(0, np.cumsum(lengths(points) * (level[1:] & level[:-1])))
    ends = points[[np.flatnonzero(level)[0], np.flatnonzero(level)[-1]]]
    frames = poses(ends, np.full(2, tilt))
    found = everywhere(arm, frames)
    cost = _free_costs(arm, found)
    _refuse_unreached(arm, ends, frames, cost)
    cost[0] += _seconds(arm, here, found[0]) / COMFORT
    for branch, first, last in _pairs(arm, found, cost):
        swivels = np.interp(ways, (0, max(ways[-1], SPACING)), (SWIVELS[first], SWIVELS[last]))
        joints = _bow(arm, legs, swivels, tilt, branch)
        if _smooth(joints) and clear(arm, joints).all():
            return joints
    raise Unreachable(ends[0, 0], ends[0, 1], "no joint-space motion from there keeps the joints' limits")


def through_air(
    arm: Arm, begin: Floats, end: Floats, half_width: float, seed: int, lean: Lean = ANY_LEAN
) -> Floats:
    """Corners (k, 7) of a way from joints `begin` (7,) to `end` (7,) that keeps the links clear, the tool, so
    far to both sides of its middle, off the surface, and tilted as `lean` allows.

    Straight in joint space where that is possible, or over a raised middle; planned with OMPL otherwise.
    Raises Unreachable.
    """

    def may_go(here: Floats, there: Floats) -> bool:
        count = max(2, int(np.ceil(np.abs(there - here).max() / _AIR_STEP)) + 1)
        dense = here + np.linspace(0, 1, count)[:, None] * (there - here)
        return bool(_in_air(arm, dense, half_width, lean).all())

    if may_go(begin, end):
        return np.stack((begin, end))
    over = _raised_middle(arm, begin, end)
    if over is not None and may_go(begin, over) and may_go(over, end):
        return np.stack((begin, over, end))
    box = np.minimum(np.array(arm.low), begin), np.maximum(np.array(arm.high), begin)
    path = way(box, begin[None], end[None], may_go, seed, _ROUNDS)
    if path is None:
        place = forward(arm, end[None])[0, :2, 3]
        raise Unreachable(
            place[0], place[1], "no way there keeps the links clear of the table and each other"
        )
    return path


def _raised_middle(arm: Arm, begin: Floats, end: Floats) -> Floats | None:
    """Joints (7,) near the middle of the straight way in joint space, with the tool upright and raised."""
    middle = (begin + end) / 2
    tool = forward(arm, middle[None])[0]
    yaw = np.arctan2(-tool[0, 1], tool[1, 1])
    point = np.array((*tool[:2, 3], tool[2, 3] + RAISE, yaw))
    swivel, branch = swivel_of(arm, middle)
    joints = inverse(arm, poses(point[None], np.zeros(1)), np.array([swivel]), branch[None])[0]
    return joints if np.isfinite(joints).all() else None


def air_course(arm: Arm, begin: Floats, end: Floats, speed: float) -> Course:
    """A straight way in joint space as a course at that tool speed."""
    count = max(2, int(np.ceil(np.abs(end - begin).max() / _AIR_STEP)) + 1)
    return course(arm, begin + np.linspace(0, 1, count)[:, None] * (end - begin), np.full(count, speed))


def course(arm: Arm, joints: Floats, speeds: Floats) -> Course:
    """Joints (n, 7) with the way of the tool behind each; a turn of a joint counts as way too."""
    tool = forward(arm, joints)[:, :3, 3]
    steps = np.linalg.norm(np.diff(tool, axis=0), axis=1)
    steps = np.maximum(steps, LEVER * np.abs(np.diff(joints, axis=0)).max(axis=1))
    kept = np.append(True, steps > 1e-9)
    return Course(joints[kept], np.append(0, np.cumsum(steps[kept[1:]])), speeds[kept])


def rise(arm: Arm, begin: Floats, leg: Leg) -> Floats:
    """Joints (n, 7) from `begin` (7,) along a leg straight up, with the elbow's swivel as it is, as far as
    the arm can: at least `begin` itself."""
    tool = forward(arm, begin[None])[0]
    tilts = np.full(len(leg.points), np.arcsin(np.clip(-tool[2, 0], -1, 1)))
    swivel, branch = swivel_of(arm, begin)
    rest = inverse(
        arm, poses(leg.points, tilts), np.full(len(tilts), swivel), np.tile(branch, (len(tilts), 1))
    )
    missed = np.flatnonzero(~np.isfinite(rest[1:]).all(axis=1))
    end = len(rest) if not len(missed) else 1 + int(missed[0])
    return np.concatenate((begin[None], rest[1:end]))


def nearest_pose(arm: Arm, point: Floats) -> Floats:
    """Joints (7,) for one pose (x, y, z, yaw) nearest to the posture, with the smallest tilt. Raises
    Unreachable."""
    for tilt in TILTS:
        found = everywhere(arm, poses(point[None], np.array([tilt])))[0]
        cost = _free_costs(arm, found)
        if np.isfinite(cost).any():
            best: Floats = found.reshape(-1, 7)[np.argmin(cost)]
            return best
    raise Unreachable(point[0], point[1], why_not(arm, poses(point[None], np.zeros(1))[0]))


def reached(arm: Arm, points: Floats) -> Bools:
    """(n,) whether the arm can bring its tool to each of `points` (n, 4), tilted if need be."""
    able = np.zeros(len(points), dtype=bool)
    for tilt in TILTS:
        left = np.flatnonzero(~able)
        for some in np.array_split(left, len(left) // _AT_ONCE + 1):
            found = everywhere(arm, poses(points[some], np.full(len(some), tilt)))
            able[some] = np.isfinite(_free_costs(arm, found)).any(axis=(1, 2))
    return able


def _free_costs(arm: Arm, found: Floats) -> Floats:
    """`costs` of joints (..., 7), infinite also where links would touch something."""
    cost = costs(arm, found)
    some = np.isfinite(cost)
    cost[some] = np.where(clear(arm, found[some]), cost[some], np.inf)
    return cost


def _refuse_unreached(arm: Arm, points: Floats, frames: Floats, cost: Floats) -> None:
    """Raise for the first of some poses that has no solution at all."""
    missed = np.flatnonzero(~np.isfinite(cost).any(axis=(1, 2)))
    if len(missed):
        (x, y), frame = points[missed[0], :2], frames[missed[0]]
        raise Unreachable(x, y, why_not(arm, frame))


def _places(where: float, cost: Floats) -> Floats:
    """(k, 2) places of one end of a stroke with its swivels, the most comfortable by `cost` (48,) first."""
    best = [k for k in np.argsort(cost, kind="stable") if np.isfinite(cost[k])]
    return np.column_stack((np.full(len(best), where), SWIVELS[best]))


def _seconds(arm: Arm, begin: Floats, end: Floats) -> Floats:
    """(...,) the shortest time from joints `begin` (..., 7) to `end` (..., 7) at full speed, infinite for
    NaN."""
    seconds = (np.abs(end - begin) / np.array(arm.speed)).max(axis=-1)
    return np.where(np.isnan(seconds), np.inf, seconds)


def _ranked(cost: Floats) -> list[int]:
    """Branches that reach every pose of `cost` (n, 48, 8), the most comfortable first."""
    best = cost.min(axis=1)
    total = best[0] + best.max(axis=0)
    return [int(branch) for branch in np.argsort(total, kind="stable") if np.isfinite(total[branch])]


def _pairs(arm: Arm, found: Floats, cost: Floats) -> Iterator[tuple[int, int, int]]:
    """Branch and swivels at both ends of `found` (2, 48, 8, 7), the shortest motions in joint space first."""
    times = _seconds(arm, found[0][:, None], found[1][None]) + COMFORT * (cost[0][:, None] + cost[1][None])
    order = np.argsort(times, axis=None, kind="stable")[:_PAIRS]
    for first, last, branch in zip(*np.unravel_index(order, times.shape), strict=True):
        if np.isfinite(times[first, last, branch]):
            yield int(branch), int(first), int(last)


def _bow(arm: Arm, legs: Sequence[Leg], swivels: Floats, tilt: float, branch: int) -> Floats:
    """Joints (n, 7) for all legs, the level ones bowed as joint-space motions between their knots are."""
    points, start = [], 0
    for leg in legs:
        here = swivels[start : start + len(leg.points)]
        points.append(_bowed_points(arm, leg, here, tilt, branch) if leg.level else leg.points)
        start += len(leg.points)
    return _solved(arm, np.concatenate(points), tilt, swivels, branch)


def _bowed_points(arm: Arm, leg: Leg, swivels: Floats, tilt: float, branch: int) -> Floats:
    knots = list(leg.knots)
    joints = _solved(arm, leg.points[knots], tilt, swivels[knots], branch)
    ways = np.append(0, np.cumsum(lengths(leg.points)))
    between = np.stack([np.interp(ways, ways[knots], turn) for turn in joints.T], axis=1)
    tool = forward(arm, between)
    yaw = np.arctan2(-tool[:, 0, 1], tool[:, 1, 1])
    turn = (yaw - leg.points[:, 3] + np.pi) % (2 * np.pi) - np.pi
    turn[np.abs(turn) > LARGEST_TURN] = np.nan  # such a motion is no candidate
    return np.column_stack((tool[:, :2, 3], leg.points[:, 2], leg.points[:, 3] + turn))


def _may_follow(
    arm: Arm, points: Floats, ways: Floats, tilt: float, branch: int, here: Floats, there: Floats
) -> bool:
    """Whether the tool can follow the poses between two places (way, swivel)."""
    (begin, first), (end, last) = here, there
    if end <= begin or abs(last - first) > end - begin:
        return False
    inside = (ways > begin) & (ways < end)
    places = np.concatenate(([begin], ways[inside], [end]))
    there = np.stack([np.interp(places, ways, axis) for axis in points.T], axis=1)
    joints = _solved(arm, there, tilt, np.interp(places, (begin, end), (first, last)), branch)
    return _smooth(joints) and bool(clear(arm, joints).all())


def _solved(arm: Arm, points: Floats, tilt: float, swivels: Floats, branch: int) -> Floats:
    count = len(points)
    return inverse(arm, poses(points, np.full(count, tilt)), swivels, np.tile(BRANCHES[branch], (count, 1)))


def _smooth(joints: Floats) -> bool:
    """Whether all joints (n, 7) exist and none jumps; a NaN compares as false."""
    return bool(np.isfinite(joints).all() and (np.abs(np.diff(joints, axis=0)) <= LARGEST_STEP).all())


def _in_air(arm: Arm, joints: Floats, half_width: float, lean: Lean) -> Bools:
    tool = forward(arm, joints)
    lowest = tool[:, 2, 3] - half_width * np.abs(tool[:, 2, 1])
    free: Bools = clear(arm, joints) & (lowest >= AIR) & _leans(tool, lean)
    return free


def _leans(tool: Floats, lean: Lean) -> Bools:
    tilt = np.arcsin(np.clip(-tool[:, 2, 0], -1, 1))
    aside = np.abs(np.arcsin(np.clip(tool[:, 2, 1], -1, 1)))
    within: Bools = (tilt >= lean.least) & (tilt <= lean.most) & (aside <= lean.aside)
    return within


def _joined(legs: Sequence[Leg]) -> Floats:
    return np.concatenate([leg.points for leg in legs])


def _split(joints: Floats, legs: Sequence[Leg]) -> tuple[Floats, ...]:
    return tuple(np.split(joints, np.cumsum([len(leg.points) for leg in legs])[:-1]))
