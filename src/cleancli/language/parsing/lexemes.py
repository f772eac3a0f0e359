"""What words and signs look like, in texts that the parser may refuse: broken ones, and half-typed ones.

The parser's tokens are the terminals of grammar/nid.lark, and which of them a piece of text is depends on
what may stand there. Lexemes are told by their looks alone, and cover every text but for its blanks. Of a
text that parses they are the tokens, except where two of those touch without a blank or a sign between them,
such as the `x` in `640x480`.
"""

from __future__ import annotations

import enum
import functools
import re
from typing import NamedTuple

NAME = r"[A-Za-z_][A-Za-z0-9_]*"
"""A name as the grammar has it."""
WORD = r"[A-Za-z_]\w*"
"""A name, and what someone may take for one: other letters may follow the first."""
COMMENT = r"#[^\r\n]*"
BLANK = r"[\s\ufeff]"
_STRING = r'"[^"\r\n]*"'


class LexemeKind(enum.Enum):
    """What a lexeme is by its looks alone."""

    COMMENT = "comment"
    VARIABLE = "variable"
    NUMBER = "number"
    WORD = "word"
    STRING = "string"
    SIGN = "sign"


class Lexeme(NamedTuple):
    """A piece of text that is no blank, at [start, end)."""

    kind: LexemeKind
    text: str
    start: int
    end: int


def _any_lexeme(string: str) -> re.Pattern[str]:
    return re.compile(
        rf"(?P<comment>{COMMENT})|(?P<variable>\?[A-Za-z_0-9]*)|(?P<number>[0-9]+(?:[./][0-9]+)?)"
        rf"|(?P<word>{WORD})|(?P<string>{string})|(?P<sign>:=|=>|!=|<=|>=|\+=|-=|\.\.|[^\s\ufeff])"
    )


LEXEME = _any_lexeme(_STRING)
"""Any lexeme, comments too, in the group that its kind names. A quotation mark that nothing closes in its
line is a sign like any other: braces behind it count."""

_KINDS = {kind.value: kind for kind in LexemeKind}


@functools.cache
def _half_typed() -> re.Pattern[str]:
    """The same in half-typed text: someone is writing that string, and it ends with the line.

    Compiled when an editor first asks: checks do without.
    """
    return _any_lexeme(rf"{_STRING}?")


def lexemes(text: str) -> tuple[Lexeme, ...]:
    """Every lexeme of half-typed text, comments too; a string that is not closed ends with its line."""
    return tuple(
        Lexeme(_KINDS[str(match.lastgroup)], match[0], match.start(), match.end())
        for match in _half_typed().finditer(text)
    )
