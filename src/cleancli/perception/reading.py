"""How a recording is read, as users say it. No heavy imports: commands know it before they read anything."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

MAX_DIFFERENCE = 0.02
"""Seconds; the limit of the TUM benchmark's own tool."""
EVERY = 1.0
"""Seconds."""


@dataclass(frozen=True, slots=True)
class Reading:
    """`frame` is the frame of tf that is the scene's; topics are found where none is named; `max_difference`
    is by how many seconds the stamps of a pair may differ, and `every` how many pass from look to look;
    `cell` is the file that tells where the camera stands, where the recording does not."""

    frame: str | None = None
    colour_topic: str | None = None
    depth_topic: str | None = None
    info_topic: str | None = None
    max_difference: float = MAX_DIFFERENCE
    every: float = EVERY
    cell: Path | None = None
