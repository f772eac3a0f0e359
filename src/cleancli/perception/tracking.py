"""Tracks areas from one observation to the next, so that each keeps its name."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil, dist

import numpy as np
from scipy.optimize import linear_sum_assignment

from cleancli.array_types import Bools, Floats, Points
from cleancli.geometry.ellipse import Ellipse, contains, gap, points_within
from cleancli.perception.area import Area

NEAR, FAR = 0.01, 0.03
"""Metres around an area's ellipse in which dirt found later may be its own: noise, a flap's touch."""

BESIDE = 0.02
"""Metres beside the cloth's way, and beyond its end, to which it pushes dirt as well."""

ROLLED = 0.10
"""Metres over which the chance falls to a third that a swept piece has rolled so far beyond that."""


@dataclass(frozen=True, slots=True)
class Likely:
    """How likely dirt is found somewhere; chosen weights against each other.

    `near` where it lay, `far`: a little farther, at the `end` of the stroke that swept it, on the `way`
    there, `rolled` away from both. Where the cloth went, `left` scales the first two. `unknown`: of another
    origin.
    """

    near: float = 1.0
    far: float = 0.1
    end: float = 0.6
    way: float = 0.1
    rolled: float = 0.02
    left: float = 0.5
    unknown: float = 0.002


LIKELY = Likely()

STEP = 0.02
"""Metres of the cloth's way that are told apart."""

SLACK = 1.3
"""An area's dirt may cover so many times as much once it is spread out."""

LEAST = 0.1
"""Share of an area's dirt, or of the dirt in what it may have become, from which one has become the other."""

STAYS, TARGET, UNTOUCHED = 0.2, 1.0, 4.0
"""What it is worth, in shares of an area's dirt, that an area keeps its name which was not to be pushed, to
which others were to be pushed, and which the cloth did not touch."""

ROUNDS = 20
"""Of scaling the flow of dirt to what was there before and is there now."""


