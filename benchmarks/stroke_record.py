"""The strokes of an episode with where the particles truly lay, and what each stroke did to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist

import numpy as np
from episodes import Job, carried_out, opened

from cleancli.array_types import Bools, Floats, Points
from cleancli.execution.episode_state import Situation
from cleancli.execution.events import Acted, Ended, Looked, Started
from cleancli.geometry.ellipse import Ellipse
from cleancli.world.kinematic import KinematicTable
from cleancli.world.table import Truth

MOVED = 0.01
"""Metres by which a particle has moved if a stroke has moved it. Chosen: what a rag brushes moves less."""

BESIDE = 0.06
"""Metres beside the rag within which a stroke passes a particle by. Chosen: half the widest rag, by which a
way could have been bent."""

FEW = 3
"""So many particles, or fewer, are few for a stroke."""

Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Stroke:
    """A move as it was asked for: the corners of the rag's middle on the surface, the areas believed then,
    and particles on the table `before` and `after` it, a row a particle; None after it for one that is gone.

    `came`: where the tool was before. `transit` and `seconds` of robot time. `into`, `lost`: particles that
    came into the container and onto the floor. `aims`: numbers of the areas that it was meant for.
    """

    move: str
    corners: tuple[Place, ...]
    came: Place | None
    areas: tuple[Ellipse, ...]
    aims: tuple[int, ...]
    before: tuple[Place, ...]
    after: tuple[Place | None, ...]
    transit: float
    seconds: float
    into: int
    lost: int

    @property
    def gone(self) -> Bools:
        """Which particles are not on the table any more, (n,)."""
        return np.array([place is None for place in self.after], np.bool_)

    @property
    def moved(self) -> Bools:
        """Which particles have moved, and are on the table still, (n,)."""
        places = np.array([a or b for a, b in zip(self.after, self.before, strict=True)]).reshape(-1, 2)
        return np.asarray(np.linalg.norm(places - self.places, axis=1) > MOVED)

    @property
    def places(self) -> Points:
        """Where the particles lay before, (n, 2) metres."""
        return np.array(self.before).reshape(-1, 2)

    @property
    def in_vain(self) -> bool:
        """Whether it has moved no particle."""
        return not (self.gone.any() or self.moved.any())

    def passed(self, width: float) -> tuple[Bools, Bools]:
        """Which particles that have stayed the rag has gone over, and which lie at most `BESIDE` from where
        it went, aside or behind; (n,) each."""
        stayed = ~self.gone & ~self.moved
        over, _ = swept(self.places, self.corners, width / 2)
        _, near = swept(self.places, self.corners, width / 2 + BESIDE)
        return stayed & over, stayed & ~over & near


@dataclass(frozen=True, slots=True)
class Episode:
    """All strokes of an episode in order, how it ended, and all its seconds by kind."""

    job: Job
    stand_in: bool
    strokes: tuple[Stroke, ...]
    reason: str
    left: int
    lost: int
    spent: dict[str, float]

    @property
    def moving(self) -> float:
        """Seconds of robot time in transits and strokes."""
        return self.spent["transits"] + self.spent["actions"]


@dataclass(frozen=True, slots=True)
class Silliness:
    """What of an episode looks silly, with seconds of transits and strokes: strokes in vain; strokes that
    brought one to `FEW` particles into the container; strokes that repeat one in vain unchanged. `beside`:
    particles that a stroke went by, and a later one had to come for; `over`: that it went over."""

    vain: int
    vain_seconds: float
    few: int
    few_seconds: float
    repeated: int
    over: int
    beside: int


def recorded(job: Job, stand_in: bool) -> Episode:
    """Carry out an episode, and write down its strokes."""
    episode = opened(job, KinematicTable if stand_in else None)
    _, cell, table = episode
    strokes: list[Stroke] = []
    truth = table.truth()
    begun: Started | None = None
    situation: Situation | None = None
    seen, came = situation, cell.tool
    for event in carried_out(episode):
        match event:
            case Looked():
                situation = event.situation
            case Started():
                begun, seen, came, truth = event, situation, cell.tool, table.truth()
            case Acted() if begun is not None and seen is not None:
                strokes.append(_stroke(begun, seen, came, event, truth, table.truth()))
            case Ended():
                ended, truth = event, table.truth()
            case _:
                pass
    spent = ended.spent.by_kind()
    return Episode(job, stand_in, tuple(strokes), ended.reason, truth.on_table, truth.on_floor, spent)


def _stroke(
    begun: Started, seen: Situation, came: Place | None, acted: Acted, before: Truth, after: Truth
) -> Stroke:
    """One stroke, of the events around it and the truth before and after it."""
    assert begun.path is not None, "a table's moves have paths"
    there, still = _on_table(before), _on_table(after)
    rows = np.flatnonzero(there)
    areas = sorted(seen.areas, key=lambda area: area.name)
    return Stroke(
        move=str(begun.move),
        corners=tuple((w.x, w.y) for w in begun.path.waypoints if w.z <= 0),
        came=came,
        areas=tuple(area.ellipse for area in areas),
        aims=tuple(n for n, area in enumerate(areas) if area.name in begun.move.objects),
        before=tuple(_place(before.positions[row]) for row in rows),
        after=tuple(_place(after.positions[row]) if still[row] else None for row in rows),
        transit=acted.transit,
        seconds=acted.seconds,
        into=after.in_container - before.in_container,
        lost=after.on_floor - before.on_floor,
    )


def _on_table(truth: Truth) -> Bools:
    """Which particles lie on the table, (n,)."""
    left = set(map(tuple, truth.left.tolist()))
    return np.array([tuple(place) in left for place in truth.positions.tolist()], np.bool_)


def _same_way(one: Stroke, other: Stroke) -> bool:
    """Whether two strokes go where no camera would tell them apart."""
    return len(one.corners) == len(other.corners) and all(map(_close, one.corners, other.corners))


def _close(one: Place, other: Place) -> bool:
    return dist(one, other) <= MOVED


def _place(position: Floats) -> Place:
    return round(float(position[0]), 4), round(float(position[1]), 4)


def swept(places: Points, corners: Sequence[Place], reach: float) -> tuple[Bools, Bools]:
    """Which places (n, 2) lie at most `reach` metres beside a way along corners, and which at most so far
    from it, its round ends included; (n,) each."""
    beside = np.zeros(len(places), np.bool_)
    nearest = np.full(len(places), np.inf)
    for first, last in pairwise(map(np.array, corners)):
        step = last - first
        share = (places - first) @ step / max(float(step @ step), 1e-12)
        apart = np.linalg.norm(places - first - np.clip(share, 0, 1)[:, None] * step, axis=1)
        beside |= (share >= 0) & (share <= 1) & (apart <= reach)
        nearest = np.minimum(nearest, apart)
    return beside, nearest <= reach


def silliness(episode: Episode, width: float) -> Silliness:
    """What of an episode with a rag so wide, metres, looks silly."""
    strokes = episode.strokes
    vain = [stroke for stroke in strokes if stroke.in_vain]
    few = [stroke for stroke in strokes if 0 < stroke.into <= FEW]
    missed = [stroke.passed(width) for stroke in strokes[:-1]]
    return Silliness(
        vain=len(vain),
        vain_seconds=sum(stroke.transit + stroke.seconds for stroke in vain),
        few=len(few),
        few_seconds=sum(stroke.transit + stroke.seconds for stroke in few),
        repeated=sum(one.in_vain and _same_way(one, other) for one, other in pairwise(strokes)),
        over=sum(int(over.sum()) for over, _ in missed),
        beside=sum(int(beside.sum()) for _, beside in missed),
    )
