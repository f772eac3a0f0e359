"""`cleancli lsp`: the language server that editors start."""

from __future__ import annotations

from collections.abc import Callable

import click

from cleancli.cli.command_table import command_of
from cleancli.cli.exit_codes import ExitCode, MissingPart


@command_of("lsp")
def command() -> int:
    """Speak the Language Server Protocol over standard input and output.

    An editor starts this, not a person: docs/editors.md says how.
    """
    refused = _server()()
    if refused:
        click.echo(f"error: {refused}: the editor was cut off", err=True)
        return ExitCode.FILES
    return ExitCode.DONE


def _server() -> Callable[[], str]:
    """The server, imported here because pygls is an optional part; raises MissingPart."""
    try:
        from cleancli.editor.server import serve
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] not in ("pygls", "lsprotocol"):
            raise
        raise MissingPart("the language server needs pygls: pip install 'pygls>=2.0'") from error
    return serve
