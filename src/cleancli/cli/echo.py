"""Text on its way to a person; what commands print goes through here, so that no file steers a terminal."""

from __future__ import annotations

import os
import sys
from typing import TextIO

import click

from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.diagnostics.messages import MOST, Excerpt, excerpt
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import render

_SHOWN, _LEFT_OUT = f"{__name__}.shown", f"{__name__}.left_out"


def echo(text: str = "", err: bool = False, nl: bool = True) -> None:
    """Print a text with its line ends and tabs; other control characters are shown, not sent."""
    click.echo(printable(text, keep="\n\t"), err=err, nl=nl)


def echo_exactly(text: str) -> None:
    """Print the text of a file, to a program byte for byte, to a terminal as `echo` does."""
    if sys.stdout.isatty():
        echo(text, nl=False)
    else:
        sys.stdout.buffer.write(text.encode("utf-8", "surrogateescape"))


def echo_refused(refused: Refused, err: bool = True) -> None:
    """Print the mistakes, to standard error or to standard output; of one run no more than `MOST`, and at its
    end how many are left out."""
    context = click.get_current_context(silent=True)
    before = 0 if context is None else context.meta.get(_SHOWN, 0)
    part = excerpt(refused.diagnostics, MOST - before)
    if context is not None:
        context.meta[_SHOWN] = before + len(part.shown)
    stream = sys.stderr if err else sys.stdout
    if part.shown:
        # The renderer makes control characters visible; the only ones left are its own colours.
        click.echo(render(part.shown, refused.sources, colour=wants_colour(stream)), err=err)
    if context is None:
        _echo_left_out(part, err)
    elif part.left_out:
        if _LEFT_OUT not in context.meta:
            context.call_on_close(lambda: _echo_left_out(context.meta[_LEFT_OUT], err))
        known = context.meta.get(_LEFT_OUT, Excerpt(()))
        context.meta[_LEFT_OUT] = Excerpt((), known.mistakes + part.mistakes, known.warnings + part.warnings)


def _echo_left_out(part: Excerpt, err: bool) -> None:
    if part.left_out:
        echo(f"{part.note}: `cleancli check --all` shows all of .nid files", err=err)


def wants_colour(stream: TextIO) -> bool:
    """Colour for a terminal, but neither for a dumb one nor where NO_COLOR is set (https://no-color.org)."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
