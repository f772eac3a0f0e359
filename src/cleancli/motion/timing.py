"""Time-parametrises a joint path under limits of joint speed, joint acceleration and tool speed.

The one place where TOPP-RA (the library `toppra`) is imported, which finds the quickest such timing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cleancli.array_types import Floats

_FEWEST = 25  # places at which limits are kept, on however short a path


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """Of each joint: speed (rad/s or m/s) and acceleration, (n,) each."""

    speed: tuple[float, ...]
    acceleration: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Course:
    """Where the joints go, from rest to rest: `joints` (n, d); `places` (n,) metres of tool path behind each,
    increasing; `speeds` (n,) the highest tool speed from the place before to each, m/s."""

    joints: Floats
    places: Floats
    speeds: Floats


def timed(course: Course, limits: SpeedLimits, step: float) -> Floats:
    """(k, d) joints after each `step` of the quickest motion, the last of them the course's end."""
    if len(course.places) < 2:
        return course.joints[:0]
    toppra, constraint, algorithm = _toppra()
    size = course.joints.shape[1]
    path = toppra.SplineInterpolator(course.places, np.column_stack((course.joints, course.places)))
    fastest = np.array(limits.speed)

    def speed_limits(place: float) -> Floats:
        piece = int(np.clip(np.searchsorted(course.places, place), 1, len(course.places) - 1))
        following = min(piece + 1, len(course.places) - 1)
        pace = course.speeds[piece]
        if place >= course.places[piece]:
            pace = min(pace, course.speeds[following])
        highest = np.append(fastest, pace)
        return np.column_stack((-highest, highest))

    highest = np.array((*limits.acceleration, _FREE))
    bounds = [
        constraint.JointVelocityConstraintVarying(speed_limits),
        constraint.JointAccelerationConstraint(np.column_stack((-highest, highest))),
    ]
    grid = _grid(course.places)
    solver = algorithm.TOPPRA(bounds, path, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    trajectory = solver.compute_trajectory(0, 0)
    assert trajectory is not None, "a path from rest to rest can always be timed: slowly"
    times = np.minimum(
        np.arange(1, int(np.ceil(trajectory.duration / step - 1e-9)) + 1) * step, trajectory.duration
    )
    sampled: Floats = trajectory(times)[:, :size]
    return sampled


_FREE = 1e3  # m/s² of the tool along its path: the joints' limits decide


def _grid(places: Floats) -> Floats:
    """Places to keep the limits at: those given, with more between them on a short path."""
    finer = int(np.ceil(_FEWEST / (len(places) - 1)))
    grid: Floats = np.interp(np.arange((len(places) - 1) * finer + 1) / finer, np.arange(len(places)), places)
    return grid


def _toppra() -> tuple[Any, Any, Any]:
    import toppra
    from toppra import algorithm, constraint

    return toppra, constraint, algorithm
