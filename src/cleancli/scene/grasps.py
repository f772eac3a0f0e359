"""The grasps that ship with cleancli. All numbers are chosen: no grasp was measured on a real cloth.

They were chosen so that the same push ends differently by grasp (docs/measurements/physics.md).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import radians
from types import MappingProxyType

from cleancli.scene.model import Grasp

WIDE = Grasp(
    "wide",
    flap=0.02,
    gain=0.1,
    torque=0.03,
    angle_spread=0.06,
    gap_spread=0.6e-3,
    bow=6e-3,
    sweep=0.0,
    skew=0.0,
    width=0.12,
)
FOLDED = Grasp(
    "folded",
    flap=0.022,
    gain=0.2,
    torque=0.08,
    angle_spread=0.03,
    gap_spread=0.3e-3,
    bow=0.0,
    sweep=0.0,
    skew=0.0,
    width=0.088,
)
CORNER = Grasp(
    "corner",
    flap=0.02,
    gain=0.1,
    torque=0.02,
    angle_spread=0.08,
    gap_spread=0.8e-3,
    bow=0.0,
    sweep=radians(12),
    skew=radians(8),
    width=0.14,
)


def named(grasps: Iterable[Grasp]) -> Mapping[str, Grasp]:
    """Grasps by their names."""
    return MappingProxyType({grasp.name: grasp for grasp in grasps})


SHIPPED = named((WIDE, FOLDED, CORNER))
