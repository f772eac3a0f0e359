"""`cleancli convert`: the files of PDDL and of libPRADA as a domain and its problems, and the other way."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

import click

from cleancli.api.conversion_result import ConversionResult
from cleancli.api.conversions import FORMATS, TARGETS, Wanted, converted
from cleancli.api.experience_files import DATA, LINES, TRAJECTORY
from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo, echo_refused
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.inputs import may_include_outside
from cleancli.cli.usage import usage_errors
from cleancli.conversion.export.written import NOISE
from cleancli.language.diagnostics.diagnostic import Level
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import RESERVED
from cleancli.language.parsing.lexemes import NAME

FEW = 3
"""Files of experience that are named one by one."""


def _named(context: click.Context, option: click.Parameter, name: str | None) -> str | None:
    """A name that the domain can have, with a file of its own beside problem.nid."""
    if name is not None and (re.fullmatch(NAME, name) is None or name in {*RESERVED, "problem"}):
        raise click.BadParameter("take letters, digits and `_`, and no word that means something already")
    return name


@command_of("convert")
@click.option("--out", type=options.FOLDER, required=True, help="Where to write.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@click.option(
    "--from",
    "format",
    type=click.Choice(FORMATS),
    help="What the files are. [default: as they are called: .nid, .pddl; otherwise libprada]",
)
@click.option(
    "--to", type=click.Choice(TARGETS), default=TARGETS[0], show_default=True, help="What to write."
)
@click.option(
    "--domain-name",
    callback=_named,
    help="What the domain and its file are called. [default: as in PDDL; otherwise domain]",
)
@click.option(
    "--horizon",
    type=click.IntRange(1, 1000),
    help="Steps of a plan. [default: libPRADA: 1 + what is dirty; PDDL: 40 for rewards, else unlimited]",
)
@click.option(
    "--reward",
    help="libPRADA: like `decrease(dirty) - cost`. [default: fewer dirty objects, if there are any]",
)
@click.option(
    "--discount",
    type=click.FloatRange(0, 1),
    help="libPRADA: worth of a reward a step later. [default: 0.95]",
)
@click.option(
    "--predicates",
    is_flag=True,
    help="libPRADA: make no functions of predicates; for `plan --compat libprada`.",
)
@click.option(
    "--noise",
    type=click.Choice(NOISE),
    default=NOISE[0],
    show_default=True,
    help="With --to: noise changes nothing there, or makes `noise` true.",
)
@options.as_json("Say what was converted as JSON.")
def command(
    files: tuple[str, ...],
    out: Path,
    force: bool,
    format: str | None,
    to: str,
    domain_name: str | None,
    horizon: int | None,
    reward: str | None,
    discount: float | None,
    predicates: bool,
    noise: str,
    as_data: bool,
) -> int:
    """Convert PDDL and PPDDL files, a domain and any number of its problems; or rules.dat, state.dat and
    symbols.dat of libPRADA, of a folder or under other names. With --to, a domain and its problems (.nid or
    PPDDL) are written as files of another language. Experience (.jsonl) becomes trajectories of PDDL or
    data.dat of libPRADA, and these become experience, where they are given beside their domain.

    Writes a domain and its problems into the folder --out, with comments that say what is from where. What
    the checker finds in them is printed; the exit code is 1 then.
    """
    wanted = Wanted(format, to, domain_name, horizon, reward, discount, predicates, noise)
    with usage_errors():
        made = converted(files, wanted, out, may_include_outside())
    made.write(out, force=force)
    _report(tuple(made.files(out)), made, as_data)
    found = [diagnostic.level for diagnostic in made.diagnostics]
    return ExitCode.REFUSED if Level.ERROR in found else ExitCode.DONE


def _few(paths: Sequence[str]) -> list[str]:
    """The paths, or the first and the last of many."""
    return [*paths] if len(paths) <= FEW else [f"{paths[0]} to {paths[-1]}"]


def _report(targets: Sequence[Path], made: ConversionResult, as_data: bool) -> None:
    if made.diagnostics:
        echo_refused(Refused(made.diagnostics, made.sources))
    kinds = (LINES, TRAJECTORY, DATA)
    experience = [str(path) for path in targets if path.name.endswith(kinds)]
    written = [str(path) for path in targets if str(path) not in experience]
    if as_data:
        data = {
            "domain": written[0] if written else None,
            "problems": written[1:],
            "experience": experience,
            "functions": made.functions,
            "notes": made.notes,
            "names": made.names,
            "mistakes": sum(d.level is Level.ERROR for d in made.diagnostics),
            "warnings": sum(d.level is Level.WARNING for d in made.diagnostics),
        }
        click.echo(json.dumps(data, indent=2))
        return
    echo(f"wrote {' and '.join([*written, *_few(experience)])}")
    for name, members in made.functions.items():
        echo(f"  {', '.join(members)} are the function `{name}` now: at most one held at a time")
    for old, new in made.names.items():
        echo(f"  `{old}` is called `{new}` there")
    for note in made.notes:
        echo(f"  {note}")
