"""A new name for a declared thing, in all texts that use it, as edits of exactly those tokens.

Guaranteed by the caller: the texts belong together, a domain with problems and scenes for it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from cleancli.language.diagnostics import Diagnostic, Refused, Source
from cleancli.language.edit import Edit
from cleancli.language.findings import RESERVED, meant
from cleancli.language.names import Kind, Occurrence, names_in

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
RENAMABLE = (Kind.TYPE, Kind.OBJECT, Kind.SYMBOL, Kind.VALUE, Kind.COUNT, Kind.ACTION, Kind.RULE)
"""A variable has no name outside its rule, and what a file holds is found by the file's name."""


def rename(
    sources: Sequence[Source], old: str, new: str, kind: Kind | None = None
) -> dict[str, tuple[Edit, ...]]:
    """Edits by path that give the thing `old` the name `new`; texts that do not use it have none.

    A value may be written with its function, `size.small`. Raises Refused: E801 where nothing is declared by
    the name, E802 where several things are (say the `kind`), E803 where the new name is taken, E804 where it
    is none.
    """
    names = [name for source in sources for name in names_in(source)]
    thing = _declared(names, old, kind, sources)
    _refuse_new_name(names, thing, new, sources)
    found = [name for name in names if name.thing == thing.thing]
    edits = {
        source.path: tuple(Edit(n.span, new) for n in found if n.span.path == source.path)
        for source in sources
    }
    return {path: changes for path, changes in edits.items() if changes}


def _declared(
    names: Sequence[Occurrence], old: str, kind: Kind | None, sources: Iterable[Source]
) -> Occurrence:
    """The one declaration that `old` means."""
    owner, dot, name = old.rpartition(".")
    wanted = RENAMABLE if kind is None else (kind,)
    declarations = [n for n in names if n.declares and n.kind in wanted]
    found = {n.thing: n for n in declarations if n.name == name and (not dot or n.owner == owner)}
    what = "name" if kind is None else kind.value
    if not found:
        help = meant(name, {n.name for n in declarations}, what)
        raise Refused([Diagnostic("E801", f"no {what} `{old}` is declared", None, help=help)], sources)
    if len(found) > 1:
        listed = " and ".join(_called(n) for n in found.values())
        help = "choose with --kind; a value is chosen by its function, like `size.small`"
        first = next(iter(found.values()))
        raise Refused([Diagnostic("E802", f"`{old}` can mean {listed}", first.span, help=help)], sources)
    return next(iter(found.values()))


def _called(name: Occurrence) -> str:
    return f"the {name.kind.value} `{name.owner}.{name.name}`" if name.owner else f"the {name.kind.value}"


def _refuse_new_name(
    names: Sequence[Occurrence], thing: Occurrence, new: str, sources: Iterable[Source]
) -> None:
    if new in RESERVED:
        raise Refused([Diagnostic("E804", f"`{new}` is a word of the language", None)])
    if not _NAME.fullmatch(new):
        help = "names consist of the letters a to z, digits and `_`, and begin with no digit"
        raise Refused([Diagnostic("E804", f"`{new}` is no name", None, help=help)])
    taken = [
        n
        for n in names
        if n.declares and n.name == new and n.owner == thing.owner and _space(n.kind) is _space(thing.kind)
    ]
    if taken:
        message = f"there is already a {taken[0].kind.value} `{new}`"
        raise Refused([Diagnostic("E803", message, taken[0].span, help="choose another name")], sources)


def _space(kind: Kind) -> Kind:
    """Counts must differ from predicates and functions, too; apart from that, kinds may share names."""
    return Kind.SYMBOL if kind is Kind.COUNT else kind
