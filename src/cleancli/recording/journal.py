"""The journal of a run (docs/runs.md): a record for everything that happened, a JSON object a line.

Lines are only appended. A last line without a line end was cut short and counts for nothing; a run that is
resumed begins by taking away what followed its last checkpoint.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import msgspec
from msgspec import Meta

from cleancli.execution.setup import MOST
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import State, Value
from cleancli.recording.folder import JOURNAL, read_text

Count = Annotated[int, Meta(ge=0, le=MOST)]
Seconds = Annotated[float, Meta(ge=0, le=MOST)]
Metres = Annotated[float, Meta(ge=-1e3, le=1e3)]
Length = Annotated[float, Meta(ge=0, le=1e3)]
SquareMetres = Annotated[float, Meta(ge=0, le=1e6)]
Angle = Annotated[float, Meta(ge=-10, le=10)]
Probability = Annotated[float, Meta(ge=0, le=1)]
"""What numbers a file may tell: whatever a run can write lies well within."""

Times = Annotated[float, Meta(ge=0, le=MOST)]
"""How often something was seen; one time may be shared among several."""


class FactEntry(NamedTuple):
    """A symbol's value for some objects, as in an experience file; None for a function without value."""

    symbol: str
    objects: tuple[str, ...]
    value: Value | None


@dataclass(frozen=True, slots=True)
class AreaEntry:
    """A dirty area: centre and half axes of its ellipse (longer first) in metres, the longer one's angle from
    x in radians, the surface that its dirt covers in square metres; `seen` in this look, or remembered."""

    name: str
    centre: tuple[Metres, Metres]
    axes: tuple[Length, Length]
    angle: Angle
    covered: SquareMetres
    seen: bool = True


@dataclass(frozen=True, slots=True)
class Chance:
    """One outcome of a rule: `kind` is change, nothing or noise; what it would set, for these objects."""

    probability: Probability
    kind: Literal["change", "nothing", "noise"]
    effects: tuple[FactEntry, ...]


@dataclass(frozen=True, slots=True)
class Expected:
    """What an action does in a state: the covering rule, or None for the default rule, and its outcomes in
    the domain's order."""

    rule: str | None
    outcomes: tuple[Chance, ...]


@dataclass(frozen=True, slots=True)
class StepEntry:
    """One action of a plan, and what is expected of it if every step before it ends as the plan goes on from.
    `follows`: which of the outcomes that is; None where none of them is known to be."""

    action: str
    arguments: tuple[str, ...]
    expected: Expected
    follows: Count | None = None


@dataclass(frozen=True, slots=True)
class Looked:
    """The table was looked at. `seconds` of perception, `clock` of robot time at the look.

    `purpose`: first, after (an action, the arm being where that left it), extra or learning (the arm having
    left the view).
    """

    clock: Seconds
    seconds: Seconds
    areas: tuple[AreaEntry, ...]
    objects: Mapping[str, str]
    facts: tuple[FactEntry, ...]
    purpose: str = "first"


@dataclass(frozen=True, slots=True)
class Planned:
    """It was decided what to do. `seconds` of grounding and planning; `value` is whose `measure` says. A
    strategy that plans nothing ahead has an empty `planner` and `measure`, and expects nothing."""

    planner: str
    seconds: Seconds
    value: float
    measure: str
    coverage: Probability | None
    steps: tuple[StepEntry, ...]


@dataclass(frozen=True, slots=True)
class Started:
    """The robot set off for an action; what was expected of it in the state believed then."""

    number: Count
    action: str
    arguments: tuple[str, ...]
    expected: Expected


@dataclass(frozen=True, slots=True)
class Acted:
    """An action is over and what came of it has been seen: a checkpoint.

    `seconds` by kind; `clock` of robot time at the end. `outcome` is an index into what the covering `rule`
    was expected to do: the outcome that explains what was seen (§5), None where none does. `changed` are the
    facts whose value differs from before, with the value now.
    """

    number: Count
    action: str
    arguments: tuple[str, ...]
    clock: Seconds
    seconds: Mapping[str, Seconds]
    rule: str | None
    outcome: Count | None
    changed: tuple[FactEntry, ...]


class RuleEntry(NamedTuple):
    """A rule by its name (null: the default rule), what is believed of its outcomes, how often each was
    seen, and between which probabilities the examples leave each."""

    rule: str | None
    probabilities: tuple[Probability, ...]
    seen: tuple[Times, ...]
    intervals: tuple[tuple[Probability, Probability], ...] = ()


class DurationEntry(NamedTuple):
    """Seconds that an action is believed to last, and how often it was timed."""

    action: str
    seconds: Seconds
    seen: Times


class CorrectionEntry(NamedTuple):
    """By how much longer an action lasts than the table expects of it, and how often it was timed."""

    action: str
    factor: Seconds
    seen: Times


