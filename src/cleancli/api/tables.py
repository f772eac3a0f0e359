"""Tables of results: as plain text, and as HTML for notebooks."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from html import escape

from cleancli.language.diagnostics.diagnostic import printable


@dataclass(frozen=True, slots=True)
class TextTable:
    """Cells under their heads; the columns of these numbers hold `words`, and are set to the left."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: Collection[int] = (0,)

    def __str__(self) -> str:
        """Columns as wide as they need be, two blanks between them."""
        lines = [tuple(map(printable, row)) for row in (self.heads, *self.rows)]
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        return "\n".join(self._line(line, widths) for line in lines)

    def html(self) -> str:
        """A `table` element, with all that the cells hold escaped."""
        head = "".join(self._cell("th", number, text) for number, text in enumerate(self.heads))
        body = "".join(f"<tr>{''.join(self._cells(row))}</tr>" for row in self.rows)
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def _line(self, cells: Sequence[str], widths: Sequence[int]) -> str:
        placed = (
            cell.ljust(width) if number in self.words else cell.rjust(width)
            for number, (cell, width) in enumerate(zip(cells, widths, strict=True))
        )
        return "  ".join(placed).rstrip()

    def _cells(self, row: Sequence[str]) -> Iterator[str]:
        return (self._cell("td", number, text) for number, text in enumerate(row))

    def _cell(self, tag: str, number: int, text: str) -> str:
        side = "left" if number in self.words else "right"
        return f'<{tag} style="text-align: {side}">{shown(text)}</{tag}>'


def shown(text: str) -> str:
    """The text as HTML shows it, with control characters made visible."""
    return escape(printable(text, keep="\n\t"))


def preformatted(text: str) -> str:
    """Lines that HTML shows as they are."""
    return f"<pre>{shown(text)}</pre>"
