"""Decodes JSON against a type, and reads a picture's size, from files that others may have written."""

from __future__ import annotations

import json
import re
import struct
import zlib
from typing import TypeVar

import msgspec

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused

PNG = b"\x89PNG\r\n\x1a\n"

_Data = TypeVar("_Data")
_STEP = re.compile(r"\.(\w+)|\[(\d+)\]")
_JSON = json.JSONDecoder()
_BLANKS = re.compile(r"[ \t\r\n]*")


def png_size(data: bytes) -> tuple[int, int] | None:
    """Width and height that a PNG picture's header tells; None where it is none."""
    if data[:8] != PNG or data[12:16] != b"IHDR" or len(data) < 24:
        return None
    width, height = struct.unpack(">II", data[16:24])
    return width, height


def is_whole_png(data: bytes) -> bool:
    """Whether a PNG picture has all its parts up to the last, each with the checksum that it names: of one
    that has not, the library that reads it prints lines of its own."""
    at = len(PNG)
    while at + 12 <= len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        end = at + 12 + length
        if data[end - 4 : end] != struct.pack(">I", zlib.crc32(data[at + 4 : end - 4])):
            return False
        if kind == b"IEND":
            return True
        at = end
    return False


def jpeg_size(data: bytes) -> tuple[int, int] | None:
    """Width and height that a JPEG picture's frame header tells (ITU T.81, B.2.2); None where it is none."""
    if data[:2] != b"\xff\xd8":
        return None
    at = 2
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker, (length,) = data[at + 1], struct.unpack(">H", data[at + 2 : at + 4])
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            height, width = struct.unpack(">HH", data[at + 5 : at + 9])
            return width, height
        at += 2 + length
    return None


def is_whole_jpeg(data: bytes) -> bool:
    """Whether a JPEG picture ends as one does, padded with zeros or not: of one that does not, the library
    that reads it prints lines of its own."""
    return data[:2] == b"\xff\xd8" and data.rstrip(b"\0")[-2:] == b"\xff\xd9"


def decoded(source: Source, kind: type[_Data], code: str, what: str) -> _Data:
    """A JSON text as a value of a type; refuses, under a code, what is not `what`, with its line and field.

    Fields that the type does not have are passed over.
    """
    try:
        return msgspec.json.decode(source.text, type=kind)
    except msgspec.MsgspecError as error:
        reason, span = str(error), _place(source, str(error))
    except RecursionError:
        reason, span = "it is nested too deeply", None
    raise Refused([Diagnostic(code, f"this is no {what}: {reason}", span)], [source])


def _place(source: Source, reason: str) -> Span | None:
    """What a message of msgspec speaks of: a byte, or the value at the end of a path such as `$.files[0]`."""
    if at := re.search(r"\(byte (\d+)\)", reason):
        start = len(source.text.encode()[: int(at[1])].decode(errors="ignore"))
        return Span(source.path, start, min(start + 1, len(source.text)))
    path = re.search(r"`\$([^`]*)`", reason)
    steps = _STEP.findall(path[1].partition("[...]")[0]) if path else []
    try:
        start = _skipped(source.text, 0)
        for name, number in steps:
            start = _member(source.text, start, name or int(number))
        _, end = _JSON.raw_decode(source.text, start)
    except (ValueError, RecursionError, LookupError):
        return None
    line = source.text.find("\n", start, end)
    return Span(source.path, start, end if line < 0 else line)


def _member(text: str, start: int, key: str | int) -> int:
    """Where the value of a member begins in the object or list that begins at `start`."""
    at, number = _skipped(text, start + 1), 0
    while text[at] not in "]}":
        name: object = number
        if text[start] == "{":
            name, at = _JSON.raw_decode(text, at)
            at = _skipped(text, _skipped(text, at) + 1)
        if name == key:
            return at
        _, at = _JSON.raw_decode(text, at)
        at = _skipped(text, at)
        at = _skipped(text, at + 1) if text[at] == "," else at
        number += 1
    raise LookupError(key)


def _skipped(text: str, at: int) -> int:
    found = _BLANKS.match(text, at)
    return at if found is None else found.end()
