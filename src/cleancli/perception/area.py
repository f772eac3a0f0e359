"""Dirty areas as ellipses (§3.1, "Ellipse representation"), on the surface, in metres."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Ellipse:
    """`axes` are the half lengths, longer first; `angle` of the longer one from x, in (-pi/2, pi/2]."""

    centre: tuple[float, float]
    axes: tuple[float, float]
    angle: float


@dataclass(frozen=True, slots=True)
class Area:
    """A dirty area: its ellipse and the surface its dirt covers, in square metres.

    `name` identifies it from one observation to the next; it is empty until tracking has named it.
    """

    ellipse: Ellipse
    covered: float
    name: str = ""
