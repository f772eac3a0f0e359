"""`cleancli fmt`: files in the canonical layout."""

from __future__ import annotations

from pathlib import Path

import click

from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo, echo_exactly, echo_refused
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.files import STDIN, echo_difference, expanded, read
from cleancli.files.replace import write_atomically
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.printing.formatter import layout


@command_of("fmt")
@click.option("--check", is_flag=True, help="Change nothing; name the files that are laid out otherwise.")
@click.option("--diff", is_flag=True, help="Change nothing; print what would change.")
def command(files: tuple[str, ...], check: bool, diff: bool) -> int:
    """Lay out FILEs, and all .nid files in folders among them; `-` formats standard input to standard output.

    Only blanks and line breaks change. A file with syntax errors is left alone. Exit code 1 if there is
    one, or if --check finds a file that would change.
    """
    failed = changed = unchanged = 0
    for name in expanded(files):
        try:
            is_new = _format(name, check, diff)
        except Refused as refused:
            echo_refused(refused)
            failed += 1
        else:
            changed += is_new
            unchanged += not is_new
    if STDIN not in files:
        echo(_summary(changed, unchanged, failed, dry=check or diff), err=diff)
    return ExitCode.REFUSED if failed or (check and changed) else ExitCode.DONE


def _format(name: str, check: bool, diff: bool) -> bool:
    """Format one file, and say whether its layout was another."""
    source = read(name)
    text = layout(source.text, source.path)
    is_new = text != source.text
    if diff:
        echo_difference(source, text, "formatted")
    elif is_new and check:
        echo(f"would format {source.path}", err=name == STDIN)
    elif name == STDIN and not check:
        echo_exactly(text)
    elif is_new:
        write_atomically(Path(name), text, source.text)
        echo(f"formatted {source.path}")
    return is_new


def _summary(changed: int, unchanged: int, failed: int, dry: bool) -> str:
    counts = [
        (changed, "would change" if dry else "changed"),
        (unchanged, "unchanged"),
        (failed, "left alone for mistakes"),
    ]
    return "files: " + ", ".join(f"{count} {what}" for count, what in counts if count or what == "unchanged")
