"""Collision checks of an arm with itself and the table, made before anything moves."""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.motion.arm import Arm, frames

TABLE_GAP = 0.01  # the links stay so far above the level of the surface, chosen
SELF_GAP = 0.01  # and so far from each other, chosen


def clear(arm: Arm, joints: Floats) -> Bools:
    """(n,) whether the links at `joints` (n, 7) touch neither the table nor each other.

    The level of the surface counts as if it had no edges: nothing of an arm goes below it. The base, hull 0,
    stands beside the table. The tool is no link: its place is part of the path.
    """
    ends = hull_ends(arm, joints)
    radii = np.array([hull.radius for hull in arm.hulls])
    above: Bools = (ends[:, 1:, :, 2].min(axis=2) - radii[1:] >= TABLE_GAP).all(axis=1)
    for first, second in arm.apart:
        gap = segment_gaps(ends[:, first], ends[:, second]) - radii[first] - radii[second]
        above &= gap >= SELF_GAP
    return above


def hull_ends(arm: Arm, joints: Floats) -> Floats:
    """(n, hulls, 2, 3) both ends of the middle line of each hull, metres."""
    carriers = frames(arm, joints)[:, [hull.frame for hull in arm.hulls]]
    ends = np.array([(hull.begin, hull.end) for hull in arm.hulls])
    turned: Floats = np.einsum("nhij,hkj->nhki", carriers[..., :3, :3], ends)
    return turned + carriers[..., None, :3, 3]


def segment_gaps(first: Floats, second: Floats) -> Floats:
    """(n,) distances between segments with the ends `first` (n, 2, 3) and `second` (n, 2, 3)."""
    one, two = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0]
    apart = first[:, 0] - second[:, 0]
    a, e = (one * one).sum(axis=1) + 1e-12, (two * two).sum(axis=1) + 1e-12
    b, c, f = (one * two).sum(axis=1), (one * apart).sum(axis=1), (two * apart).sum(axis=1)
    s = np.clip((b * f - c * e) / np.maximum(a * e - b * b, 1e-12), 0, 1)
    t = np.clip((b * s + f) / e, 0, 1)
    s = np.clip((b * t - c) / a, 0, 1)
    gaps: Floats = np.linalg.norm(apart + s[:, None] * one - t[:, None] * two, axis=1)
    return gaps
