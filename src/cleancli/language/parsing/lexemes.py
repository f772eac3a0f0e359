"""The words, signs and comments of a text, parsed or not: what half-typed text is read by."""

from __future__ import annotations

import enum
import re
from dataclasses import dataclass


class LexemeKind(enum.Enum):
    """What a lexeme is by its looks alone."""

    COMMENT = "comment"
    VARIABLE = "variable"
    NUMBER = "number"
    WORD = "word"
    STRING = "string"
    SIGN = "sign"


@dataclass(frozen=True, slots=True)
class Lexeme:
    """A piece of text that is no blank, at [start, end)."""

    kind: LexemeKind
    text: str
    start: int
    end: int


_LEXEME = re.compile(
    r"(?P<comment>#[^\r\n]*)|(?P<variable>\?[A-Za-z_0-9]*)|(?P<number>[0-9]+(?:[./][0-9]+)?)"
    r"|(?P<word>[A-Za-z_]\w*)|(?P<string>\"[^\"\r\n]*\"?)|(?P<sign>:=|=>|!=|<=|>=|\+=|-=|\.\.|[^\s\ufeff])"
)


def lexemes(text: str) -> tuple[Lexeme, ...]:
    """Every lexeme of a text, comments too; a string that is not closed ends with its line."""
    return tuple(
        Lexeme(LexemeKind(match.lastgroup), match.group(), match.start(), match.end())
        for match in _LEXEME.finditer(text)
    )
