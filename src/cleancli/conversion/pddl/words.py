"""A PPDDL text as words and groups in parentheses, each with its place; parentheses that are missing, or too
many, are mended where it is plain what they were to enclose.

A group that holds words alone, as most do, is read as one piece: its words get their places when they are
asked for. So is an `:init` that holds facts alone, of which there may be thousands.
"""

from __future__ import annotations

import re
import string
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import Findings

DEEPEST = 80
"""How deep groups may stand in one another. Chosen: far more than people write, and few enough to recurse."""

_COMMENT = re.compile(r";[^\r\n]*")
_PLAIN = str.maketrans(string.ascii_uppercase + "\ufeff", string.ascii_lowercase + " ")
"""Letter case says nothing in PDDL, and a byte order mark is a blank; letters beyond ASCII stay."""
_NAME = "[a-z][a-z0-9_-]*+"
_ATOM = rf"\(\s*+{_NAME}(?:\s++{_NAME})*+\s*+\)"
_PIECE = re.compile(rf"\(\s*+:init\s(?:\s*+{_ATOM})*+\s*+\)|\([^()]*\)|[()]|[^\s()]+")
_WORD = re.compile(r"\S+")
_NAMES = re.compile(_ATOM)
_INNER = re.compile(r"\(([^()]*)\)")
_HEAD = re.compile(r"\(\s*+([^\s()]*+)")
_SECTION_DEPTH = 2
"""How many groups are open where `define` and one section are."""


class Word(NamedTuple):
    """A word in lower case, and where it begins."""

    text: str
    start: int

    @property
    def end(self) -> int:
        """Where it ends."""
        return self.start + len(self.text)


_word: Callable[[tuple[str, int]], Word] = partial(tuple.__new__, Word)
"""Makes a word in half the time that its class takes: a file has thousands."""


class Group:
    """What stands between two parentheses, and where these stand: several `items`, or a `text`, with its
    parentheses, of words alone, or of one word and groups of words."""

    __slots__ = ("_items", "_text", "end", "start")

    def __init__(self, start: int, end: int, items: tuple[Node, ...] | None = None, text: str = "") -> None:
        self.start = start
        self.end = end
        self._items = items
        self._text = text

    @property
    def items(self) -> tuple[Node, ...]:
        """The words and groups in it."""
        if self._items is None:
            start, text = self.start, self._text
            inner = text.find("(", 1)
            words = _WORD.finditer(text, 1, len(text) - 1 if inner < 0 else inner)
            self._items = tuple([_word((match[0], start + match.start())) for match in words])
            if inner > 0:
                groups = _INNER.finditer(text, inner)
                self._items += tuple([Group(start + m.start(), start + m.end(), text=m[0]) for m in groups])
        return self._items

    @property
    def names(self) -> tuple[str, ...]:
        """Its words, where there is nothing else in it and each is a name that begins with a letter;
        otherwise none."""
        return tuple(self._text[1:-1].split()) if _NAMES.fullmatch(self._text) else ()

    @property
    def atoms(self) -> list[tuple[str, ...]]:
        """The names in each group of it, where it was read as one piece with groups."""
        return [tuple(words.split()) for words in _INNER.findall(self._text, 1)]

    @property
    def head(self) -> str:
        """The word that it begins with; empty where it does not begin with a word."""
        if self._items is None:
            found = _HEAD.match(self._text)
            return found[1] if found else ""
        first = self.items[0] if self.items else None
        return first.text if isinstance(first, Word) else ""


Node = Word | Group


class _Open(NamedTuple):
    items: list[Node]
    start: int


def groups_of(text: str, path: str, findings: Findings) -> tuple[Group, ...]:
    """The groups that a text consists of; E915 for what can't be one, W911 for what was mended."""
    found: list[Node] = []
    stack = [_Open(found, 0)]
    surplus: list[int] = []
    last = 0
    # Comments become blanks, so that no place moves.
    lower = _COMMENT.sub(lambda match: " " * len(match[0]), text.translate(_PLAIN))
    for match in _PIECE.finditer(lower):
        piece, start = match[0], match.start()
        if piece[0] == "(":
            if len(stack) > _SECTION_DEPTH and lower.startswith(":", start + 1):
                _close(stack, _SECTION_DEPTH, last, path, findings)
            if len(stack) >= DEEPEST:
                message = f"groups stand in one another more than {DEEPEST} deep"
                findings.error("E915", message, Span(path, start, start + 1))
                return ()
            if piece == "(":
                stack.append(_Open([], start))
            else:
                stack[-1].items.append(Group(start, match.end(), text=piece))
        elif piece == ")":
            if len(stack) == 1:
                surplus.append(start)
            else:
                opened = stack.pop()
                stack[-1].items.append(Group(opened.start, start + 1, tuple(opened.items)))
        else:
            stack[-1].items.append(_word((piece, start)))
        last = match.end()
    _close(stack, 1, last, path, findings)
    if surplus:
        many = "closes nothing" if len(surplus) == 1 else f"and {len(surplus) - 1} more close nothing"
        findings.warning(
            "W911", f"this parenthesis {many}", Span(path, surplus[0], surplus[0] + 1), "passed over"
        )
    return tuple(_without_words(found, path, findings))


def _close(stack: list[_Open], depth: int, place: int, path: str, findings: Findings) -> None:
    """Closes groups until so many are open, and says so of the outermost of them."""
    missing = len(stack) - depth
    while len(stack) > depth:
        opened = stack.pop()
        stack[-1].items.append(Group(opened.start, place, tuple(opened.items)))
        if len(stack) == depth:
            lacks = plural(missing, "parenthesis is", "parentheses are")
            span = Span(path, opened.start, opened.start + 1)
            findings.warning("W911", f"{lacks} missing that would close this", span, "closed where it ends")


def _without_words(found: list[Node], path: str, findings: Findings) -> Iterator[Group]:
    told = False
    for node in found:
        if isinstance(node, Group):
            yield node
        elif not told:
            told = True
            help = "a file holds `(define (domain ...) ...)` or `(define (problem ...) ...)`"
            findings.error(
                "E915", f"`{node.text}` stands outside of all parentheses", _span(node, path), help=help
            )


def _span(node: Node, path: str) -> Span:
    return Span(path, node.start, node.end)