Flow = Floats
"""Square metres of dirt from each area before in each area after, (before, after)."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """Where the tool went on the surface.

    `pushed` names the areas it was meant to push, in order; of several, the last is the target of a join.
    `points` (x, y) in metres are the way of the cloth's middle, `half_width` is half of the cloth's width.
    """

    pushed: tuple[str, ...]
    points: tuple[tuple[float, float], ...]
    half_width: float

    @property
    def moved(self) -> tuple[str, ...]:
        """The names of the areas that it was meant to push away; the target of a join stays."""
        return self.pushed[:-1] if len(self.pushed) > 1 else self.pushed

    def swept(self, points: Points, beside: float = 0.0) -> Bools:
        """Whether the cloth went over each of `points` (n, 2), or within `beside` metres of it."""
        return np.asarray((self.distances(points) <= self.half_width + beside).any(axis=1))

    def distances(self, points: Points) -> Points:
        """Metres from `points` (n, 2) to each straight piece of the way, (n, pieces)."""
        ends = self._steps()
        if not len(ends):
            return np.full((len(points), 1), np.inf)
        starts, steps = ends[:-1], np.diff(ends, axis=0)
        offsets = points[:, None, :] - starts
        squared = np.maximum((steps**2).sum(axis=1), 1e-12)
        along = np.clip((offsets * steps).sum(axis=2) / squared, 0, 1)
        return np.asarray(np.linalg.norm(offsets - along[:, :, None] * steps, axis=2))

    def _steps(self) -> Points:
        """The way in pieces of at most `STEP`: their ends, (pieces + 1, 2)."""
        if len(self.points) < 2:
            return np.array(self.points * 2)
        corners = np.array(self.points)
        passed = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        at = np.union1d(np.linspace(0, passed[-1], ceil(passed[-1] / STEP) + 1), passed)
        return np.column_stack([np.interp(at, passed, corners[:, axis]) for axis in (0, 1)])


@dataclass(frozen=True, slots=True)
class Split:
    """Area `of` is now the areas `into`: the one with its name, if there is one, and others of its dirt."""

    of: str
    into: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.of} split into {', '.join(self.into)}"


@dataclass(frozen=True, slots=True)
class Merge:
    """The areas `of` are now one, `into`, which has the name of one of them or a new one."""

    of: tuple[str, ...]
    into: str

    def __str__(self) -> str:
        return f"{', '.join(name for name in self.of if name != self.into)} merged into {self.into}"


AreaChange = Split | Merge


@dataclass(frozen=True, slots=True)
class Tracked:
    """Named `areas`, in the order in which they were seen, and which of them split or merged. The next new
    name is `a<next_number>`."""

    areas: tuple[Area, ...]
    changes: tuple[AreaChange, ...]
    next_number: int


def track(before: Sequence[Area], after: Sequence[Area], stroke: Stroke | None, next_number: int) -> Tracked:
    """The areas of `after`, in their order, named as what has become of the named areas of `before`.

    How much dirt of each area before is in each area after is estimated from where both lie and where the
    stroke went. Names are then assigned so that the shares of dirt that keep their area's name are largest in
    sum; areas that were to be pushed away give way to others, and all to those that nothing went over, which
    are matched by distance, across no gap above `FAR`. A name without an area is gone; an area without a name
    becomes `a<next_number>`, and so on.
    """
    flow = _flow(before, after, stroke)
    names = _assigned(before, after, flow, stroke)
    fresh = itertools.count(next_number)
    called = [names[index] if index in names else f"a{next(fresh)}" for index in range(len(after))]
    areas = tuple(replace(area, name=name) for area, name in zip(after, called, strict=True))
    changes: list[AreaChange] = [*_splits(before, flow, called), *_merges(before, flow, called)]
    return Tracked(areas, tuple(changes), next(fresh))


def _flow(before: Sequence[Area], after: Sequence[Area], stroke: Stroke | None) -> Flow:
    """Square metres of dirt from each area before in each area after, (before, after).

    Likelihoods are scaled in turns so that every area after is filled, and none before gives more than it had
    (iterative proportional fitting, Deming and Stephan 1940): dirt may leave the table, but appears nowhere.
    """
    if not before or not after:
        return np.zeros((len(before), len(after)))
    flow = np.array([_likelihoods(old, after, stroke) for old in before])
    had, has = np.array([area.covered for area in before]), np.array([area.covered for area in after])
    flow *= had[:, None]
    for _ in range(ROUNDS):
        flow *= has / (flow.sum(axis=0) + LIKELY.unknown * has)
        flow *= np.minimum(1, SLACK * had / np.maximum(flow.sum(axis=1), 1e-12))[:, None]
    flow[flow < LEAST * np.minimum(had[:, None], has)] = 0
    return flow


def _likelihoods(old: Area, after: Sequence[Area], stroke: Stroke | None) -> Floats:
    """How likely dirt of an area is found in each of the areas after: weights, (after,)."""
    points = np.stack([points_within(area.ellipse) for area in after])
    near, far = (_share_within(_grown(old.ellipse, metres), points) for metres in (NEAR, FAR))
    if stroke is None or _untouched(old, stroke):
        # It is where it was, if anything is.
        return near if near.max() > LEAST else LIKELY.far * far
    stay = LIKELY.near * near + LIKELY.far * (far - near)
    swept = stroke.swept(points.reshape(-1, 2)).reshape(points.shape[:2])
    left = np.where(swept, LIKELY.left, 1).mean(axis=1)
    own = stroke.distances(points_within(old.ellipse)) <= stroke.half_width
    taken, first = own.any(axis=1).mean(), int(own.any(axis=0).argmax())
    return np.asarray(stay * left + taken * _carried_to(points, stroke, first))


def _carried_to(points: Points, stroke: Stroke, first: int) -> Floats:
    """How likely dirt that the cloth met on the way's piece `first` is found in each area (areas,); of these
    `points` (areas, n, 2)."""
    flat = points.reshape(-1, 2)
    # It goes on along the way from there.
    away = stroke.distances(flat)[:, first:].min(axis=1) - stroke.half_width
    likely = np.where(away <= BESIDE, LIKELY.way, LIKELY.rolled * np.exp(-(away - BESIDE) / ROLLED))
    likely[np.linalg.norm(flat - stroke.points[-1], axis=1) <= stroke.half_width + BESIDE] = LIKELY.end
    return np.asarray(likely.reshape(points.shape[:2]).mean(axis=1))


def _untouched(area: Area, stroke: Stroke | None) -> bool:
    """Whether nothing went over the area."""
    return stroke is None or not stroke.swept(points_within(area.ellipse)).any()


def _share_within(ellipse: Ellipse, points: Points) -> Floats:
    """Of `points` (areas, n, 2) of areas, the share that lies in the ellipse, (areas,)."""
    return np.asarray(contains(ellipse, points.reshape(-1, 2)).reshape(points.shape[:2]).mean(axis=1))


def _grown(ellipse: Ellipse, metres: float) -> Ellipse:
    return replace(ellipse, axes=(ellipse.axes[0] + metres, ellipse.axes[1] + metres))


def _assigned(
    before: Sequence[Area], after: Sequence[Area], flow: Flow, stroke: Stroke | None
) -> dict[int, str]:
    """Index in `after` -> name."""
    if not flow.size:
        return {}
    had, has = np.array([area.covered for area in before]), flow.sum(axis=0)
    shares = flow / had[:, None] * flow / np.maximum(has, 1e-12) + _bonus(before, stroke)[:, None]
    shares[flow == 0] = 0
    standing = np.array([_standing(old, after, stroke) for old in before])
    worth = np.where(_may_pass_on(flow) | (standing > 0), shares + standing, 0)
    rows, columns = linear_sum_assignment(worth, maximize=True)
    pairs = zip(rows.tolist(), columns.tolist(), strict=True)
    return {column: before[row].name for row, column in pairs if worth[row, column] > 0}


def _bonus(before: Sequence[Area], stroke: Stroke | None) -> Floats:
    """What it is worth that each area keeps its name, by what was to become of it; (before,)."""
    moved, pushed = (stroke.moved, stroke.pushed) if stroke else ((), ())
    return np.array([0 if a.name in moved else TARGET if a.name in pushed else STAYS for a in before])


def _may_pass_on(flow: Flow) -> Bools:
    """Whether a name may go on with the dirt of its area, (before, after): away from most of it, only with
    dirt that is mostly its own."""
    may = np.zeros(flow.shape, np.bool_)
    may[np.arange(len(flow)), flow.argmax(axis=1)] = True
    may[flow.argmax(axis=0), np.arange(flow.shape[1])] = True
    return may


def _standing(old: Area, after: Sequence[Area], stroke: Stroke | None) -> Floats:
    """What it is worth that an area over which nothing went is one of those after: the nearer, the more."""
    if not _untouched(old, stroke):
        return np.zeros(len(after))
    close = np.array([gap(old.ellipse, area.ellipse) <= FAR for area in after])
    away = np.array([dist(old.ellipse.centre, area.ellipse.centre) for area in after])
    return np.asarray(close * UNTOUCHED / (1 + away / NEAR))


def _splits(before: Sequence[Area], flow: Flow, called: Sequence[str]) -> Iterator[Split]:
    """Areas together with those of new names that hold mostly their dirt."""
    known = [area.name for area in before]
    pieces: dict[int, list[str]] = {}
    for column, name in enumerate(called):
        if name not in known and flow[:, column].any():
            pieces.setdefault(int(flow[:, column].argmax()), []).append(name)
    for row, names in pieces.items():
        own = [known[row]] if known[row] in called else []
        yield Split(known[row], (*own, *names))


def _merges(before: Sequence[Area], flow: Flow, called: Sequence[str]) -> Iterator[Merge]:
    """Areas after that are what most of several areas before has become."""
    heirs: dict[int, list[str]] = {}
    for area, row in zip(before, flow, strict=True):
        if row.any():
            heirs.setdefault(int(row.argmax()), []).append(area.name)
    for column, names in heirs.items():
        known = called[column] in {area.name for area in before}
        of = names if called[column] in names or not known else [called[column], *names]
        if len(of) > 1:
            yield Merge(tuple(of), called[column])
