"""A new name for a declared thing, in all texts that use it, as edits of exactly those tokens.

Guaranteed by the caller: the texts belong together, a domain with what it includes, problems and scenes.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import RESERVED, meant
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.parsing.lexemes import NAME
from cleancli.language.refactoring.name_index import Kind, Meaning, Occurrence, names_in

RENAMABLE = (
    Kind.TYPE,
    Kind.OBJECT,
    Kind.SYMBOL,
    Kind.VALUE,
    Kind.COUNT,
    Kind.PARAMETER,
    Kind.ACTION,
    Kind.RULE,
)
"""What is renamed by its name: a variable has none outside its rule, a file is found by its own."""


def rename(
    sources: Sequence[Source], old: str, new: str, kind: Kind | None = None
) -> dict[str, tuple[Edit, ...]]:
    """Edits by path that give the thing `old` the name `new`; texts that do not use it have none.

    A value may be written with its function, `size.small`. An object is renamed in every problem that has it.
    Raises Refused: E801 where nothing is declared by the name, E802 where several things are (say the
    `kind`), E803 where the new name is taken, E804 where it is none.
    """
    names = [name for source in sources for name in names_in(source)]
    thing = _declared(names, old, kind, sources)
    refusal = refusal_of(new, thing, (name for name in names if name.declares))
    if refusal is not None:
        raise Refused([refusal], sources)
    return edits_of(names, {n.meaning for n in names if _thing(n.meaning) == _thing(thing.meaning)}, new)


def edits_of(
    names: Iterable[Occurrence], meanings: Collection[Meaning], new: str
) -> dict[str, tuple[Edit, ...]]:
    """Edits by path that write `new` wherever one of `meanings` stands."""
    edits: dict[str, tuple[Edit, ...]] = {}
    for name in names:
        if name.meaning in meanings:
            mark = "?" if name.meaning.kind is Kind.VARIABLE else ""
            edits[name.span.path] = (*edits.get(name.span.path, ()), Edit(name.span, mark + new))
    return edits


def refusal_of(new: str, thing: Occurrence, declared: Iterable[Occurrence]) -> Diagnostic | None:
    """Why a thing cannot be called `new` beside what is declared (E803, E804); None where it can."""
    if new in RESERVED and thing.meaning.kind is not Kind.VARIABLE:
        return Diagnostic("E804", f"`{new}` is a word of the language", None)
    if not re.fullmatch(NAME, new):
        help = "names consist of the letters a to z, digits and `_`, and begin with no digit"
        return Diagnostic("E804", f"`{new}` is no name", None, help=help)
    for other in declared:
        if other.meaning.name == new and _clash(other, thing):
            kind = other.meaning.kind.value
            message = f"there is already a{'n' * (kind[0] in 'aeo')} {kind} `{new}`"
            return Diagnostic("E803", message, other.span, help="choose another name")
    return None


def _clash(other: Occurrence, thing: Occurrence) -> bool:
    """Whether two declared things cannot have one name."""
    if _space(other.meaning.kind) is not _space(thing.meaning.kind):
        return False
    if thing.meaning.kind is Kind.VARIABLE:
        return other.section == thing.section
    return thing.meaning.kind is not Kind.VALUE or other.meaning.home == thing.meaning.home


def _space(kind: Kind) -> Kind:
    """Counts must differ from predicates and functions, too; apart from that, kinds may share names."""
    return Kind.SYMBOL if kind is Kind.COUNT else kind


def _thing(meaning: Meaning) -> Meaning:
    """The same for the objects of one name in all problems."""
    return Meaning(meaning.kind, meaning.name) if meaning.kind is Kind.OBJECT else meaning


def _declared(
    names: Sequence[Occurrence], old: str, kind: Kind | None, sources: Iterable[Source]
) -> Occurrence:
    """The one declaration that `old` means."""
    what = "name" if kind is None else kind.value
    wanted = RENAMABLE if kind is None else (kind,)
    declared = {_thing(n.meaning): n for n in reversed(names) if n.declares and n.meaning.kind in wanted}
    found = sorted((n for meaning, n in declared.items() if _is_called(meaning, old)), key=names.index)
    if not found:
        help = meant(old.rpartition(".")[2], {m.name for m in declared}, what)
        raise Refused([Diagnostic("E801", f"no {what} `{old}` is declared", None, help=help)], sources)
    if len(found) > 1:
        listed = " and ".join(_called(each.meaning) for each in found)
        help = "choose with --kind; a value is chosen by its function, like `size.small`"
        raise Refused([Diagnostic("E802", f"`{old}` can mean {listed}", found[0].span, help=help)], sources)
    return found[0]


def _is_called(meaning: Meaning, written: str) -> bool:
    """Whether someone means a thing who writes its name, or `home.name`."""
    home, dot, name = written.rpartition(".")
    return meaning.name == name and (not dot or meaning.home == home)


def _called(meaning: Meaning) -> str:
    name = f" `{meaning.home}.{meaning.name}`" if meaning.kind is Kind.VALUE else ""
    return f"the {meaning.kind.value}{name}"
