"""Mistakes as data: a diagnostic says what is wrong, where, and what to do, and has one renderer."""

from __future__ import annotations

import enum
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass

from cleancli.language.record import Record


class Source(Record):
    """A text and the name its messages go by (a path, or `<stdin>`)."""

    path: str
    text: str


@dataclass(frozen=True, slots=True)
class Span:
    """Half-open range of character offsets in the source at `path`."""

    path: str
    start: int
    end: int


class Level(enum.Enum):
    """How bad a diagnostic is; only errors keep a file from being used."""

    ERROR = "error"
    WARNING = "warning"


class Diagnostic(Record):
    """One mistake: a stable code (docs/diagnostics.md), a message, its place and a way out."""

    code: str
    message: str
    span: Span | None
    label: str = ""
    help: str = ""
    level: Level = Level.ERROR


def printable(text: str) -> str:
    """The text with a dot for each control character: these could steer a terminal."""
    return "".join("·" if unicodedata.category(c) == "Cc" else c for c in text)


class Refused(Exception):
    """Input that can't be used; carries every diagnostic found and the sources they point into."""

    def __init__(self, diagnostics: Iterable[Diagnostic], sources: Iterable[Source] = ()) -> None:
        self.diagnostics = tuple(diagnostics)
        self.sources = tuple(sources)
        super().__init__("; ".join(f"{d.code} {d.message}" for d in self.diagnostics))
