"""Where a place stands in a text that may be half-typed: its section, the words before it, what may follow.

What may follow is asked of the parser itself: it is given the section up to the place, and says which
terminals it would accept next.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from lark import UnexpectedInput

from cleancli.language.parsing.grammar import grammar
from cleancli.language.parsing.lexemes import WORD, Lexeme, LexemeKind, lexemes
from cleancli.language.parsing.recovery import TITLED

_PREFIX = re.compile(rf"(?:\?[A-Za-z_0-9]*|{WORD})?\Z")


@dataclass(frozen=True, slots=True)
class Context:
    """`kind` is the first word of the file; `path` the names of the open blocks within it, outermost first;
    `words` the lexemes of the section, its header too, up to the half-typed word that begins at `start`;
    `accepted` the terminals that may come next, None where the section cannot be read so far."""

    kind: str
    path: tuple[str, ...]
    words: tuple[Lexeme, ...]
    start: int
    accepted: frozenset[str] | None

    @property
    def section(self) -> str:
        """The innermost open block, empty directly inside the file's own."""
        return self.path[-1] if self.path else ""

    @property
    def texts(self) -> tuple[str, ...]:
        """The texts of `words`."""
        return tuple(word.text for word in self.words)

    @property
    def last(self) -> str:
        """The text of the last of `words`; empty where there is none."""
        return self.words[-1].text if self.words else ""

    def takes(self, terminal: str) -> bool:
        """Whether a terminal may come next; anything may where that cannot be told."""
        return self.accepted is None or terminal in self.accepted


def context(text: str, offset: int) -> Context | None:
    """The context of a place; None inside a comment."""
    prefix = _PREFIX.search(text, 0, offset)
    start = offset if prefix is None else prefix.start()
    found = lexemes(text[:offset])
    if found and found[-1].kind is LexemeKind.COMMENT and found[-1].end == offset:
        return None
    words = tuple(x for x in found if x.kind is not LexemeKind.COMMENT and x.start < start)
    path, section = _blocks(words)
    kind = words[0].text if words else ""
    return Context(kind, path, section, start, _accepted(text[:start], words, section))


def open_string(text: str) -> tuple[str, str] | None:
    """The word before a string that a text ends in, and the string so far; None where it ends in none."""
    words = [word for word in lexemes(text) if word.kind is not LexemeKind.COMMENT]
    if not words or words[-1].kind is not LexemeKind.STRING or words[-1].end != len(text):
        return None
    string = words[-1].text
    if len(string) > 1 and string.endswith('"'):
        return None
    return (words[-2].text if len(words) > 1 else ""), string[1:]


def _blocks(words: tuple[Lexeme, ...]) -> tuple[tuple[str, ...], tuple[Lexeme, ...]]:
    """The open blocks inside the file's own, and the lexemes since the last of these was closed."""
    path: list[str] = []
    begin = 0
    for index, word in enumerate(words):
        if word.text == "{":
            path.append(_header(words[begin:index]))
            if len(path) == 1:
                begin = index + 1
        elif word.text == "}" and path:
            path.pop()
            if len(path) == 1:
                begin = index + 1
    return tuple(path[1:]), words[begin:]


def _header(words: tuple[Lexeme, ...]) -> str:
    """The name of the block that opens behind these words: `rule`, what has a title, else the last word."""
    for word in words:
        if word.text == "rule":
            return "rule"
    named = [word.text for word in words if word.kind is LexemeKind.WORD]
    if len(named) > 1 and named[-2] in TITLED and words[-1].text == named[-1] and words[-2].text == named[-2]:
        return named[-2]
    return named[-1] if named else ""


def _accepted(text: str, words: tuple[Lexeme, ...], section: tuple[Lexeme, ...]) -> frozenset[str] | None:
    """What the parser would take after the file's header and this section alone: earlier sections, whatever
    mistakes they hold, do not matter."""
    opening = next((word.end for word in words if word.text == "{"), None)
    begin = section[0].start if section else len(text)
    shortened = text if opening is None else text[:opening] + text[begin:]
    try:
        parser = grammar().parse_interactive(shortened)
        for _ in parser.iter_parse():
            pass
        return frozenset(parser.accepts())  # type: ignore[no-untyped-call]
    except UnexpectedInput:
        return None
