"""Tables on standard output."""

from __future__ import annotations

import sys

import click
from rich.console import Console, RenderableType
from rich.style import StyleType
from rich.table import Table

from cleancli.api.tables import TextTable
from cleancli.language.diagnostics.diagnostic import printable

_NO_EDGE = 10_000


class _Printable(Table):
    """A table whose cells steer no terminal, whatever file they come from."""

    def add_row(
        self,
        *cells: RenderableType | None,
        style: StyleType | None = None,
        end_section: bool = False,
    ) -> None:
        """As a table does."""
        shown = (printable(cell) if isinstance(cell, str) else cell for cell in cells)
        super().add_row(*shown, style=style, end_section=end_section)


def plain_table(*columns: str, left: int = 1) -> Table:
    """A table without lines, with these columns; the first `left` are words, the others numbers."""
    table = _Printable(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for number, column in enumerate(columns):
        table.add_column(printable(column), justify="left" if number < left else "right")
    return table


def table_of(table: TextTable) -> Table:
    """The same, for a terminal."""
    shown = plain_table(*table.heads)
    for number, column in enumerate(shown.columns):
        column.justify = "left" if number in table.words else "right"
    for row in table.rows:
        shown.add_row(*row)
    return shown


def print_table(table: Table) -> None:
    """A table as wide as the terminal; a file or a pipe has no edge to wrap at."""
    console = Console(
        highlight=False,
        markup=False,  # names may have brackets
        emoji=False,
        width=None if sys.stdout.isatty() else _NO_EDGE,
    )
    with console.capture() as text:
        console.print(table)
    click.echo("\n".join(line.rstrip() for line in text.get().splitlines()))
