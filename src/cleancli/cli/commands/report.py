"""`cleancli report`: a run as a page, whole or cut short; several runs side by side."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import click
from rich.table import Table

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.progress import working
from cleancli.cli.views.tables import plain_table, print_table
from cleancli.files.replace import replace_file
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.report.account import RunRow, name_of, row_of
from cleancli.report.page import PAGE, comparison_page, run_page
from cleancli.report.run import read_run
from cleancli.report.timeline import in_order


@command_of("report")
@click.option("--html", type=options.FILE, help="Write the page to this file.")
@options.as_json("Print the figures as JSON; write only --html's file.")
def command(folders: tuple[Path, ...], html: Path | None, as_data: bool) -> None:
    """Tell what became of each RUN, the folder that `execute` has made.

    One RUN: its page is written to RUN/report.html, also if the run was cut short. Several: a table compares
    them; the page that shows the same is written only where --html says.
    """
    runs = [read_run(folder) for folder in folders]
    rows = [row_of(run) for run in runs]
    if html is None and len(runs) == 1 and not as_data:
        html = folders[0] / PAGE
    if html is not None:
        with working(f"writing {html.name}", as_data):
            page = run_page(runs[0]) if len(runs) == 1 else comparison_page(rows)
            replace_file(html, printable(page, keep="\n\t"))
    if as_data:
        click.echo(json.dumps({"runs": [asdict(row) for row in rows]}, indent=2))
        return
    print_table(_table(rows))
    if html is not None:
        echo(f"page: {html}")


def _table(rows: Sequence[RunRow]) -> Table:
    """A row a run; of several, also how long each took as part of the first."""
    kinds = list(in_order({kind: 0.0 for row in rows for kind, spent in row.seconds.items() if spent}))
    compared = ("of first",) if len(rows) > 1 else ()
    columns = ("strategy", "seed", "ended", "actions", "left", "seconds", *compared)
    table = plain_table("run", *columns, *(name_of(kind) for kind in kinds))
    for row in rows:
        part = f"{100 * row.total / rows[0].total:.0f} %" if rows[0].total else "-"
        table.add_row(
            row.name,
            row.strategy,
            str(row.seed),
            row.verdict,
            str(row.actions),
            row.remains or "-",
            f"{row.total:.1f}",
            *((part,) if compared else ()),
            *(f"{row.seconds[kind]:.1f}" if kind in row.seconds else "-" for kind in kinds),
        )
    return table
