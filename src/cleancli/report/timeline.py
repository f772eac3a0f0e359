"""How the time of a run went by, from its journal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from cleancli.recording.journal import Acted, Failed, Looked, Record, Spent

KINDS = ("planning", "transits", "actions", "perceiving", "extra_perceptions", "learning")
"""What time is spent on, in the order in which it is told; a record may know others."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """A stretch of time: what it was spent on, when it began, how many seconds it took, and for which action
    (0: for none)."""

    kind: str
    start: float
    seconds: float
    number: int


@dataclass(frozen=True, slots=True)
class Count:
    """How many dirty areas were believed to be there from a time on."""

    start: float
    areas: int


def timeline(records: Iterable[Record]) -> tuple[tuple[Stretch, ...], tuple[Count, ...]]:
    """How time went by, one thing after the other, and how many dirty areas were seen meanwhile."""
    stretches: list[Stretch] = []
    counts: list[Count] = []
    now, number = 0.0, 0
    seen: int | None = None
    for record in records:
        match record:
            case Acted() | Failed():
                number = record.number
            case Looked():
                seen = len(record.areas)
            case Spent(spent):
                for kind, seconds in in_order({k: s for k, s in spent.items() if s > 0}).items():
                    stretches.append(Stretch(kind, now, seconds, number))
                    now += seconds
                number = 0
        if seen is not None and isinstance(record, Spent):
            counts.append(Count(now, seen))
            seen = None
    return tuple(stretches), tuple(counts)


def in_order(seconds: Mapping[str, float]) -> dict[str, float]:
    """Seconds by kind, the known kinds first."""
    known = [kind for kind in KINDS if kind in seconds]
    return {kind: seconds[kind] for kind in (*known, *seconds)}
