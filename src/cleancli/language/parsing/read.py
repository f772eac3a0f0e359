"""Files to texts and texts to trees, refusing what is no text or another kind of file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from cleancli.files.plain import TooLarge, in_units, read_plain
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.parsing.parse import beginning, kind_of, parse
from cleancli.language.syntax import Root

LARGEST = 8 * 1024 * 1024
"""Bytes of a text, with all that it includes."""


def read_source(path: Path | str) -> Source:
    """The text of a file as it is, line ends included; refuses what is no UTF-8 text (E001 to E005)."""
    name = str(path)
    with refused_as(name):
        return Source(name, _decode(name, read_plain(path, LARGEST)))


@contextmanager
def refused_as(name: str) -> Iterator[None]:
    """Refuse what cannot be opened or read (E001 to E003, E005) under the name that messages shall have."""
    try:
        yield
    except FileNotFoundError:
        raise Refused([Diagnostic("E001", f"no file `{name}`", None)]) from None
    except IsADirectoryError:
        raise Refused([Diagnostic("E002", f"`{name}` is a folder", None, help="name a file in it")]) from None
    except TooLarge:
        raise Refused([too_large(name)]) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise Refused([Diagnostic("E003", f"cannot read `{name}`: {reason}", None)]) from None


def read_stream(stream: BinaryIO, name: str) -> Source:
    """The text that a stream holds, under the name that its messages shall have; refuses as `read_source`."""
    try:
        raw = stream.read(LARGEST + 1)
    except OSError as error:
        raise Refused([Diagnostic("E003", f"cannot read `{name}`: {error.strerror}", None)]) from None
    if len(raw) > LARGEST:
        raise Refused([too_large(name)])
    return Source(name, _decode(name, raw))


def too_large(name: str) -> Diagnostic:
    """E005 of a text that is larger than LARGEST."""
    return Diagnostic("E005", f"`{name}` is larger than {in_units(LARGEST)}", None)


def _decode(name: str, raw: bytes) -> str:
    bad = raw.find(b"\0")
    text = ""
    if bad < 0:
        try:
            text = raw.decode("utf-8")
        except UnicodeDecodeError as error:
            bad = error.start
    if bad >= 0:
        line = raw.count(b"\n", 0, bad) + 1
        message = f"`{name}` is no UTF-8 text: byte 0x{raw[bad]:02x} at offset {bad} (line {line})"
        raise Refused([Diagnostic("E004", message, None, help="save the file as UTF-8")])
    return text


def parse_as(source: Source, kind: str) -> tuple[Root | None, Findings]:
    """The tree of a text that must be of one kind (E106), with what the parser found."""
    found = kind_of(source)
    if found != kind:
        message = f"this is a {found}, where a {kind} is wanted"
        raise Refused([Diagnostic("E106", message, beginning(source))], [source])
    parsed = parse(source)
    return parsed.root, Findings(source, parsed.diagnostics, parsed.broken)
