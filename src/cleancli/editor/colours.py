"""What each word of a file is, for an editor to colour (semantic tokens)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from cleancli.editor.library import Document, Library
from cleancli.language.parsing.grammar import keywords
from cleancli.language.parsing.lexemes import Lexeme, LexemeKind, lexemes
from cleancli.language.refactoring.name_index import Kind, Occurrence

TYPES = (
    "namespace",
    "type",
    "variable",
    "parameter",
    "property",
    "enumMember",
    "event",
    "function",
    "method",
    "keyword",
    "comment",
    "number",
    "modifier",
    "string",
)
"""The token types of the protocol that are used, in the order of their numbers."""
MODIFIERS = ("declaration", "readonly")

_TYPE_OF: Mapping[Kind, str] = {
    Kind.DOMAIN: "namespace",
    Kind.PROBLEM: "namespace",
    Kind.SCENE: "namespace",
    Kind.STUDY: "namespace",
    Kind.TYPE: "type",
    Kind.OBJECT: "variable",
    Kind.SYMBOL: "function",
    Kind.VALUE: "enumMember",
    Kind.COUNT: "property",
    Kind.PARAMETER: "property",
    Kind.ACTION: "method",
    Kind.RULE: "event",
    Kind.VARIABLE: "parameter",
    Kind.MARK: "modifier",
    Kind.SECTION: "keyword",
    Kind.KEY: "property",
    Kind.WORD: "enumMember",
}
_LOOKS = {
    LexemeKind.COMMENT: "comment",
    LexemeKind.NUMBER: "number",
    LexemeKind.VARIABLE: "parameter",
    LexemeKind.STRING: "string",
}


@dataclass(frozen=True, slots=True)
class Colour:
    """A piece of one line and what it is; `modifiers` are some of `MODIFIERS`."""

    start: int
    end: int
    type: str
    modifiers: tuple[str, ...] = ()


def colours(asked: Document, library: Library) -> tuple[Colour, ...]:
    """Every lexeme that is something, in the order of the text.

    Words of a section that cannot be read yet are taken for what is declared under their name.
    """
    return tuple(_colours(asked, library))


def _colours(asked: Document, library: Library) -> Iterator[Colour]:
    places = {occurrence.span.start: occurrence for occurrence in asked.names}
    declared = {
        o.meaning.name: o.meaning.kind for o in library.visible(asked) if o.meaning.kind is not Kind.VARIABLE
    }
    words = frozenset(keywords().values())
    for lexeme in lexemes(asked.source.text):
        occurrence = places.get(lexeme.start)
        if occurrence is not None:
            yield Colour(lexeme.start, lexeme.end, _TYPE_OF[occurrence.meaning.kind], _modifiers(occurrence))
        elif kind := _LOOKS.get(lexeme.kind) or _by_name(lexeme, words, declared):
            yield Colour(lexeme.start, lexeme.end, kind)


def _modifiers(occurrence: Occurrence) -> tuple[str, ...]:
    marks = [("declaration", occurrence.declares), ("readonly", occurrence.meaning.kind is Kind.OBJECT)]
    return tuple(name for name, given in marks if given)


def _by_name(lexeme: Lexeme, words: frozenset[str], declared: Mapping[str, Kind]) -> str:
    """What a word of the language is, or one that is declared; empty for anything else."""
    if lexeme.kind is not LexemeKind.WORD:
        return ""
    if lexeme.text in words:
        return "keyword"
    return _TYPE_OF[declared[lexeme.text]] if lexeme.text in declared else ""
