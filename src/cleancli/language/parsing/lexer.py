"""Text to tokens, as the parser asks for them: which words are reserved depends on what may stand there.

What is read is what lark's own contextual lexer reads. That one compiles a pattern for each set of terminals
that a state of the parser takes: for one file more than fifty, which takes as long as parsing it. Here is one
pattern of all terminals; where its match cannot stand, those that can are tried one by one.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterator
from typing import Any, NoReturn

from lark import Token, UnexpectedCharacters, UnexpectedToken
from lark.common import LexerConf
from lark.lexer import Lexer, LexerState, PatternStr, TerminalDef


class ContextLexer(Lexer):
    """What lark makes of a grammar's terminals to read texts with; the grammar has a terminal `NAME`."""

    __future_interface__ = 2  # the version of lark's interface in which a lexer sees the parser's state

    def __init__(self, conf: LexerConf) -> None:
        terminals = sorted(conf.terminals, key=_precedence)
        name = re.compile(conf.terminals_by_name["NAME"].pattern.to_regexp())
        words = [
            t for t in terminals if isinstance(t.pattern, PatternStr) and name.fullmatch(t.pattern.value)
        ]
        self._words = {terminal.pattern.value: terminal.name for terminal in words}
        self._patterns = {t.name: t.pattern.to_regexp() for t in terminals}
        others = (f"(?P<{t.name}>{t.pattern.to_regexp()})" for t in terminals if t not in words)
        self._any = re.compile("|".join(others))
        self._ignored = frozenset(conf.ignore)

    def lex(self, lexer_state: LexerState, parser_state: Any) -> Iterator[Token]:
        """The tokens of a text; raises UnexpectedInput where none stands that the parser takes."""
        given: Any = lexer_state.text
        text: str = getattr(given, "text", given)  # a slice of the text since lark 1.3
        states = parser_state.parse_conf.states
        place = 0
        while place < len(text):
            token = self._token(text, place)
            if token is None or token.type not in self._ignored:
                accepted = states[parser_state.position]
                if token is None or token.type not in accepted:
                    token = self._one_of(accepted, text, place) or self._refuse(
                        token, text, place, parser_state
                    )
                yield token
            place += len(token)

    def _token(self, text: str, place: int) -> Token | None:
        found = self._any.match(text, place)
        if found is None:
            return None
        word, kind = found[0], str(found.lastgroup)
        if kind == "NAME":
            kind = self._words.get(word, kind)
        return _token(kind, word, place)

    def _one_of(self, accepted: Container[str], text: str, place: int) -> Token | None:
        """The first of the accepted terminals that stands at a place; where names are, words are whole."""
        for kind, pattern in self._patterns.items():
            if kind in accepted and not (kind in self._words.values() and "NAME" in accepted):
                found = re.compile(pattern).match(text, place)
                if found:
                    return _token(kind, found[0], place)
        return None

    def _refuse(self, token: Token | None, text: str, place: int, parser_state: Any) -> NoReturn:
        accepted = set(parser_state.parse_conf.states[parser_state.position])
        if token is None:
            raise UnexpectedCharacters(text, place, 0, 0, accepted, state=parser_state)  # type: ignore[no-untyped-call]
        raise UnexpectedToken(token, accepted, state=parser_state)  # type: ignore[no-untyped-call]


def _precedence(terminal: TerminalDef) -> tuple[int, int, int, str]:
    """Lark's order: of two terminals that match, the first is read."""
    pattern = terminal.pattern
    return -terminal.priority, -pattern.max_width, -len(pattern.value), terminal.name


def _token(kind: str, word: str, place: int) -> Token:
    return Token(kind, word, place, end_pos=place + len(word))
