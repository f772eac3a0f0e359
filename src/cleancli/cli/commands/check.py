"""`cleancli check`: every mistake in the named files, located."""

from __future__ import annotations

import json
import sys

import click

from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo, wants_colour
from cleancli.cli.elsewhere import without_used_elsewhere
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.files import expanded
from cleancli.cli.inputs import CHECKED, check_file
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source
from cleancli.language.diagnostics.messages import MOST, distinct, excerpt
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import as_json, as_sarif, render


@command_of("check")
@click.option(
    "--format", "style", type=click.Choice(["text", "json", "sarif"]), default="text", show_default=True
)
@click.option("--json", "style", flag_value="json", help="The same as --format json.")
@click.option("--all", "is_all", is_flag=True, help=f"Show all mistakes and warnings, not only {MOST}.")
def command(files: tuple[str, ...], style: str, is_all: bool) -> int:
    """Report every mistake in FILEs: domains, problems, scenes or studies, by path or shipped name.

    A folder stands for all .nid, .pddl and .ppddl files in it and in its folders, `-` for standard input. A
    problem is checked with the domain that it names, found beside it or among the shipped ones; one in PPDDL
    with that found among FILEs or beside it. A mistake to which several files
    lead is reported once. Exit code 1 if there is any mistake, 0 if there is none; warnings are printed and
    change nothing.
    """
    names = tuple(expanded(files, CHECKED))
    found = [_found(name, names) for name in names]
    diagnostics = distinct(diagnostic for some, _ in found for diagnostic in some)
    diagnostics = without_used_elsewhere(diagnostics, (some for _, some in found))
    sources = tuple(dict.fromkeys(source for _, some in found for source in some))
    levels = [diagnostic.level for diagnostic in diagnostics]
    part = excerpt(diagnostics, None if is_all else MOST)
    match style:
        case "json":
            click.echo(json.dumps(as_json(part.shown, sources, part.left_out), indent=2))
        case "sarif":
            click.echo(json.dumps(as_sarif(part.shown, sources, left_out=part.left_out), indent=2))
        case _:
            if part.shown:
                click.echo(render(part.shown, sources, colour=wants_colour(sys.stdout)))
            if part.left_out:
                echo(f"{part.note}: --all shows all")
            echo(_summary(levels.count(Level.ERROR), levels.count(Level.WARNING), len(names)))
    return ExitCode.REFUSED if Level.ERROR in levels else ExitCode.DONE


def _found(name: str, names: tuple[str, ...]) -> tuple[tuple[Diagnostic, ...], tuple[Source, ...]]:
    try:
        return check_file(name, names)
    except Refused as refused:
        return refused.diagnostics, refused.sources


def _summary(mistakes: int, warnings: int, files: int) -> str:
    also = f" and {plural(warnings, 'warning')}" if warnings else ""
    return f"{plural(mistakes, 'mistake')}{also} in {plural(files, 'file')}"