@dataclass(frozen=True, slots=True)
class Learned:
    """What is believed from now on, since an action was learned from or since the run began or went on, of
    the `rules`, the `durations` and the `corrections` of which that is something new."""

    rules: tuple[RuleEntry, ...]
    durations: tuple[DurationEntry, ...] = ()
    corrections: tuple[CorrectionEntry, ...] = ()


@dataclass(frozen=True, slots=True)
class Failed:
    """The robot could not carry out an action, for a `reason`: a checkpoint too."""

    number: Count
    action: str
    arguments: tuple[str, ...]
    clock: Seconds
    seconds: Mapping[str, Seconds]
    reason: str


@dataclass(frozen=True, slots=True)
class Spent:
    """Seconds by kind that whoever waits for the robot has waited since the last such line: they add up to
    what `ended` tells."""

    seconds: Mapping[str, Seconds]


@dataclass(frozen=True, slots=True)
class Resumed:
    """The run went on from its checkpoint after so many actions; `dropped` lines that came after it are not
    in the journal any more."""

    after: Count
    dropped: Count


@dataclass(frozen=True, slots=True)
class Interrupted:
    """Somebody stopped the run, and the tool was moved up."""

    clock: Seconds


@dataclass(frozen=True, slots=True)
class Ended:
    """The episode is over. `clean`: nothing dirty is seen any more."""

    clock: Seconds
    reason: str
    clean: bool
    actions: Count
    seconds: Mapping[str, Seconds]


Record = Looked | Planned | Started | Acted | Learned | Failed | Spent | Resumed | Interrupted | Ended

EVENTS: Mapping[str, type[Record]] = {
    "looked": Looked,
    "planned": Planned,
    "started": Started,
    "acted": Acted,
    "failed": Failed,
    "spent": Spent,
    "learned": Learned,
    "resumed": Resumed,
    "interrupted": Interrupted,
    "ended": Ended,
}
"""What a line's `event` says it is."""

_NAMES = {kind: name for name, kind in EVENTS.items()}


@dataclass(frozen=True, slots=True)
class Journal:
    """All records in order. `cut`: there was a last line without its end, which a crash has left."""

    records: tuple[Record, ...]
    cut: bool = False


def encode(record: Record) -> str:
    """A record's line, without its line end."""
    line = {"event": _NAMES[type(record)], **msgspec.to_builtins(record)}
    return msgspec.json.encode(line).decode()


def decode(source: Source) -> Journal:
    """All records of a journal; refuses (E702) every line that is none, except a last one without its end."""
    records, mistakes = [], []
    begun: Started | None = None
    for line, span in _lines(source):
        try:
            record = _record(line)
            begun = _follows(record, begun)
            records.append(record)
        except (msgspec.MsgspecError, ValueError, RecursionError) as error:
            mistakes.append(Diagnostic("E702", f"not a line of a journal: {error}", span))
    if mistakes:
        raise Refused(mistakes, (source,))
    return Journal(tuple(records), cut=bool(source.text) and not source.text.endswith("\n"))


def read_journal(folder: Path) -> Journal:
    """The journal in a run's folder; raises Refused, OSError where it can't be read."""
    return decode(read_text(folder, JOURNAL))


def facts(state: State) -> tuple[FactEntry, ...]:
    """A state's facts in order."""
    return tuple(sorted(FactEntry(f.symbol, f.objects, f.value) for f in state))


def _lines(source: Source) -> Iterator[tuple[str, Span]]:
    start = 0
    for line in source.text.split("\n")[:-1]:
        if line.strip():
            yield line, Span(source.path, start, start + len(line))
        start += len(line) + 1


def _record(line: str) -> Record:
    """Raises ValueError or MsgspecError, with the reason, for what is no record."""
    fields = msgspec.json.decode(line, type=dict[str, object])
    name = fields.pop("event", None)
    if not isinstance(name, str) or name not in EVENTS:
        raise ValueError(f"{name!r} is no event")
    record: Record = msgspec.convert(fields, EVENTS[name], str_keys=True)
    return record


def _follows(record: Record, begun: Started | None) -> Started | None:
    """The action under way after a record. Raises ValueError for an outcome that an action was not expected
    to have."""
    match record:
        case Planned():
            for step in record.steps:
                _check_outcome(step.follows, step.expected)
        case Started():
            return record
        case Acted() if begun is not None:
            _check_outcome(record.outcome, begun.expected)
            return None
        case Acted() | Failed():
            return None
    return begun


def _check_outcome(outcome: int | None, expected: Expected) -> None:
    number = len(expected.outcomes)
    if outcome is not None and outcome >= number:
        raise ValueError(f"outcome {outcome} of an action that was expected to have {number}")
