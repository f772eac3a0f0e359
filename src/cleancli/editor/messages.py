"""What an editor sends, read with a limit: it says how long a message is before it sends any of it."""

from __future__ import annotations

import re
from typing import BinaryIO

LARGEST = 64 << 20
"""Bytes of a message: several times the largest text, written as JSON."""
LONGEST = 4096
"""Bytes of a line above a message."""

_LENGTH = re.compile(rb"content-length:\s*(\d+)\s*", re.IGNORECASE)


class Limited:
    """A stream of messages that ends where one is announced that is too large; `refused` says why then.

    Only what the protocol's reader asks for is here.
    """

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self.refused = ""

    def readline(self) -> bytes:
        """A line above a message, or the empty one before it."""
        line = self._stream.readline(LONGEST + 1)
        announced = _LENGTH.fullmatch(line)
        if len(line) > LONGEST:
            return self._refuse(f"a line above a message is longer than {LONGEST} bytes")
        if announced is not None and _is_larger(announced.group(1)):
            return self._refuse(f"a message of {announced.group(1)[:30].decode()} bytes was announced")
        return line

    def read(self, size: int) -> bytes:
        """A message."""
        return b"" if self.refused else self._stream.read(size)

    def _refuse(self, why: str) -> bytes:
        self.refused = why
        return b""


def _is_larger(digits: bytes) -> bool:
    number = digits.lstrip(b"0")
    return len(number) > len(str(LARGEST)) or int(number or b"0") > LARGEST
