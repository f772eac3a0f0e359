"""A PPDDL text as words and groups in parentheses, each with its place; parentheses that are missing, or too
many, are mended where it is plain what they were to enclose."""

from __future__ import annotations

import re
import string
from collections.abc import Iterator
from typing import NamedTuple

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import Findings

DEEPEST = 80
"""How deep groups may stand in one another. Chosen: far more than people write, and few enough to recurse."""

_TOKEN = re.compile(r";[^\n]*|[()]|[^\s();]+")
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


class Group(NamedTuple):
    """What stands between two parentheses, and where these stand."""

    items: tuple[Node, ...]
    start: int
    end: int

    @property
    def head(self) -> str:
        """The word that it begins with; empty where it does not begin with a word."""
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
    for token, start, follows in _tokens(text):
        if token == "(":
            if follows.startswith(":") and len(stack) > _SECTION_DEPTH:
                _close(stack, _SECTION_DEPTH, last, path, findings)
            stack.append(_Open([], start))
            if len(stack) > DEEPEST:
                message = f"groups stand in one another more than {DEEPEST} deep"
                findings.error("E915", message, Span(path, start, start + 1))
                return ()
        elif token == ")":
            if len(stack) == 1:
                surplus.append(start)
            else:
                opened = stack.pop()
                stack[-1].items.append(Group(tuple(opened.items), opened.start, start + 1))
        else:
            stack[-1].items.append(Word(token, start))
        last = start + len(token)
    _close(stack, 1, last, path, findings)
    if surplus:
        many = "closes nothing" if len(surplus) == 1 else f"and {len(surplus) - 1} more close nothing"
        findings.warning(
            "W911", f"this parenthesis {many}", Span(path, surplus[0], surplus[0] + 1), "passed over"
        )
    return tuple(_without_words(found, path, findings))


def _tokens(text: str) -> Iterator[tuple[str, int, str]]:
    """Words and parentheses with their places, and the beginning of what follows."""
    # Letter case says nothing in PDDL; letters beyond ASCII stay, so that no place moves.
    lower = text.translate(str.maketrans(string.ascii_uppercase, string.ascii_lowercase))
    for match in _TOKEN.finditer(lower):
        token = match[0]
        if token[0] != ";":
            end = match.end()
            yield token, match.start(), lower[end : end + 1]


def _close(stack: list[_Open], depth: int, place: int, path: str, findings: Findings) -> None:
    """Closes groups until so many are open, and says so of the outermost of them."""
    missing = len(stack) - depth
    while len(stack) > depth:
        opened = stack.pop()
        stack[-1].items.append(Group(tuple(opened.items), opened.start, place))
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
