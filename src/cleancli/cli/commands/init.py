"""`cleancli init`: a small domain and a problem to start from."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import click

from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.files.replace import Replacement, write_all
from cleancli.language.load import read_source

FOLDER = Path(__file__).parent / "starter"


class Starter(NamedTuple):
    """The files of a domain and of a problem, and an action of the problem that can be explained."""

    domain: str
    problem: str
    action: str


STARTERS: Mapping[str, Starter] = MappingProxyType(
    {
        "wiping": Starter("wiping.nid", "two_stains.nid", "wipe(s2)"),
        "delivery": Starter("delivery.nid", "two_parcels.nid", "drive(hall, lab)"),
    }
)


@command_of("init")
@click.option(
    "--about",
    type=click.Choice(list(STARTERS)),
    default="wiping",
    show_default=True,
    help="What the domain is about: stains and a cloth, or parcels and a cart, with a goal.",
)
def command(folder: Path, about: str) -> None:
    """Write a commented domain and a problem of it into FOLDER: wiping.nid and two_stains.nid, or
    delivery.nid and two_parcels.nid.

    FOLDER is made if there is none; the default is the current one. Files that exist are never replaced.
    """
    starter = STARTERS[about]
    names = (starter.domain, starter.problem)
    folder.mkdir(parents=True, exist_ok=True)
    write_all([Replacement(folder / name, read_source(FOLDER / name).text, None) for name in names])
    domain, problem = (shlex.quote(str(folder / name)) for name in names)
    echo(f"wrote {domain} and {problem}; now try")
    echo(f"  cleancli check {domain} {problem}")
    echo(f"  cleancli plan {domain} {problem}")
    echo(f'  cleancli explain {domain} {problem} "{starter.action}"')
