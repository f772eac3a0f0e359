"""When the tool is where: a path of straight pieces under speed and acceleration limits of four joints.

The joints of a gantry are x, y, z and yaw, so its shortest motion in joint space is straight in x, y, z as
well, and turns yaw on the way: both interpolations of a `ToolPath` are the same piece here. Speed along each
piece rises, holds and falls (a trapezoid); corners are slowed down for, not cut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]

# A turn counts as the way of a point this far from the tool's middle, so that a pure turn has a length too.
_LEVER = 0.06
_SHORTEST = 1e-6  # pieces shorter than this are left out, metres


@dataclass(frozen=True, slots=True)
class Limits:
    """Of x, y, z (m/s, m/s²) and yaw (rad/s, rad/s²); at a corner a joint's speed may jump by what its
    acceleration makes of it within `blend` seconds."""

    speed: tuple[float, float, float, float]
    acceleration: tuple[float, float, float, float]
    blend: float


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A timed path. Pieces: `corners` (n + 1, 4) poses, `directions` (n, 4) per metre of the piece.

    Phases of constant acceleration: `begins` (m,) seconds, `pieces` (m,) the piece of each, `places` (m,)
    metres from the piece's corner, `speeds` (m,), `accelerations` (m,).
    """

    corners: _Array
    directions: _Array
    begins: _Array
    pieces: NDArray[np.int64]
    places: _Array
    speeds: _Array
    accelerations: _Array
    duration: float

    def poses(self, times: _Array) -> _Array:
        """Poses (k, 4) at `times` (k,); before the start and after the end the tool stands."""
        if not len(self.directions):
            return np.repeat(self.corners[:1], len(times), axis=0)
        times = np.clip(times, 0, self.duration)
        phase = np.searchsorted(self.begins, times, side="right") - 1
        since = times - self.begins[phase]
        place = self.places[phase] + since * (self.speeds[phase] + since * self.accelerations[phase] / 2)
        piece = self.pieces[phase]
        poses: _Array = self.corners[piece] + place[:, None] * self.directions[piece]
        return poses


def parametrise(poses: _Array, speeds: _Array, limits: Limits) -> Trajectory:
    """The quickest trapezoids from rest to rest through `poses` (n + 1, 4), at most `speeds` (n,) each.

    Yaw turns the shorter way between neighbouring poses, whatever whole turns they differ by.
    """
    if poses.shape != (len(speeds) + 1, 4):
        raise ValueError(f"{len(speeds)} speeds don't fit poses of shape {poses.shape}")
    corners = np.array(poses, dtype=np.float64)
    corners[:, 3] = np.unwrap(corners[:, 3])
    steps = np.diff(corners, axis=0)
    lengths = np.maximum(np.linalg.norm(steps[:, :3], axis=1), _LEVER * np.abs(steps[:, 3]))
    kept = lengths > _SHORTEST
    corners, steps, lengths = np.concatenate((corners[:1], corners[1:][kept])), steps[kept], lengths[kept]
    directions = steps / lengths[:, None]
    with np.errstate(divide="ignore", over="ignore"):
        quickest = (np.array(limits.speed) / np.abs(directions)).min(axis=1, initial=np.inf)
        rates = (np.array(limits.acceleration) / np.abs(directions)).min(axis=1, initial=np.inf)
    top = np.minimum(speeds[kept], quickest)
    passing = _corner_speeds(directions, lengths, top, rates, limits)
    return _phases(corners, directions, lengths, top, rates, passing)


def _corner_speeds(directions: _Array, lengths: _Array, top: _Array, rates: _Array, limits: Limits) -> _Array:
    """(n + 1,) speeds at the corners: nought at both ends, and never more than can be braked from in time."""
    passing = np.zeros(len(lengths) + 1)
    jumps = np.abs(np.diff(directions, axis=0))
    with np.errstate(divide="ignore", over="ignore"):
        bound = (limits.blend * np.array(limits.acceleration) / jumps).min(axis=1, initial=np.inf)
    passing[1:-1] = np.minimum(bound, np.minimum(top[:-1], top[1:]))
    for k in range(len(lengths)):
        passing[k + 1] = min(passing[k + 1], np.sqrt(passing[k] ** 2 + 2 * rates[k] * lengths[k]))
    for k in reversed(range(len(lengths))):
        passing[k] = min(passing[k], np.sqrt(passing[k + 1] ** 2 + 2 * rates[k] * lengths[k]))
    return passing


def _phases(
    corners: _Array, directions: _Array, lengths: _Array, top: _Array, rates: _Array, passing: _Array
) -> Trajectory:
    """Three phases a piece: gain speed, hold it, lose it; a phase may last no time."""
    enter, leave = passing[:-1], passing[1:]
    peak = np.minimum(top, np.sqrt(rates * lengths + (enter**2 + leave**2) / 2))
    gain, lose = (peak**2 - enter**2) / (2 * rates), (peak**2 - leave**2) / (2 * rates)
    hold = np.maximum(lengths - gain - lose, 0)
    lasting = np.stack(((peak - enter) / rates, hold / peak, (peak - leave) / rates), axis=1).ravel()
    ends = np.cumsum(lasting)
    return Trajectory(
        corners=corners,
        directions=directions,
        begins=ends - lasting,
        pieces=np.repeat(np.arange(len(lengths)), 3),
        places=np.stack((np.zeros_like(gain), gain, gain + hold), axis=1).ravel(),
        speeds=np.stack((enter, peak, peak), axis=1).ravel(),
        accelerations=np.stack((rates, np.zeros_like(rates), -rates), axis=1).ravel(),
        duration=float(ends[-1]) if len(ends) else 0.0,
    )
