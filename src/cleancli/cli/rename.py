"""`cleancli rename`: a new name for a declared thing, in a domain and the problems that use it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from cleancli.cli.completion import domains, problems, renamable
from cleancli.cli.files import echo_difference
from cleancli.language.diagnostics import Source
from cleancli.language.edit import Change, apply_edits, write_all
from cleancli.language.load import kind_of, load_domain, load_problem, read_source
from cleancli.language.names import Kind
from cleancli.language.rename import RENAMABLE, rename
from cleancli.scene.check import load_scene
from cleancli.shipped import find


@click.command("rename", short_help="Rename a declared thing in a domain and its problems.")
@click.argument("old", shell_complete=renamable)
@click.argument("new")
@click.option("--domain", required=True, shell_complete=domains, help="The domain that declares or uses it.")
@click.argument("problem_files", nargs=-1, metavar="[PROBLEM]...", shell_complete=problems)
@click.option("--kind", type=click.Choice([kind.value for kind in RENAMABLE]), help="What is named OLD.")
@click.option("--write", is_flag=True, help="Change the files.")
def command(
    old: str, new: str, domain: str, problem_files: tuple[str, ...], kind: str | None, write: bool
) -> None:
    """Rename OLD to NEW in a domain and in PROBLEMs of it: a type, object, symbol (predicate or function),
    value, count, shared parameter, action or rule.

    Only names that mean this thing change. Prints the change as a diff; only --write changes files, and then
    all of them, after each was found to be right with the new name and unchanged on disk.
    """
    files = [_File(domain, "domains"), *(_File(name, "problems") for name in problem_files)]
    if write:
        for file in files:
            file.refuse_shipped()
    sources = [file.source for file in files]
    edits = rename(sources, old, new, None if kind is None else Kind(kind))
    texts = [apply_edits(source.text, edits.get(source.path, ())) for source in sources]
    _check([Source(source.path, text) for source, text in zip(sources, texts, strict=True)])
    for source, text in zip(sources, texts, strict=True):
        echo_difference(source, text, "renamed")
    changes = [
        Change(file.path, text, file.source.text)
        for file, text in zip(files, texts, strict=True)
        if text != file.source.text
    ]
    places = sum(map(len, edits.values()))
    click.echo(f"{places} place{'s' * (places != 1)} in {len(changes)} of {len(files)} files", err=not write)
    if write:
        write_all(changes)


class _File:
    """A file as the command line names it, found and read."""

    def __init__(self, name: str, folder: str) -> None:
        self.name = name
        self.path: Path = find(name, folder)
        self.source = read_source(self.path)

    def refuse_shipped(self) -> None:
        if not Path(self.name).is_file():
            raise click.UsageError(f"`{self.name}` ships with cleancli: copy {self.path}, and rename there")


def _check(sources: Sequence[Source]) -> None:
    """Refuse a new name that would make a mistake; the domain comes first."""
    domain = load_domain(sources[0])
    for source in sources[1:]:
        if kind_of(source) == "scene":
            load_scene(source)
        else:
            load_problem(source, domain)
