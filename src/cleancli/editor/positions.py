"""Offsets in a text as an editor counts them: lines from 0, and within a line units of its encoding.

The protocol's own unit is UTF-16, where a character outside the basic plane counts twice. An editor may agree
on another one when it starts.
"""

from __future__ import annotations

from cleancli.language.diagnostics.source_lines import Lines

UTF_8, UTF_16, UTF_32 = "utf-8", "utf-16", "utf-32"


def _width(character: str, encoding: str) -> int:
    if encoding == UTF_8:
        return len(character.encode("utf-8", "surrogatepass"))
    return 2 if encoding == UTF_16 and ord(character) > 0xFFFF else 1


class Positions:
    """The lines of a text, for turning offsets into (line, unit) and back."""

    def __init__(self, text: str, encoding: str = UTF_16) -> None:
        self._text = text
        self._encoding = encoding
        self._lines = Lines(text)

    def place(self, offset: int) -> tuple[int, int]:
        """Line and unit of an offset, both from 0; an offset outside the text is moved to its edge."""
        line, column = self._lines.place(offset)
        start = self._lines.start(line)
        return line - 1, self.units(self._text[start : start + column - 1])

    def units(self, text: str) -> int:
        """How many units a piece of text takes."""
        if text.isascii():
            return len(text)
        return sum(_width(character, self._encoding) for character in text)

    def offset(self, line: int, unit: int) -> int:
        """The offset of a place; one beyond its line or the text is moved back to the end of that."""
        if line < 0:
            return 0
        if line >= len(self._lines):
            return len(self._text)
        start, content = self._lines.start(line + 1), self._lines.line(line + 1)
        left = unit
        for index, character in enumerate(content):
            left -= _width(character, self._encoding)
            if left < 0:
                return start + index
        return start + len(content)
