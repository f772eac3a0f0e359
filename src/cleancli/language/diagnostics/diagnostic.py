"""A mistake as data: a diagnostic says what is wrong, where, and what to do."""

from __future__ import annotations

import enum
import re
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


_STEERING = re.compile("[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters, marks that turn the direction of text, line ends, and halves of characters."""


def printable(text: str, keep: str = "") -> str:
    r"""The text with each character that steers a terminal written as `\x1b` or `\u202e`, and a byte of a
    file name that is no text as `\xff`; those of `keep` stay."""
    return _STEERING.sub(lambda found: found[0] if found[0] in keep else _escape(ord(found[0])), text)


def _escape(code: int) -> str:
    if 0xDC80 <= code <= 0xDCFF:
        code -= 0xDC00
        return f"\\x{code:02x}"
    return f"\\x{code:02x}" if code < 0x20 else f"\\u{code:04x}"
