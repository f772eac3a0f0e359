"""`cleancli rename`: a new name for a declared thing, in a domain, what it includes, and its problems."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import click

from cleancli.cli.command_table import command_of
from cleancli.cli.completion import domains
from cleancli.cli.echo import echo
from cleancli.cli.files import echo_difference
from cleancli.cli.inputs import may_include_outside
from cleancli.files.replace import Replacement, write_all
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.text_edit import Edit, apply_edits
from cleancli.language.find import find
from cleancli.language.load import Checked, checked_domain, kind_of, load_problem, read_source
from cleancli.language.model import Domain
from cleancli.language.refactoring.name_index import Kind
from cleancli.language.refactoring.rename import RENAMABLE, rename
from cleancli.scene.check import load_scene


@command_of("rename")
@click.option("--domain", required=True, shell_complete=domains, help="The domain that declares or uses it.")
@click.option("--kind", type=click.Choice([kind.value for kind in RENAMABLE]), help="What is named OLD.")
@click.option("--write", is_flag=True, help="Change the files.")
def command(
    old: str, new: str, domain: str, problem_files: tuple[str, ...], kind: str | None, write: bool
) -> None:
    """Rename OLD to NEW in a domain, the files it includes and PROBLEMs of it: a type, object, symbol
    (predicate or function), value, count, shared parameter, action or rule.

    Only names that mean this thing change. Prints the change as a diff; only --write changes files, and then
    all of them, after each was found to be right with the new name and unchanged on disk. Files that are
    neither named nor included are left alone.
    """
    paths = [_found(domain, "domains", write), *(_found(name, "problems", write) for name in problem_files)]
    checked = checked_domain(read_source(paths[0]), may_include_outside())
    sources = (*checked.sources, *_others(paths[1:], checked.sources))
    edits = _edits(sources, old, new, kind, checked)
    texts = {s.path: Source(s.path, apply_edits(s.text, edits.get(s.path, ()))) for s in sources}
    _check([texts[source.path] for source in sources], len(checked.sources))
    for source in sources:
        echo_difference(source, texts[source.path].text, "renamed")
    if write:
        write_all(Replacement(Path(s.path), texts[s.path].text, s.text) for s in sources if s.path in edits)
    places = sum(map(len, edits.values()))
    echo(f"{plural(places, 'place')} in {len(edits)} of {plural(len(sources), 'file')}", err=not write)


def _found(name: str, folder: str, write: bool) -> Path:
    """A file as the command line names it; none that ships with the program is written."""
    path = find(name, folder)
    if write and not Path(name).is_file():
        raise click.UsageError(f"`{name}` ships with cleancli: copy {path}, and rename there")
    return path


def _others(paths: Sequence[Path], known: Sequence[Source]) -> tuple[Source, ...]:
    """The texts of the files that are not among the known ones, under whatever path, each once."""
    places = {Path(source.path).resolve() for source in known}
    files = {path.resolve(): path for path in paths}
    return tuple(read_source(path) for place, path in files.items() if place not in places)


def _edits(
    sources: Sequence[Source], old: str, new: str, kind: str | None, checked: Checked[Domain]
) -> Mapping[str, tuple[Edit, ...]]:
    """The edits by path; where there can be none, mistakes of the domain are told first: they may be why."""
    try:
        return rename(sources, old, new, None if kind is None else Kind(kind))
    except Refused:
        checked.get()
        raise


def _check(sources: Sequence[Source], of_domain: int) -> None:
    """Refuse a new name that would make a mistake; the domain comes first, then what it includes."""
    texts = {source.path: source for source in sources[:of_domain]}

    def read(path: Path) -> Source:
        return texts.get(str(path)) or read_source(path)

    domain = checked_domain(sources[0], may_include_outside(), read).get()
    for source in sources[of_domain:]:
        if kind_of(source) == "scene":
            load_scene(source)
        else:
            load_problem(source, domain)
