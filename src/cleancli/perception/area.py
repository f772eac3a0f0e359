"""Dirty areas as ellipses (§3.1, "Ellipse representation"), on the surface, in metres."""

from __future__ import annotations

from dataclasses import dataclass

from cleancli.geometry.ellipse import Ellipse


@dataclass(frozen=True, slots=True)
class Area:
    """A dirty area: its ellipse and the surface its dirt covers, in square metres.

    `name` identifies it from one observation to the next; it is empty until tracking has named it.
    """

    ellipse: Ellipse
    covered: float
    name: str = ""
