"""Tables on standard output."""

from __future__ import annotations

import sys

import click
from rich.console import Console
from rich.table import Table

from cleancli.cli.echo import wants_colour

_NO_EDGE = 10_000


def plain_table(*columns: str, left: int = 1) -> Table:
    """A table without lines, with these columns; the first `left` are words, the others numbers."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for number, column in enumerate(columns):
        table.add_column(column, justify="left" if number < left else "right")
    return table


def print_table(table: Table) -> None:
    """A table as wide as the terminal; a file or a pipe has no edge to wrap at."""
    console = Console(
        highlight=False,
        markup=False,  # names may have brackets
        emoji=False,
        no_color=not wants_colour(sys.stdout),
        width=None if sys.stdout.isatty() else _NO_EDGE,
    )
    with console.capture() as text:
        console.print(table)
    click.echo("\n".join(line.rstrip() for line in text.get().splitlines()))
