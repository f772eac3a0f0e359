"""Prepares standard streams that are closed, full, or that nobody reads any more (docs/exit-codes.md)."""

from __future__ import annotations

import io
import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, TextIO

from cleancli.files.plain import naming

if TYPE_CHECKING:
    from typing_extensions import Buffer

_MODES = ("r", "w", "w")


class NoReader(Exception):
    """Nobody reads standard output any more. No OSError: libraries have answers of their own to those."""


class _Output(io.FileIO):
    """Standard output, whose errors say that they are about it."""

    def write(self, data: Buffer, /) -> int:
        try:
            with naming("standard output"):
                return super().write(data)
        except BrokenPipeError:
            raise NoReader from None


class _Messages(io.FileIO):
    """Standard error, which loses what cannot be written to it: there is nowhere left to say so."""

    def write(self, data: Buffer, /) -> int:
        with suppress(OSError):
            return super().write(data)
        return len(memoryview(data))


def prepare() -> None:
    """Make standard streams of which every error is met in good order, and met by `main`.

    What a process was started without it gets first: else the next file that it opens would be its standard
    output.
    """
    for number, mode in enumerate(_MODES):
        try:
            os.fstat(number)
        except OSError:
            # The wrong way round, so that what is written to it is not thought to have arrived.
            handle = os.open(os.devnull, os.O_RDONLY if mode == "w" else os.O_WRONLY)
            os.dup2(handle, number)
            if handle != number:
                os.close(handle)
    if sys.stdin is None:
        sys.stdin = open(0, closefd=False)  # noqa: SIM115 (for as long as the process is)
    sys.stdout = _text(_Output(1, "w", closefd=False), sys.stdout)
    sys.stderr = _text(_Messages(2, "w", closefd=False), sys.stderr)


def _text(raw: io.FileIO, like: TextIO | None) -> io.TextIOWrapper:
    """A stream of text that goes to `raw` as it went to the one it replaces, if there was one."""
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        encoding=None if like is None else like.encoding,
        errors=None if like is None else like.errors,
        line_buffering=like is None or bool(like.line_buffering),
    )


def finish() -> Exception | None:
    """Write what is still to be written; says why that cannot be, and throws it away then: Python would try
    again when it ends, and complain."""
    try:
        sys.stdout.flush()
    except (OSError, NoReader) as error:
        with suppress(io.UnsupportedOperation):
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, sys.stdout.fileno())
            os.close(nowhere)
        return error
    except ValueError:  # closed, by who wrote to it
        pass
    return None
