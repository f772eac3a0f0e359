"""Experience from files, each transition once, beside what a domain's text has counted already (§5).

A domain's `learned` block names the experience that its counts rest on: the hash of the first lines of a
file. A file that has grown since begins with the same lines, and so is known again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cleancli.files.plain import open_plain
from cleancli.language.diagnostics.diagnostic import Diagnostic, printable
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Experience
from cleancli.language.parsing.read import refused_as
from cleancli.learning.evidence import NO_EVIDENCE, Collector, Evidence, together
from cleancli.learning.experience import LONGEST, Reading, read_experience
from cleancli.learning.match import Matcher

Part = tuple[int, str]
"""The first transitions of a file: how many, and the hash of their lines."""


@dataclass(frozen=True, slots=True)
class GivenFile:
    """An experience file, and what the user calls it."""

    name: str
    path: Path


@dataclass(frozen=True, slots=True)
class Origin:
    """Where transitions are from: a file by what the user calls it, the number of the first of them there,
    and how many they are."""

    name: str
    first: int
    transitions: int


@dataclass(frozen=True, slots=True)
class Gathered:
    """All that is to be learned from: `experience` says which files it is from, those that the domain's text
    has counted too where they are counted on. `counted` is what of the evidence the text has counted.
    `origins` are the files of the evidence in turn, and `notes` what a person should know."""

    evidence: Evidence
    counted: Evidence
    experience: tuple[Experience, ...]
    origins: tuple[Origin, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Read:
    """A file as it was read: its transitions, less those that count already where the text's counts are added
    to; those that the text has `counted` and that count anew; the part that it is as a whole, and shorter
    ones that are known."""

    file: GivenFile
    evidence: Evidence
    counted: Evidence
    whole: Part
    parts: frozenset[Part]
    is_cut: bool


def gather(
    domain: Domain, files: Sequence[GivenFile], strict: bool, adding: bool, replacing: bool
) -> Gathered:
    """Read all files. Raises Refused, also (E707) where the domain's text has counted experience that is not
    given, and neither adding to it nor replacing it was asked for."""
    known = () if domain.learned is None else domain.learned.experience
    counted = {_part(each): each.name for each in known}
    ends = {whole(file.path) for file in files} if len(files) > 1 else set()
    read = [_read(domain, file, strict, frozenset(counted), ends, adding) for file in files]
    within = {part for each in read for part in each.parts}
    if not adding and not replacing:
        _refuse_dropped([each for each in known if _part(each) not in within | {r.whole for r in read}])
    kept, notes = [], list[str]()
    seen: set[Part] = set()
    for each in read:
        told = _told(each, seen, within, counted, adding)
        notes += told
        if each.whole not in seen | within and each.whole[0]:
            kept.append(each)
        seen.add(each.whole)
    stays = [each for each in known if adding and _part(each) not in within]
    names = {_part(each) for each in stays}
    new = [_experience(each) for each in kept if each.whole not in names]
    evidence = together(each.evidence for each in kept)
    again = together(each.counted for each in kept)
    return Gathered(evidence, again, (*stays, *new), tuple(map(_origin, kept)), tuple(notes))


def _origin(read: _Read) -> Origin:
    number = len(read.evidence.order)
    return Origin(read.file.name, read.whole[0] - number + 1, number)


def _experience(read: _Read) -> Experience:
    number, sha256 = read.whole
    return Experience(read.file.name, sha256, number)


def _part(experience: Experience) -> Part:
    return experience.transitions, experience.sha256


def whole(path: Path) -> Part:
    """What a file is as a whole, without a look at what its lines say. No more of it than the longest line
    that may be read is in memory at a time."""
    reading = Reading()
    with refused_as(str(path)), open_plain(path) as file:
        while line := file.readline(LONGEST + 1):
            reading.pass_by(line)
    return reading.transitions, reading.sha256


def _read(
    domain: Domain, file: GivenFile, strict: bool, counted: frozenset[Part], ends: set[Part], adding: bool
) -> _Read:
    matcher, reading = Matcher(domain, strict), Reading()
    known = counted | ends
    numbers = {number for number, _ in known}
    collector, again = Collector(), NO_EVIDENCE
    parts: list[Part] = []
    for transition in read_experience(file.path, domain, reading):
        collector.add(matcher.match(transition), transition)
        if reading.transitions in numbers and (part := (reading.transitions, reading.sha256)) in known:
            parts.append(part)
            if part in counted:
                again, collector = (NO_EVIDENCE, Collector()) if adding else (collector.evidence, collector)
    whole = (reading.transitions, reading.sha256)
    return _Read(file, collector.evidence, again, whole, frozenset(parts) - {whole}, reading.is_cut)


def _refuse_dropped(dropped: Sequence[Experience]) -> None:
    """Raises Refused (E707) if there is anything."""
    if not dropped:
        return
    names = ", ".join(
        f"{printable(each.name)} ({plural(each.transitions, 'transition')}, {each.sha256})"
        for each in dropped
    )
    help = "give it as well, count the new experience on with --add, or drop what was counted with --replace"
    message = f"the domain has counted experience that is not given: {names}"
    raise Refused([Diagnostic("E707", message, None, help=help)])


def _told(
    read: _Read, seen: set[Part], within: set[Part], counted: dict[Part, str], adding: bool
) -> Iterator[str]:
    """What a person should know of a file."""
    name = printable(read.file.name)
    if read.is_cut:
        yield f"{name}: the last line has no end, and counts for nothing; a run that goes on has such lines"
    if not read.whole[0]:
        yield f"{name}: there is no transition in it"
    elif read.whole in seen:
        yield f"{name}: the same experience was given twice, and counts once"
    elif read.whole in within:
        yield f"{name}: it is the beginning of another file that was given, and counts once"
    elif adding and read.whole in counted:
        yield f"{name}: it is counted already, as {printable(counted[read.whole])}"
