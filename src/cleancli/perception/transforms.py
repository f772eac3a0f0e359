"""Where coordinate frames are, as tf and the TUM layout tell it: places and quaternions with their stamps."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from cleancli.array_types import Floats

STALE = 0.5
"""Seconds before the first and after the last of its stamps for which a transform still holds."""
COLUMNS = 8
"""Stamp in seconds, place x y z in metres, quaternion x y z w."""

ROUNDED = 0.01
"""By how much a quaternion's length may differ from 1."""

FARTHEST = 1e6
"""Metres: farther than what anything is measured by in which a table stands, and near enough to count in."""


class NoTransform(Exception):
    """Nothing says where a coordinate frame is; the message is a sentence without a subject."""


@dataclass(frozen=True, slots=True)
class Track:
    """Where something was: rows (n, `COLUMNS`) in the order of their stamps, quaternions of length 1."""

    rows: Floats
    is_fixed: bool = False

    def at(self, stamp: float) -> Floats | None:
        """The pose (4, 4) at a time, between two rows in proportion; None where the track does not reach."""
        stamps = self.rows[:, 0]
        if self.is_fixed:
            return _matrix(self.rows[-1])
        if not stamps[0] - STALE <= stamp <= stamps[-1] + STALE:
            return None
        after = int(np.clip(np.searchsorted(stamps, stamp), 1, len(stamps) - 1)) if len(stamps) > 1 else 0
        first, second = self.rows[max(after - 1, 0)], self.rows[after]
        span = second[0] - first[0]
        share = float(np.clip((stamp - first[0]) / span, 0, 1)) if span > 0 else 0.0
        # q and -q are the same rotation: the shorter way is taken.
        sign = 1.0 if float(first[4:] @ second[4:]) >= 0 else -1.0
        between = (1 - share) * first + share * np.concatenate([second[:4], sign * second[4:]])
        return _matrix(between)


def track(rows: Floats, is_fixed: bool = False) -> Track | None:
    """A track of rows in any order; None where none of them is a pose: numbers that are not finite, a place
    beyond `FARTHEST`, or a quaternion that is far from length 1."""
    possible = rows[(np.abs(rows[:, 1:]) < FARTHEST).all(axis=1) & np.isfinite(rows[:, 0])]
    kept = possible[np.abs(np.linalg.norm(possible[:, 4:], axis=1) - 1) < ROUNDED]
    if not len(kept):
        return None
    return Track(kept[np.argsort(kept[:, 0], kind="stable")], is_fixed)


@dataclass(slots=True)
class Transforms:
    """A tree of coordinate frames as it is recorded: for each the one that it is told in, and its rows."""

    _parents: dict[str, str] = field(default_factory=dict)
    _rows: dict[str, array[float]] = field(default_factory=dict)
    _fixed: set[str] = field(default_factory=set)

    def add(self, parent: str, child: str, row: tuple[float, ...], is_fixed: bool) -> None:
        """One transform of a message: where `child` is in `parent`."""
        self._parents[child] = parent
        self._rows.setdefault(child, array("d")).extend(row)
        if is_fixed:
            self._fixed.add(child)

    def __len__(self) -> int:
        """How many transforms were added."""
        return sum(len(rows) for rows in self._rows.values()) // COLUMNS

    @property
    def names(self) -> list[str]:
        """Of all frames."""
        return sorted({*self._parents, *self._parents.values()})

    def way(self, target: str, source: str) -> Way:
        """How coordinates of `source` become those of `target`. Raises NoTransform."""
        up, down = self._to_root(source), self._to_root(target)
        shared = next((name for name in up if name in down), None)
        if shared is None:
            raise NoTransform(f"tf knows no way from `{source}` to `{target}`")
        return Way(
            tuple(self._track(name) for name in up[: up.index(shared)]),
            tuple(self._track(name) for name in down[: down.index(shared)]),
        )

    def _to_root(self, name: str) -> list[str]:
        names = [name]
        while (parent := self._parents.get(names[-1])) is not None:
            if parent in names:
                raise NoTransform(f"in tf `{parent}` is told in coordinates of its own")
            names.append(parent)
        return names

    def _track(self, name: str) -> Track:
        rows = np.frombuffer(self._rows[name], dtype=np.float64).reshape(-1, COLUMNS)
        found = track(rows, name in self._fixed)
        if found is None:
            raise NoTransform(f"tf has no possible place of `{name}`")
        return found


@dataclass(frozen=True, slots=True)
class Way:
    """Tracks that lead from the source up to a shared frame, and those that lead there from the target."""

    up: tuple[Track, ...]
    down: tuple[Track, ...]

    def at(self, stamp: float) -> Floats | None:
        """The matrix (4, 4) from the source's coordinates to the target's; None where a track does not
        reach."""
        up, down = _product(self.up, stamp), _product(self.down, stamp)
        return None if up is None or down is None else np.linalg.inv(down) @ up


def _product(steps: tuple[Track, ...], stamp: float) -> Floats | None:
    whole = np.eye(4)
    for step in steps:
        here = step.at(stamp)
        if here is None:
            return None
        whole = here @ whole
    return whole


def _matrix(row: Floats) -> Floats:
    """The pose (4, 4) of a place and a quaternion, which need not be of length 1."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = Rotation.from_quat(row[4:]).as_matrix(), row[1:4]
    return pose
