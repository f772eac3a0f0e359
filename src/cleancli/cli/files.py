"""The files that FILES, FOLDERS and `-` on a command line mean, and changes to them as diffs."""

from __future__ import annotations

import difflib
import sys
from collections.abc import Collection, Iterator
from pathlib import Path

from cleancli.cli.echo import echo, echo_exactly
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import read_source, read_stream

STDIN = "-"


RECORDS = ("run.json", "series.json", "episodes.jsonl")
"""What the folders of runs, series and studies hold, beside copies of the files that went in."""


def below(folder: Path, suffixes: Collection[str] = (".nid",)) -> tuple[Path, ...]:
    """All .nid files, or those with other suffixes, in a folder and its folders, sorted, no hidden ones;
    refuses (E002) where none is."""
    found = [
        path
        for path in sorted(folder.rglob("*"))
        if path.suffix in suffixes
        and path.is_file()
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    ]
    if not found:
        raise Refused([Diagnostic("E002", f"`{folder}` is a folder without .nid files", None)])
    return tuple(found)


def expanded(names: tuple[str, ...], suffixes: Collection[str] = (".nid",)) -> Iterator[str]:
    """The names with the files `below` each folder in its place; a folder without any stands for itself.

    Copies in the folders of runs, series and studies are passed over, unless such a folder is named, and a
    note counts them.
    """
    copies = 0
    for name in names:
        if Path(name).is_dir():
            try:
                found = below(Path(name), suffixes)
            except Refused:
                yield name
                continue
            own = [path for path in found if not _is_copy(path, Path(name))]
            copies += len(found) - len(own)
            yield from map(str, own)
        else:
            yield name
    if copies:
        told = plural(copies, "copy", "copies")
        echo(f"note: passed over {told} of files in folders of runs and studies", err=True)


def _is_copy(path: Path, folder: Path) -> bool:
    """Whether a file is in the folder of a run, a series or a study, which is below a folder."""
    parents = [parent for parent in path.parents if parent.is_relative_to(folder) and parent != folder]
    return any((parent / record).is_file() for parent in parents for record in RECORDS)


def read(name: str) -> Source:
    """The text of a file, or of standard input for `-`; raises Refused."""
    if name == STDIN:
        return read_stream(sys.stdin.buffer, "<stdin>")
    if Path(name).is_dir():
        below(Path(name))
    return read_source(name)


def echo_difference(source: Source, text: str, what: str) -> None:
    """Print a unified diff from the text as it is to what it would be."""
    old, new = source.text.splitlines(), text.splitlines()
    for line in difflib.unified_diff(old, new, source.path, f"{source.path} ({what})", lineterm=""):
        echo_exactly(f"{line}\n")
