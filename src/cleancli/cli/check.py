"""`cleancli check`: every mistake in the named files, located."""

from __future__ import annotations

import json
import sys

import click

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.inputs import check_file
from cleancli.language.diagnostics import Diagnostic, Level, Refused, Source
from cleancli.language.render import as_json, render


@click.command("check", short_help="Report every mistake in domain, problem and scene files.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--json", "as_data", is_flag=True, help="Print the diagnostics as JSON.")
def command(files: tuple[str, ...], as_data: bool) -> int:
    """Report every mistake in FILEs: domains, problems or scenes, by path or shipped name.

    Exit code 1 if there is any, 0 if there is none; warnings are printed and change nothing.
    """
    found = [_found(name) for name in files]
    levels = [diagnostic.level for diagnostics, _ in found for diagnostic in diagnostics]
    mistakes, warnings = levels.count(Level.ERROR), levels.count(Level.WARNING)
    if as_data:
        data = [entry for diagnostics, sources in found for entry in as_json(diagnostics, sources)]
        click.echo(json.dumps(data, indent=2))
    else:
        for diagnostics, sources in found:
            if diagnostics:
                click.echo(render(diagnostics, sources, colour=_is_terminal()))
        also = f" and {_number(warnings, 'warning')}" if warnings else ""
        click.echo(f"{_number(mistakes, 'mistake')}{also} in {_number(len(files), 'file')}")
    return ExitCode.REFUSED if mistakes else ExitCode.DONE


def _found(name: str) -> tuple[tuple[Diagnostic, ...], tuple[Source, ...]]:
    try:
        return check_file(name)
    except Refused as refused:
        return refused.diagnostics, refused.sources


def _number(count: int, what: str) -> str:
    return f"{count} {what}{'s' * (count != 1)}"


def _is_terminal() -> bool:
    return sys.stdout.isatty()
