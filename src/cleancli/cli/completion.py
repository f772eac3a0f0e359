"""What the shell offers for an argument: shipped names, files of the user, and names declared in them.

lark is only loaded to complete names that are declared in a file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import click
from click.shell_completion import CompletionItem

from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.resources import shipped_names

Completer = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


def _matching(names: Iterable[str], incomplete: str) -> list[CompletionItem]:
    return [CompletionItem(name) for name in sorted(set(names)) if name.startswith(incomplete)]


def _shipped_or_file(*kinds: str) -> Completer:
    """Shipped names, .nid files and folders; where only folders fit, the shell goes on by itself."""

    def complete(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        files, folders = _paths(incomplete)
        names = [name for kind in kinds for name in shipped_names(kind)]
        found = _matching([*names, *files], incomplete)
        return found + _matching(folders, incomplete) if found else [CompletionItem(incomplete, type="file")]

    return complete


def _paths(incomplete: str) -> tuple[list[str], list[str]]:
    """The .nid files and the folders that a path may go on with; hidden ones only if it says so."""
    start, slash, beginning = incomplete.rpartition("/")
    try:
        entries = [e for e in Path(start + slash or ".").iterdir() if e.name.startswith(beginning)]
    except OSError:
        return [], []
    shown = [entry for entry in entries if beginning or not entry.name.startswith(".")]
    files = [start + slash + e.name for e in shown if e.suffix == ".nid" and e.is_file()]
    return files, [f"{start}{slash}{e.name}/" for e in shown if e.is_dir()]


nid_files = _shipped_or_file()
domains = _shipped_or_file("domains")
problems = _shipped_or_file("problems")
studies = _shipped_or_file("studies")
check_files = _shipped_or_file("domains", "problems", "studies")


def actions(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """The actions of the domain that stands before, with their opening bracket."""
    names = _declared(ctx.params.get("domain"), {"action"})
    return _matching([f"{name}(" for name in names], incomplete)


def renamable(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """What the domain of --domain declares, if it stands before; else what the files of this folder do."""
    kinds = {"type", "object", "symbol", "value", "count", "parameter", "action", "rule"}
    given = ctx.params.get("domain")
    files = [given] if given else _paths("")[0]
    return _matching([name for file in files for name in _declared(file, kinds)], incomplete)


def _declared(domain: str | None, kinds: set[str]) -> list[str]:
    """Names of some kinds that a domain declares; none where it cannot be read.

    lark is loaded here, and so by no other completion.
    """
    from cleancli.language.load import read_source
    from cleancli.language.refactoring.name_index import names_in

    if domain is None:
        return []
    try:
        found = names_in(read_source(find(domain, "domains")))
    except Refused:
        return []
    return [name.meaning.name for name in found if name.declares and name.meaning.kind.value in kinds]
