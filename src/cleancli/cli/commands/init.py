"""`cleancli init`: a small domain and a problem to start from."""

from __future__ import annotations

import shlex
from pathlib import Path

from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.files.replace import Replacement, write_all
from cleancli.language.load import read_source

STARTER = Path(__file__).parent / "starter"
FILES = ("wiping.nid", "two_stains.nid")


@command_of("init")
def command(folder: Path) -> None:
    """Write wiping.nid and two_stains.nid, a commented domain and a problem of it, into FOLDER.

    FOLDER is made if there is none; the default is the current one. Files that exist are never replaced.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_all([Replacement(folder / name, read_source(STARTER / name).text, None) for name in FILES])
    domain, problem = (shlex.quote(str(folder / name)) for name in FILES)
    echo(f"wrote {domain} and {problem}; now try")
    echo(f"  cleancli check {domain} {problem}")
    echo(f"  cleancli plan {domain} {problem}")
    echo(f'  cleancli explain {domain} {problem} "wipe(s2)"')
