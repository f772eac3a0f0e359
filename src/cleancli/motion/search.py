"""Sampling-based path planning in a box of numbers (OMPL, which is imported here alone).

Used for the elbow's swivel along a line of tool poses, and for joints between two strokes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cleancli.array_types import Floats

RANGE = 1.2  # rad of the planner's steps, chosen: it finds ways quickest
_PULLS = 8  # of which every second is half as strong as the two before
MayGo = Callable[[Floats, Floats], bool]


def way(
    box: tuple[Floats, Floats], starts: Floats, goals: Floats, may_go: MayGo, seed: int, rounds: int
) -> Floats | None:
    """(k, d) points from one of `starts` (n, d) to one of `goals` (m, d), or None after so many `rounds`.

    `box` is the lowest and the highest corner (d,); `may_go` tells whether a straight step from one point to
    another is allowed, in that direction. RRTConnect finds the way, and then every detour is left out that
    can be. The same arguments give the same way: `seed` feeds all that OMPL draws.
    """
    base, geometric, util = _ompl()
    util.setLogLevel(util.LogLevel.LOG_NONE)
    util.RNG.setSeed(seed)
    size = len(box[0])
    space = base.RealVectorStateSpace(size)
    bounds = base.RealVectorBounds(size)
    for axis in range(size):
        bounds.setLow(axis, float(box[0][axis]))
        bounds.setHigh(axis, float(box[1][axis]))
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(lambda state: True)  # a step's ends are checked with the step
    information.setMotionValidator(_validator(base, information, size, may_go))
    for start in starts:
        setup.addStartState(_state(space, start))
    targets = base.GoalStates(information)
    for goal in goals:
        targets.addState(_state(space, goal))
    setup.setGoal(targets)
    planner = geometric.RRTConnect(information)
    planner.setRange(RANGE)
    setup.setPlanner(planner)
    left = iter(range(rounds))
    status = setup.solve(base.PlannerTerminationCondition(lambda: next(left, None) is None))
    if not setup.haveExactSolutionPath() or not status:
        return None
    found = np.array([state[0:size] for state in setup.getSolutionPath().getStates()])
    return _pulled(_shortened(found, may_go), may_go)


def _shortened(points: Floats, may_go: MayGo) -> Floats:
    """From each point straight to the last one that can be gone to."""
    kept = [0]
    while kept[-1] < len(points) - 1:
        here = kept[-1]
        kept.append(
            next(
                (k for k in range(len(points) - 1, here + 1, -1) if may_go(points[here], points[k])), here + 1
            )
        )
    shorter: Floats = points[kept]
    return shorter


def _pulled(points: Floats, may_go: MayGo) -> Floats:
    """The same way pulled tight: inner points move towards the middle of their neighbours while they can."""
    tight = points.copy()
    for pull in range(_PULLS):
        share = 0.5 ** (1 + pull // 2)
        for k in range(1, len(tight) - 1):
            tighter = tight[k] + share * ((tight[k - 1] + tight[k + 1]) / 2 - tight[k])
            if may_go(tight[k - 1], tighter) and may_go(tighter, tight[k + 1]):
                tight[k] = tighter
    return tight


def _state(space: Any, point: Floats) -> Any:
    state = space.allocState()
    state[0 : len(point)] = point.tolist()
    return state


def _validator(base: Any, information: Any, size: int, may_go: MayGo) -> Any:
    class Steps(base.MotionValidator):  # type: ignore[misc]
        def checkMotion(self, begin: Any, end: Any) -> bool:  # noqa: N802 (OMPL's name)
            return may_go(np.array(begin[0:size]), np.array(end[0:size]))

    return Steps(information)


def _ompl() -> tuple[Any, Any, Any]:
    from ompl import base, geometric, util

    return base, geometric, util
