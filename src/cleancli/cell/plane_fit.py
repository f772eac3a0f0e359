"""Points measured on the surface against where they should be: a turn and a shift within the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Floats, Points


@dataclass(frozen=True, slots=True)
class Fitted:
    """`pose` (4, 4): from the coordinates that points were measured in to those that they should have, z left
    as it is. `scale`: how much larger the points should lie than they were measured, which `pose` leaves out;
    `misfit`: root of their mean squared distance then, metres."""

    pose: Floats
    scale: float
    misfit: float


def fitted(measured: Points, wanted: Points) -> Fitted:
    """The turn and the shift with the least squared distances of `measured` (n, 2) from `wanted` (n, 2).

    Of complex numbers w = a m + b: `a` by least squares is the turn times the scale (Umeyama 1991, in two
    dimensions). At least two different points.
    """
    m, w = (np.ascontiguousarray(points).view(np.complex128).ravel() for points in (measured, wanted))
    m_middle, w_middle = m.mean(), w.mean()
    a = np.vdot(m - m_middle, w - w_middle) / np.vdot(m - m_middle, m - m_middle).real
    turn = a / abs(a)
    shift = w_middle - turn * m_middle
    pose = np.eye(4)
    pose[:2, :2] = [[turn.real, -turn.imag], [turn.imag, turn.real]]
    pose[:2, 3] = shift.real, shift.imag
    misfit = float(np.sqrt((np.abs(turn * m + shift - w) ** 2).mean()))
    return Fitted(pose, float(abs(a)), misfit)
