"""`cleancli convert`: the files of PDDL and of libPRADA as a domain and its problems."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo, echo_refused
from cleancli.cli.exit_codes import ExitCode
from cleancli.conversion.convert import Wishes, convert
from cleancli.conversion.pddl.convert import Wishes as PddlWishes
from cleancli.conversion.pddl.convert import convert as convert_pddl
from cleancli.files.replace import Replacement, write_all
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import RESERVED
from cleancli.language.load import read_source
from cleancli.language.parsing.lexemes import NAME

FILES = ("rules.dat", "state.dat", "symbols.dat")
PDDL = (".pddl", ".ppddl")
FORMATS = ("pddl", "libprada")


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
    help="What the files are. [default: pddl if one is called .pddl, else libprada]",
)
@click.option(
    "--domain-name",
    callback=_named,
    help="What the domain and its file are called. [default: as in PDDL; otherwise domain]",
)
@click.option(
    "--horizon",
    type=click.IntRange(1, 1000),
    help="Steps of a plan. [default: libPRADA: 1 + what is dirty; PDDL: 40, where rewards are to be earned]",
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
@options.as_json("Say what was converted as JSON.")
def command(
    files: tuple[str, ...],
    out: Path,
    force: bool,
    format: str | None,
    domain_name: str | None,
    horizon: int | None,
    reward: str | None,
    discount: float | None,
    predicates: bool,
    as_data: bool,
) -> int:
    """Convert PDDL and PPDDL files, a domain and any number of its problems; or rules.dat, state.dat and
    symbols.dat of libPRADA, of a folder or under other names.

    Writes a domain and its problems into the folder --out, with comments that say what is from where. What
    the checker finds in them is printed; the exit code is 1 then.
    """
    if any(name.lower().endswith(".rddl") for name in files):
        raise click.UsageError("RDDL is not converted: only PDDL, PPDDL and libPRADA's files are")
    if format is None:
        format = "pddl" if any(name.lower().endswith(PDDL) for name in files) else "libprada"
    if format == "pddl":
        if reward is not None or discount is not None or predicates:
            raise click.UsageError("--reward, --discount and --predicates are for libPRADA's files")
        made = _from_pddl(files, domain_name, horizon)
    else:
        usual = 0.95 if discount is None else discount
        made = _from_libprada(files, out, Wishes(domain_name or "domain", reward, horizon, usual, predicates))
    targets = {out / f"{name}.nid": text for name, text in made.texts.items()}
    _write(targets, force)
    _report(targets, made, as_data)
    found = [diagnostic.level for diagnostic in made.diagnostics]
    return ExitCode.REFUSED if Level.ERROR in found else ExitCode.DONE


@dataclass(frozen=True, slots=True)
class _Made:
    """The texts by the names of their files, the domain's first, and what has to be told about them."""

    texts: Mapping[str, str]
    functions: Mapping[str, tuple[str, ...]]
    notes: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


def _from_pddl(files: Sequence[str], name: str | None, horizon: int | None) -> _Made:
    made = convert_pddl([read_source(path) for path in files], PddlWishes(name, horizon))
    texts = {made.name: made.domain, **made.problems}
    return _Made(texts, {}, made.notes, made.diagnostics, made.sources)


def _from_libprada(files: Sequence[str], out: Path, wishes: Wishes) -> _Made:
    if len(files) not in (1, len(FILES)):
        raise click.UsageError("give a folder, or the files of rules, state and symbols")
    paths = files if len(files) == len(FILES) else [str(Path(files[0]) / name) for name in FILES]
    rules, state, symbols = (read_source(path) for path in paths)
    targets = (str(out / f"{wishes.name}.nid"), str(out / "problem.nid"))
    made = convert(rules, state, symbols, wishes, targets)
    texts = {wishes.name: made.domain, "problem": made.problem}
    return _Made(texts, made.functions, made.notes, made.diagnostics, made.sources)


def _write(targets: Mapping[Path, str], force: bool) -> None:
    """All files or none; each must still read as it did when this began."""
    before = [read_source(str(path)).text if force and path.exists() else None for path in targets]
    for path in targets:
        path.parent.mkdir(parents=True, exist_ok=True)
    written = zip(targets.items(), before, strict=True)
    write_all(Replacement(path, text, old) for (path, text), old in written)


def _report(targets: Mapping[Path, str], made: _Made, as_data: bool) -> None:
    if made.diagnostics:
        echo_refused(Refused(made.diagnostics, made.sources))
    domain, *problems = map(str, targets)
    if as_data:
        data = {
            "domain": domain,
            "problems": problems,
            "functions": made.functions,
            "notes": made.notes,
            "mistakes": sum(d.level is Level.ERROR for d in made.diagnostics),
            "warnings": sum(d.level is Level.WARNING for d in made.diagnostics),
        }
        click.echo(json.dumps(data, indent=2))
        return
    echo(f"wrote {' and '.join([domain, *problems])}")
    for name, members in made.functions.items():
        echo(f"  {', '.join(members)} are the function `{name}` now: at most one held for each object")
    for note in made.notes:
        echo(f"  {note}")
