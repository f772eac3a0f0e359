"""`cleancli check`: every mistake in the named files, located."""

from __future__ import annotations

import json
import sys

import click

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.inputs import check_file
from cleancli.language.diagnostics import Refused
from cleancli.language.render import as_json, render


@click.command("check", short_help="Report every mistake in domain, problem and scene files.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--json", "as_data", is_flag=True, help="Print the diagnostics as JSON.")
def command(files: tuple[str, ...], as_data: bool) -> int:
    """Report every mistake in FILEs: domains, problems or scenes, by path or shipped name.

    Exit code 1 if there is any, 0 if there is none.
    """
    found = [refused for name in files if (refused := _mistakes(name)) is not None]
    if as_data:
        data = [entry for refused in found for entry in as_json(refused.diagnostics, refused.sources)]
        click.echo(json.dumps(data, indent=2))
    else:
        for refused in found:
            click.echo(render(refused.diagnostics, refused.sources, colour=_is_terminal()))
        count = sum(len(refused.diagnostics) for refused in found)
        click.echo(f"{count} mistake{'s' * (count != 1)} in {len(files)} file{'s' * (len(files) != 1)}")
    return ExitCode.REFUSED if found else ExitCode.DONE


def _mistakes(name: str) -> Refused | None:
    try:
        check_file(name)
    except Refused as refused:
        return refused
    return None


def _is_terminal() -> bool:
    return sys.stdout.isatty()
