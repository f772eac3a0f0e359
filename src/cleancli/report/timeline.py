"""How the time of a run went by, from its journal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from cleancli.execution.journal import Acted, Failed, Looked, Planned, Record


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
    now = 0.0
    for record in records:
        number = record.number if isinstance(record, Acted | Failed) else 0
        for kind, seconds in spent_on(record):
            if seconds > 0:
                stretches.append(Stretch(kind, now, seconds, number))
                now += seconds
        if isinstance(record, Looked):
            counts.append(Count(now, len(record.areas)))
    return tuple(stretches), tuple(counts)


def spent_on(record: Record) -> Iterator[tuple[str, float]]:
    """What an event took, by kind: planning and perception are real time, all else is the robot's."""
    match record:
        case Looked(_, seconds):
            yield "perceiving", seconds
        case Planned(_, seconds):
            yield "planning", seconds
        case Acted() | Failed():
            yield from record.seconds.items()
