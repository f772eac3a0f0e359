"""A look at the table: what frames show, the names of its areas, and what is true of them.

A look goes on from the areas that were known before it; who takes one decides when, and from where.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.geometry.rgbd import Frame
from cleancli.language.model import Domain, Object, State
from cleancli.perception.area import Area
from cleancli.perception.cap import left_out
from cleancli.perception.occlusion import Known, remember
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.symbols import symbolize
from cleancli.perception.tracking import Stroke
from cleancli.scene.model import Scene

FRAMES_PER_LOOK = 3
"""Frames whose dirty pixels must agree before they count (§3.1, "Noise removal")."""


@dataclass(frozen=True, slots=True)
class Look:
    """Frames, what was found in them, what is known with what was known before, and what is true of the
    areas; `left_out` are those that the scene leaves out of plans."""

    frames: tuple[Frame, ...]
    observation: Observation
    known: Known
    objects: tuple[Object, ...]
    state: State
    left_out: tuple[str, ...]

    @property
    def areas(self) -> tuple[Area, ...]:
        """The named areas, from west to east."""
        return self.known.areas


def look_at(
    frames: Sequence[Frame],
    scene: Scene,
    domain: Domain,
    rng: np.random.Generator,
    before: Sequence[Area] = (),
    stroke: Stroke | None = None,
    next_number: int = 1,
) -> Look:
    """What frames of one camera show that has not moved.

    Areas known `before` keep their names, `stroke` being where the tool went since, and new names begin with
    `a<next_number>`. Raises BadFrame, NoSurface, and Refused for a domain that a scene cannot serve.
    """
    return understood(tuple(frames), perceive(frames, scene, rng), scene, domain, before, stroke, next_number)


def understood(
    frames: tuple[Frame, ...],
    observation: Observation,
    scene: Scene,
    domain: Domain,
    before: Sequence[Area],
    stroke: Stroke | None,
    next_number: int,
) -> Look:
    """What an observation tells with what was known before. Raises Refused as `look_at`."""
    known = remember(before, observation, scene.surface, stroke, next_number)
    objects, state = symbolize(known.areas, scene, domain)
    return Look(frames, observation, known, objects, state, left_out(known.areas, scene))
