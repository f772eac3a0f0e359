"""`cleancli check`: every mistake in the named files, located."""

from __future__ import annotations

import json
from collections.abc import Sequence

import click

from cleancli.cli.completion import check_files
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.files import expanded
from cleancli.cli.inputs import check_file
from cleancli.cli.report import echo_refused
from cleancli.language.diagnostics import Refused
from cleancli.language.render import as_json


@click.command("check", short_help="Report every mistake in domain, problem and scene files.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...", shell_complete=check_files)
@click.option("--format", "style", type=click.Choice(["text", "json"]), default="text", show_default=True)
@click.option("--json", "style", flag_value="json", help="The same as --format json.")
def command(files: tuple[str, ...], style: str) -> int:
    """Report every mistake in FILEs: domains, problems or scenes, by path or shipped name.

    A folder stands for all .nid files in it and in its folders, `-` for standard input. A problem is checked
    with the domain that it names, found beside it or among the shipped ones. Exit code 1 if there is any
    mistake, 0 if there is none.
    """
    names = tuple(expanded(files))
    found = [refused for name in names if (refused := _mistakes(name)) is not None]
    if style == "json":
        data = [entry for refused in found for entry in as_json(refused.diagnostics, refused.sources)]
        click.echo(json.dumps(data, indent=2))
    else:
        _print(found, len(names))
    return ExitCode.REFUSED if found else ExitCode.DONE


def _print(found: Sequence[Refused], files: int) -> None:
    for refused in found:
        echo_refused(refused, err=False)
    count = sum(len(refused.diagnostics) for refused in found)
    click.echo(f"{count} mistake{'s' * (count != 1)} in {files} file{'s' * (files != 1)}")


def _mistakes(name: str) -> Refused | None:
    try:
        check_file(name)
    except Refused as refused:
        return refused
    return None
