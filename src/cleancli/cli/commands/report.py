"""`cleancli report`: a run as a page, whole or cut short; several runs side by side."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
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
from cleancli.recording.folder import PAGE
from cleancli.recording.series import is_series
from cleancli.report.account import RunRow, name_of, row_of
from cleancli.report.comparison_page import comparison_page
from cleancli.report.groups import Group, groups_of, kinds_of
from cleancli.report.page import interval_text, run_page
from cleancli.report.rules import courses
from cleancli.report.run import Run, read_run
from cleancli.report.series import Series, read_series
from cleancli.report.series_page import series_page
from cleancli.report.timeline import in_order
from cleancli.statistics.bootstrap import Estimate


@command_of("report")
@click.option("--html", type=options.FILE, help="Write the page to this file.")
@options.as_json("Print the figures as JSON; write only --html's file.")
def command(folders: tuple[Path, ...], html: Path | None, as_data: bool) -> None:
    """Tell what became of each RUN, the folder that `execute` has made of a run or of a series.

    One RUN: its page is written to RUN/report.html, also if it was cut short. Several: tables compare them,
    and the means of those that differ in their seeds alone; their page is written only where --html says.
    """
    told = [read_series(folder) if is_series(folder) else read_run(folder) for folder in folders]
    runs = [run for each in told for run in (each.runs if isinstance(each, Series) else (each,))]
    rows, groups = [row_of(run) for run in runs], groups_of(runs)
    if html is None and len(told) == 1 and not as_data:
        html = folders[0] / PAGE
    if html is not None:
        with working(f"writing {html.name}", as_data):
            page = _page(told[0]) if len(told) == 1 else comparison_page(runs, html.parent)
            replace_file(html, printable(page, keep="\n\t"))
    if as_data:
        data = {"runs": [asdict(row) for row in rows]}
        if len(told) > 1:
            data["groups"] = [_group(group) for group in groups]
        if len(told) == 1 and isinstance(told[0], Series):
            data["rules"] = [asdict(course) for course in courses(told[0].runs)]
        click.echo(json.dumps(data, indent=2))
        return
    print_table(_table(rows))
    if len(groups) < len(runs) and len(told) > 1:
        echo("")
        print_table(_means(groups))
    if html is not None:
        echo(f"page: {html}")


def _page(told: Run | Series) -> str:
    return series_page(told) if isinstance(told, Series) else run_page(told)


def _group(group: Group) -> dict[str, object]:
    """For JSON, which has neither infinity nor what is no number."""
    data = asdict(group)
    for name in ("actions", "total", "ratio"):
        data[name] = _estimate(getattr(group, name))
    return {**data, "seconds": {kind: _estimate(mean) for kind, mean in group.seconds.items()}}


def _estimate(estimate: Estimate) -> dict[str, float | None]:
    told = {"mean": estimate.value, "low": estimate.low, "high": estimate.high}
    return {name: value if isfinite(value) else None for name, value in told.items()}


def _seconds_of(kind: str) -> str:
    """The head of a column with seconds of a kind, some of which are called as something that is counted."""
    return f"{name_of(kind)} s"


def _means(groups: Sequence[Group]) -> Table:
    """A row a group: means of what ended clean."""
    kinds = kinds_of(groups)
    columns = ("runs", "not clean", "actions", "seconds", "of first")
    table = plain_table("problem", "runs of", *columns, *map(_seconds_of, kinds), left=2)
    for group in groups:
        table.add_row(
            group.problem,
            group.name,
            str(group.runs),
            str(group.failed),
            interval_text(group.actions),
            interval_text(group.total),
            interval_text(group.ratio, 2),
            *(interval_text(group.seconds[kind]) if kind in group.seconds else "-" for kind in kinds),
        )
    return table


def _table(rows: Sequence[RunRow]) -> Table:
    """A row a run; of several, also how long each took as part of the first."""
    kinds = list(in_order({kind: 0.0 for row in rows for kind, spent in row.seconds.items() if spent}))
    compared = ("of first",) if len(rows) > 1 else ()
    columns = ("strategy", "seed", "ended", "actions", "left", "seconds", *compared)
    table = plain_table("run", *columns, *map(_seconds_of, kinds))
    for row in rows:
        part = f"{100 * row.total / rows[0].total:z.0f} %" if rows[0].total else "-"
        table.add_row(
            row.name,
            row.strategy,
            str(row.seed),
            row.verdict,
            str(row.actions),
            row.remains or "-",
            f"{row.total:z.1f}",
            *((part,) if compared else ()),
            *(f"{row.seconds[kind]:z.1f}" if kind in row.seconds else "-" for kind in kinds),
        )
    return table
