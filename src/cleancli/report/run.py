"""A run folder as it was read: what went in, what happened, and what came out, as far as the run has come.

Guaranteed by `read_run`: records are in order, and the ones of the journal are whole (docs/runs.md).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from cleancli.execution.journal import JOURNAL, Acted, Failed, Record, Spent, read_journal
from cleancli.language.diagnostics import Diagnostic, Refused


@dataclass(frozen=True, slots=True)
class InputFile:
    """A file that went in: its path as it was given, the hash of its text, and its copy in the folder."""

    path: str
    sha256: str
    copy: str = ""


@dataclass(frozen=True, slots=True)
class Episode:
    """How a run ended; `seconds` by kind, with their `total`."""

    reason: str
    clean: bool
    actions: int
    seconds: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Header:
    """run.json, as far as a report tells it; `episode` and `truth` are None until the run has ended."""

    versions: Mapping[str, str]
    seed: int
    options: Mapping[str, Any]
    files: tuple[InputFile, ...]
    episode: Episode | None = None
    truth: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True)
class Run:
    """A run folder. `extras`: names of its other files that are there for people or programs."""

    folder: Path
    header: Header
    records: tuple[Record, ...] = ()
    extras: tuple[str, ...] = field(default=())

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
            return self.header.episode.seconds["total"]
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
    """The run in a folder, whole or cut short.

    Raises Refused (E705) where it is no run folder, Refused (E702) for a broken journal, OSError.
    """
    header = _header(folder)
    records = read_journal(folder).records if (folder / JOURNAL).exists() else ()
    names = ("experience.jsonl", JOURNAL, "run.json", *sorted(p.name for p in folder.glob("video*.mp4")))
    return Run(folder, header, records, tuple(name for name in names if (folder / name).is_file()))


def _header(folder: Path) -> Header:
    path = folder / "run.json"
    help = "name the folder that `cleancli execute` has made, for example runs/two_groups-seed1-001"
    try:
        return msgspec.json.decode(path.read_bytes(), type=Header)
    except FileNotFoundError:
        message = f"`{folder}` is no run folder: it has no run.json"
    except msgspec.MsgspecError as error:
        message = f"`{path}` is no record of a run: {error}"
    raise Refused([Diagnostic("E705", message, None, help=help)])
