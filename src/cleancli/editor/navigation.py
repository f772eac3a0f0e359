"""From a name to its declaration, its uses, and another name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from cleancli.editor.library import Document, Library
from cleancli.editor.names import Kind, Meaning, Occurrence
from cleancli.language.diagnostics import Span
from cleancli.language.edit import Edit
from cleancli.language.findings import RESERVED

RENAMED = frozenset(
    {Kind.TYPE, Kind.OBJECT, Kind.SYMBOL, Kind.VALUE, Kind.COUNT, Kind.ACTION, Kind.RULE, Kind.VARIABLE}
)
"""What can be renamed. A domain's name is also that of its file, and the rest are words of the language."""

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class CannotRename(Exception):
    """A name that cannot be given to a thing, or a thing that cannot be renamed; the message says why."""


def definition(asked: Document, offset: int, library: Library) -> Span | None:
    """Where the name at an offset is declared; for the name of a domain, where that file names itself."""
    found = asked.at(offset)
    if found is None:
        return None
    if found.meaning.kind is Kind.DOMAIN:
        domain = library.domain_of(asked)
        return None if domain is None else next((o.span for o in domain.declared()), None)
    declaration = library.declaration(asked, found.meaning)
    return None if declaration is None else declaration.span


def references(asked: Document, offset: int, library: Library, declaration: bool = True) -> tuple[Span, ...]:
    """Every occurrence of the name at an offset, in the domain and its problems."""
    found = asked.at(offset)
    if found is None:
        return ()
    return tuple(
        occurrence.span
        for occurrence in _occurrences(asked, found.meaning, library)
        if declaration or not occurrence.declares
    )


def _occurrences(asked: Document, meaning: Meaning, library: Library) -> Iterator[Occurrence]:
    for place in (asked,) if _is_local(asked, meaning) else library.family(asked):
        # A problem that has an object of its own of that name gives it another home, and is passed over.
        yield from (occurrence for occurrence in place.names if occurrence.meaning == meaning)


def _is_local(asked: Document, meaning: Meaning) -> bool:
    """Whether nothing outside the file can mean it."""
    return meaning.kind is Kind.VARIABLE or meaning.home == asked.source.path


def renamable(asked: Document, offset: int, library: Library) -> Occurrence:
    """The name at an offset, if it can be renamed; raises CannotRename."""
    found = asked.at(offset)
    if found is None or found.meaning.kind not in RENAMED:
        raise CannotRename("only what a domain or problem declares can be renamed")
    if library.declaration(asked, found.meaning) is None:
        raise CannotRename(f"`{found.meaning.name}` is not declared")
    domain = library.domain_of(asked)
    if not _is_local(asked, found.meaning) and domain is not None and not _is_own(domain, asked, library):
        raise CannotRename(
            f"`{found.meaning.name}` is declared in the shipped domain `{domain.path.stem}`: "
            "copy that beside this file to change it"
        )
    return found


def _is_own(domain: Document, asked: Document, library: Library) -> bool:
    """Whether a domain is one of the user's files, and not one that came with the program."""
    path = domain.path
    near = path.parent == asked.path.parent or any(path.is_relative_to(root) for root in library.roots)
    return near or domain.source.path in library.open


def rename(asked: Document, offset: int, new: str, library: Library) -> Mapping[str, tuple[Edit, ...]]:
    """The edits, by path, that rename the thing at an offset everywhere; raises CannotRename.

    Refused are names that are no names, words of the language, and names that another thing of the kind has.
    """
    found = renamable(asked, offset, library)
    is_variable = found.meaning.kind is Kind.VARIABLE
    name = new.removeprefix("?") if is_variable else new
    if not _NAME.fullmatch(name):
        raise CannotRename(f"`{new}` is no name: letters a to z, digits and `_`, no digit first")
    if name in RESERVED and not is_variable:
        raise CannotRename(f"`{name}` is a word of the language")
    if name == found.meaning.name:
        return {}
    places = (asked,) if _is_local(asked, found.meaning) else library.family(asked)
    declared = (*library.visible(asked), *(o for place in places for o in place.declared()))
    taken = next((other for other in declared if _clash(other, found.meaning, name, asked)), None)
    if taken is not None:
        raise CannotRename(f"the {taken.meaning.kind.value} `{name}` exists already")
    edits: dict[str, list[Edit]] = {}
    for occurrence in _occurrences(asked, found.meaning, library):
        edit = Edit(occurrence.span, f"?{name}" if is_variable else name)
        edits.setdefault(occurrence.span.path, []).append(edit)
    return {path: tuple(changes) for path, changes in edits.items()}


def _clash(other: Occurrence, meaning: Meaning, name: str, asked: Document) -> bool:
    """Whether a declared thing would have the same name in the same place as the renamed one."""
    if other.meaning.name != name:
        return False
    if meaning.kind is Kind.VARIABLE:
        return other.meaning.kind is Kind.VARIABLE and _section(other, asked) == _section_at(meaning, asked)
    if meaning.kind is Kind.VALUE:
        return other.meaning.kind is Kind.VALUE and other.meaning.home == meaning.home
    kinds = {Kind.SYMBOL, Kind.COUNT} if meaning.kind in (Kind.SYMBOL, Kind.COUNT) else {meaning.kind}
    return other.meaning.kind in kinds


def _section(occurrence: Occurrence, asked: Document) -> Span | None:
    return _section_around(occurrence.span.start, asked)


def _section_at(meaning: Meaning, asked: Document) -> Span | None:
    return _section_around(int(meaning.home), asked)


def _section_around(offset: int, asked: Document) -> Span | None:
    """The span of the section that holds an offset."""
    sections = getattr(asked.root, "sections", ())
    return next((s.span for s in sections if s.span.start <= offset < s.span.end), None)
