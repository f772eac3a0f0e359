"""`cleancli convert`: the files of libPRADA as a domain and a problem."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

import click

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo, echo_refused
from cleancli.cli.exit_codes import ExitCode
from cleancli.conversion.convert import Converted, Wishes, convert
from cleancli.files.replace import Replacement, write_all
from cleancli.language.diagnostics.diagnostic import Level
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import RESERVED
from cleancli.language.load import read_source
from cleancli.language.parsing.lexemes import NAME

FILES = ("rules.dat", "state.dat", "symbols.dat")


def _named(context: click.Context, option: click.Parameter, name: str) -> str:
    """A name that the domain can have, with a file of its own beside problem.nid."""
    if re.fullmatch(NAME, name) is None or name in {*RESERVED, "problem"}:
        raise click.BadParameter("take letters, digits and `_`, and no word that means something already")
    return name


@command_of("convert")
@click.option("--out", type=options.FOLDER, required=True, help="Where to write.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@click.option(
    "--domain-name",
    default="domain",
    show_default=True,
    callback=_named,
    help="What the domain and its file are called.",
)
@click.option(
    "--reward", help="Like `decrease(dirty) - cost`. [default: fewer dirty objects, if there are any]"
)
@click.option("--horizon", type=click.IntRange(1, 1000), help="Steps of a plan. [default: 1 + what is dirty]")
@click.option(
    "--discount",
    type=click.FloatRange(0, 1),
    default=0.95,
    show_default=True,
    help="Worth of a reward a step later.",
)
@click.option(
    "--predicates", is_flag=True, help="Make no functions of predicates; for `plan --compat libprada`."
)
@options.as_json("Say what was converted as JSON.")
def command(
    files: tuple[str, ...],
    out: Path,
    force: bool,
    domain_name: str,
    reward: str | None,
    horizon: int | None,
    discount: float,
    predicates: bool,
    as_data: bool,
) -> int:
    """Convert rules.dat, state.dat and symbols.dat of FOLDER, or files of other names.

    Writes a domain and problem.nid into the folder --out, with comments that say what is from where. What the
    checker finds in them is printed; the exit code is 1 then.
    """
    if len(files) not in (1, len(FILES)):
        raise click.UsageError("give a folder, or the files of rules, state and symbols")
    paths = files if len(files) == len(FILES) else [str(Path(files[0]) / name) for name in FILES]
    rules, state, symbols = (read_source(path) for path in paths)
    targets = (out / f"{domain_name}.nid", out / "problem.nid")
    texts = [read_source(path).text if force and path.exists() else None for path in targets]
    wishes = Wishes(domain_name, reward, horizon, discount, predicates)
    converted = convert(rules, state, symbols, wishes, (str(targets[0]), str(targets[1])))
    _write(targets, converted, texts)
    _report(targets, converted, as_data)
    found = [diagnostic.level for diagnostic in converted.diagnostics]
    return ExitCode.REFUSED if Level.ERROR in found else ExitCode.DONE


def _write(targets: tuple[Path, Path], converted: Converted, before: Sequence[str | None]) -> None:
    """Both files or none; each must still read as it did `before` anything was converted."""
    targets[0].parent.mkdir(parents=True, exist_ok=True)
    texts = (converted.domain, converted.problem)
    write_all(Replacement(path, text, old) for path, text, old in zip(targets, texts, before, strict=True))


def _report(targets: tuple[Path, Path], converted: Converted, as_data: bool) -> None:
    if converted.diagnostics:
        echo_refused(Refused(converted.diagnostics, converted.sources))
    if as_data:
        data = {
            "domain": str(targets[0]),
            "problem": str(targets[1]),
            "functions": converted.functions,
            "notes": converted.notes,
            "mistakes": sum(d.level is Level.ERROR for d in converted.diagnostics),
            "warnings": sum(d.level is Level.WARNING for d in converted.diagnostics),
        }
        click.echo(json.dumps(data, indent=2))
        return
    echo(f"wrote {targets[0]} and {targets[1]}")
    for name, members in converted.functions.items():
        echo(f"  {', '.join(members)} are the function `{name}` now: at most one held for each object")
    for note in converted.notes:
        echo(f"  {note}")
