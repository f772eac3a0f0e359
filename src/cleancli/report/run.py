"""A run folder as it was read: what went in, what happened, and what came out, as far as the run has come.

Guaranteed by `read_run`: records are in order, and the ones of the journal are whole (docs/runs.md).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta

from cleancli.files.untrusted import decoded
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.recording.folder import EXPERIENCE, JOURNAL, RUN, check_folder, read_text, videos
from cleancli.recording.journal import Acted, Count, Failed, Metres, Record, Seconds, Spent, read_journal

FORMAT = 1
"""Of run.json and of the journal: what this version writes, and the latest that it reads."""

LARGEST_HEADER = 4 << 20
"""Bytes of run.json. Chosen: where some 100,000 particles were left takes less."""

Scalar = bool | int | float | str | None


@dataclass(frozen=True, slots=True)
class InputFile:
    """A file that went in: its path as it was given, the hash of its text, and its copy in the folder."""

    path: str
    sha256: Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]
    copy: Annotated[str, Meta(pattern=r"^(files/[^/\\]+)?$")] = ""


@dataclass(frozen=True, slots=True)
class Episode:
    """How a run ended; `seconds` by kind, with their `total`."""

    reason: str
    clean: bool
    actions: Count
    seconds: Mapping[str, Seconds]


@dataclass(frozen=True, slots=True)
class Truth:
    """Where the dirt of a table truly was at the end, or how many facts held in the symbolic world, and
    whether the goal did."""

    particles: Count | None = None
    in_container: Count | None = None
    in_zone: Count | None = None
    on_table: Count | None = None
    in_dustpan: Count | None = None
    on_floor: Count | None = None
    ink_left: Annotated[float, Meta(ge=0, le=1)] | None = None
    left_on_table_at: tuple[tuple[Metres, Metres], ...] | None = None
    facts: Count | None = None
    goal: bool | None = None

    def items(self) -> tuple[tuple[str, object], ...]:
        """What is known, by name."""
        told = ((each.name, getattr(self, each.name)) for each in fields(self))
        return tuple((name, value) for name, value in told if value is not None)


@dataclass(frozen=True, slots=True)
class Header:
    """run.json, as far as a report tells it; `episode` and `truth` are None until the run has ended.
    `calibration` is what the scene's camera was calibrated with, if it was; `world` are the texts of the
    rules by which a symbolic world acted, where they were not the domain's, and `teacher` those of a
    teacher."""

    versions: Mapping[str, str]
    seed: Annotated[int, Meta(ge=0)]
    options: Mapping[str, Scalar]
    files: tuple[InputFile, ...]
    calibration: InputFile | None = None
    world: tuple[InputFile, ...] = ()
    teacher: tuple[InputFile, ...] = ()
    episode: Episode | None = None
    truth: Truth | None = None


class _Format(msgspec.Struct):
    """What is read first: it says whether the rest can be understood."""

    format: int


@dataclass(frozen=True, slots=True)
class Run:
    """A run folder. `extras` and `videos`: names of its other files that are there for programs or people."""

    folder: Path
    header: Header
    records: tuple[Record, ...] = ()
    extras: tuple[str, ...] = field(default=())
    videos: tuple[str, ...] = field(default=())

    @property
    def name(self) -> str:
        """The folder's name."""
        return self.folder.resolve().name

    @property
    def problem(self) -> str:
        """The scene or problem, by the name of its file."""
        return Path(self.header.files[-1].path).stem if self.header.files else self.name

    @property
    def strategy(self) -> str:
        """Who decided what to do."""
        options = self.header.options
        return str(options.get("strategy") or options.get("planner") or "?")

    def spent(self) -> dict[str, float]:
        """Seconds by kind: those of run.json, or, of a run that has not ended, those of the journal."""
        if self.header.episode is not None:
            return {kind: s for kind, s in self.header.episode.seconds.items() if kind != "total"}
        spent: dict[str, float] = {}
        for record in self.records:
            for kind, seconds in record.seconds.items() if isinstance(record, Spent) else ():
                spent[kind] = spent.get(kind, 0.0) + seconds
        return spent

    def total(self) -> float:
        """All seconds that were spent."""
        if self.header.episode is not None:
            told = self.header.episode.seconds
            return told.get("total", sum(told.values()))
        return sum(self.spent().values())

    def actions(self) -> int:
        """How many actions were begun and are over."""
        if self.header.episode is not None:
            return self.header.episode.actions
        return sum(isinstance(record, Acted | Failed) for record in self.records)

    def picture(self, number: int) -> Path:
        """Where the picture of an action is, or would be; that of the first look is number 0."""
        return self.folder / f"step-{number:03d}.png"


def read_run(folder: Path) -> Run:
    """The run in a folder, whole or cut short; the folder may be anybody's.

    Raises Refused (E705) where it is no run folder, Refused (E702) for a broken journal, OSError.
    """
    check_folder(folder)
    header = _header(folder)
    records = read_journal(folder).records if (folder / JOURNAL).exists() else ()
    names = tuple(name for name in (EXPERIENCE, JOURNAL, RUN) if (folder / name).is_file())
    return Run(folder, header, records, names, videos(folder))


def _header(folder: Path) -> Header:
    try:
        source = read_text(folder, RUN, LARGEST_HEADER)
    except (FileNotFoundError, NotADirectoryError):
        help = "name the folder that `cleancli execute` has made, for example runs/two_groups-seed1-001"
        message = f"`{folder}` is no run folder: it has no {RUN}"
        raise Refused([Diagnostic("E705", message, None, help=help)]) from None
    what = "record of a run"
    found = decoded(source, _Format, "E705", what).format
    if found > FORMAT:
        message = f"the run was written in format {found}, and this version reads formats up to {FORMAT}"
        help = "use the version of cleancli that wrote it, or a later one"
        raise Refused([Diagnostic("E705", f"`{source.path}`: {message}", None, help=help)])
    if found < 1:
        raise Refused([Diagnostic("E705", f"`{source.path}`: there is no format {found}", None)])
    return decoded(source, Header, "E705", what)
