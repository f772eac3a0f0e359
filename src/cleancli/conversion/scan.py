"""Tokens of libPRADA's files, and a reader of tokens that says what it expected where."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from cleancli.conversion.records import Atom
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span

# Numbers are bounded, so that none takes long to compute with; longer ones are two tokens, and misplaced.
_TOKEN = re.compile(
    r"(?P<comment>(?://|#(?!\s*rules\s*=))[^\r\n]*|\ufeff)"
    r"|(?P<number>[0-9]{1,18}(?:\.[0-9]{0,60})?(?:[eE][-+]?[0-9]{1,2})?)"
    r"|(?P<word>[A-Za-z_][A-Za-z0-9_]*)|(?P<arrow><--)|(?P<result><[A-Za-z-]+>)|(?P<empty>--)"
    r"|(?P<relation><=|>=|!=|<|>|=)|(?P<sign>[-():,#])|(?P<other>\S)"
)


@dataclass(frozen=True, slots=True)
class Token:
    """A word, number or sign; `kind` is the name of its group in the pattern."""

    text: str
    kind: str
    span: Span


class Unreadable(Exception):
    """What stands in a file is not what its format has there."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


def tokens_of(source: Source, start: int = 0, end: int | None = None) -> list[Token]:
    """The tokens of a part of a text; characters that nothing begins with are tokens too. Comments are none,
    nor is a byte order mark."""
    stop = len(source.text) if end is None else end
    return [
        Token(found.group(), str(found.lastgroup), Span(source.path, found.start(), found.end()))
        for found in _TOKEN.finditer(source.text, start, stop)
        if found.lastgroup != "comment"
    ]


class Scanner:
    """Takes the tokens of a `part` of a text one after the other; `end` is the place behind the last."""

    def __init__(self, tokens: Iterable[Token], end: Span, part: str) -> None:
        self._tokens = list(tokens)
        self._place = 0
        self._end = end
        self._part = part

    @property
    def next(self) -> Token | None:
        """The next token, None at the end."""
        return self._tokens[self._place] if self._place < len(self._tokens) else None

    def sees(self, *wanted: str) -> bool:
        """Whether the next token is of one of these kinds, or has one of these texts."""
        return self.next is not None and (self.next.kind in wanted or self.next.text in wanted)

    def take(self, wanted: str, shown: str = "") -> Token:
        """The next token, which must be of the kind or have the text; `shown` is how a message says so."""
        token = self.next
        if token is None or wanted not in (token.kind, token.text):
            raise self.misplaced(shown or f"`{wanted}`")
        self._place += 1
        return token

    def accept(self, wanted: str) -> bool:
        """Takes the next token if it is of the kind or has the text."""
        if not self.sees(wanted):
            return False
        self._place += 1
        return True

    def misplaced(self, wanted: str) -> Unreadable:
        """E911 at the next token."""
        token = self.next
        found = f"the {self._part} ends" if token is None else f"there is `{token.text}`"
        place = self._end if token is None else token.span
        return Unreadable(Diagnostic("E911", f"expected {wanted}, but {found}", place))

    def atom(self) -> Atom:
        """A literal: `p(X 10)`, `-p(X)`, `f(X)=3`."""
        negative = self.accept("-")
        name = self.take("word", "a literal")
        start = name.span
        terms: list[str] = []
        last = name
        if self.accept("("):
            while not self.sees(")"):
                terms.append(self._term())
                self.accept(",")
            last = self.take(")")
        relation = "="
        value: bool | int = not negative
        if self.sees("relation"):
            relation = self.take("relation").text
            minus = self.accept("-")
            last = self._whole()
            value = -int(last.text) if minus else int(last.text)
            relation = _OPPOSITE[relation] if negative else relation
        span = Span(start.path, start.start, last.span.end)
        return Atom(name.text, tuple(terms), relation, value, span)

    def atoms(self) -> tuple[Atom, ...]:
        """All literals that follow."""
        found = []
        while self.sees("-", "word"):
            found.append(self.atom())
            self.accept(",")
        return tuple(found)

    def all_atoms(self) -> tuple[Atom, ...]:
        """The literals that are left, up to the end; raises Unreadable for anything else."""
        found = self.atoms()
        if self.next is not None:
            raise self.misplaced("a literal")
        return found

    def _term(self) -> str:
        if self.sees("word"):
            return self.take("word").text
        return self._whole("a variable, a constant or `)`").text

    def _whole(self, shown: str = "a whole number") -> Token:
        if self.next is not None and not self.next.text.isdecimal():
            raise self.misplaced(shown)
        return self.take("number", shown)


_OPPOSITE = {"=": "!=", "!=": "=", "<": ">=", ">=": "<", ">": "<=", "<=": ">"}


def scanner_of(source: Source, start: int, end: int, part: str) -> Scanner:
    """A scanner of the tokens from one place of a text to another, which are a `part` of it."""
    return Scanner(tokens_of(source, start, end), Span(source.path, end, end), part)


def lines_of(source: Source) -> Iterator[Scanner]:
    """A scanner of each line that has tokens."""
    start = 0
    for line in source.text.splitlines(keepends=True):
        scanner = scanner_of(source, start, start + len(line.rstrip()), "line")
        if scanner.next is not None:
            yield scanner
        start += len(line)
