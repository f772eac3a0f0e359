"""From a name to its declaration, its uses, and another name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cleancli.editor.library import Document, Library
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.refactoring.name_index import Kind, Meaning, Occurrence
from cleancli.language.refactoring.rename import RENAMABLE, edits_of, refusal_of
from cleancli.resources import shipped

RENAMED = frozenset({*RENAMABLE, Kind.VARIABLE})
"""What can be renamed. A domain's name is also that of its file, and the rest are words of the language."""


class CannotRename(Exception):
    """A name that cannot be given to a thing, or a thing that cannot be renamed; the message says why."""


def definition(asked: Document, offset: int, library: Library) -> Span | None:
    """Where the name at an offset is declared; for the name of a domain, where that file names itself; for an
    `include`, the start of the file."""
    included = asked.include_at(offset)
    if included is not None:
        file = library.document(asked.path.parent / included.path)
        return None if file is None else Span(file.source.path, 0, 0)
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
    for place in _places(asked, meaning, library):
        # A problem that has an object of its own of that name gives it another home, and is passed over.
        yield from (occurrence for occurrence in place.names if occurrence.meaning == meaning)


def _places(asked: Document, meaning: Meaning, library: Library) -> tuple[Document, ...]:
    """The files in which a name of a file may stand for the same."""
    if _is_local(asked, meaning):
        return (asked,)
    declaration = library.declaration(asked, meaning)
    home = None if declaration is None else library.document(declaration.span.path)
    if home is None or home.source.path == asked.source.path:
        return library.family(asked)
    # What was asked about may include the file that declares the name from far away.
    places = (*library.family(home), *library.family(asked))
    return tuple({place.source.path: place for place in places}.values())


def _is_local(asked: Document, meaning: Meaning) -> bool:
    """Whether nothing outside the file can mean it."""
    return meaning.kind is Kind.VARIABLE or meaning.home == asked.source.path


def renamable(asked: Document, offset: int, library: Library) -> Occurrence:
    """The name at an offset, if it can be renamed; raises CannotRename."""
    found = asked.at(offset)
    if found is None or found.meaning.kind not in RENAMED:
        raise CannotRename("only what a domain or problem declares can be renamed")
    declaration = library.declaration(asked, found.meaning)
    if declaration is None:
        raise CannotRename(f"`{found.meaning.name}` is not declared")
    home = library.document(declaration.span.path)
    if not _is_local(asked, found.meaning) and home is not None and not _is_own(home, asked, library):
        raise CannotRename(
            f"`{found.meaning.name}` is declared in the shipped domain `{home.path.stem}`: "
            "copy that beside this file to change it"
        )
    return found


def _is_own(domain: Document, asked: Document, library: Library) -> bool:
    """Whether a domain is one of the user's files, and not one that came with the program."""
    path = domain.path
    if path.parent != shipped("domains").resolve():
        return True
    near = path.parent == asked.path.parent or any(path.is_relative_to(root) for root in library.roots)
    return near or domain.source.path in library.open


def rename(asked: Document, offset: int, new: str, library: Library) -> Mapping[str, tuple[Edit, ...]]:
    """The edits, by path, that rename the thing at an offset everywhere; raises CannotRename.

    Refused are names that are no names, words of the language, and names that another thing of the kind has.
    """
    found = renamable(asked, offset, library)
    name = new.removeprefix("?") if found.meaning.kind is Kind.VARIABLE else new
    if name == found.meaning.name:
        return {}
    places = _places(asked, found.meaning, library)
    declared = (*library.visible(asked), *(o for place in places for o in place.declared()))
    refusal = refusal_of(name, found, declared)
    if refusal is not None:
        raise CannotRename(refusal.message)
    return edits_of(_occurrences(asked, found.meaning, library), {found.meaning}, name)
