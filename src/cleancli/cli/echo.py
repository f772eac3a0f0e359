"""Diagnostics on their way to a person."""

from __future__ import annotations

import os
import sys
from typing import TextIO

import click

from cleancli.language.diagnostics import Refused
from cleancli.language.render import render


def echo_refused(refused: Refused, err: bool = True) -> None:
    """Print every mistake, to standard error or to standard output."""
    stream = sys.stderr if err else sys.stdout
    click.echo(render(refused.diagnostics, refused.sources, colour=wants_colour(stream)), err=err)


def wants_colour(stream: TextIO) -> bool:
    """Colour for a terminal, but neither for a dumb one nor where NO_COLOR is set (https://no-color.org)."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
