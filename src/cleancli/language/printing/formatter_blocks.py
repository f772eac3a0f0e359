"""Which blocks of a text take lines of their own, and what items they hold: what a layout is made from.

Guaranteed by `read_tokens`: every token, and what stands between. Nothing here knows the constructs of the
language: items are what the syntax tree lists between braces, whatever they mean.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import fields
from itertools import pairwise

from cleancli.language.parsing.trivia import Token
from cleancli.language.syntax import Node, OutcomeNode, Root

WIDTH = 100
"""Columns that a block on one line may reach, and a line that several items share; one item may go beyond."""
INDENT = 2

_CLAUSES = frozenset({"WHEN", "WITH", "THEN"})
_CLOSE_BEFORE = frozenset({",", ";", ":", ")", "]", ".."})
_CLOSE_AFTER = frozenset({"(", "[", ".."})
_SEPARATORS = frozenset({",", ";", "{"})
_SIGNS = frozenset({"+", "-"})


class Blocks:
    """The braces, items, clauses and outcomes of a text, all by the numbers of their tokens.

    `block` and `depth` hold for each token the opening brace around it and how many are around it; `tall` are
    the opening braces of blocks that take several lines; `crowded` are items that may not stand behind
    another one.
    """

    def __init__(self, tokens: Sequence[Token], root: Root) -> None:
        self.tokens = tokens
        self.closing: dict[int, int] = {}
        self._opening: dict[int, int] = {}
        self.block: list[int | None] = []
        self.depth: list[int] = []
        self._match_braces()
        self.clauses = {number for number, token in enumerate(tokens) if token.type in _CLAUSES}
        self.with_clauses = {self.block[number] for number in self.clauses}
        self.items: set[int] = set()
        self.outcomes: set[int] = set()
        self._find_items(root, {token.start: number for number, token in enumerate(tokens)})
        self.tall: set[int] = set()
        for opening in sorted(self.closing, reverse=True):  # inner ones first
            if self._is_tall(opening):
                self.tall.add(opening)
        self.tall_ends = {self.closing[opening] for opening in self.tall}
        self.crowded = {item for opening in self.tall for item in self._crowded(opening)}

    def gap(self, number: int) -> str:
        """The blanks before a token that does not begin a line."""
        before, token = self.tokens[number - 1], self.tokens[number]
        if token.text in _CLOSE_BEFORE or before.text in _CLOSE_AFTER:
            return ""
        if before.type in _CLAUSES:
            return " "
        if number in self.items and before.text not in _SEPARATORS:
            return " " if token.text in _SIGNS else "  "
        applied = token.text == "(" and re.match(r"[A-Za-z_]", before.text)
        return "" if applied or self._is_sign(number - 1) else " "

    def continues(self, number: int) -> bool:
        """Whether a line that begins with the token would go on with an item."""
        begins = number in self.items or number in self.clauses or number in self.outcomes
        return not begins and number > 0 and self.tokens[number].text not in ("}", "")

    def block_above(self, number: int) -> int | None:
        """The block in which comments above a token stand: above a closing brace, the one that it closes."""
        if self.tokens[number].text != "}":
            return self.block[number]
        return self._opening[number]

    def _match_braces(self) -> None:
        stack: list[int] = []
        for number, token in enumerate(self.tokens):
            if token.text == "}":
                self._opening[number] = stack.pop()
                self.closing[self._opening[number]] = number
            self.block.append(stack[-1] if stack else None)
            self.depth.append(len(stack))
            if token.text == "{":
                stack.append(number)

    def _find_items(self, node: Node, numbers: dict[int, int]) -> None:
        """Note what a node lists between its own braces, and so for all that it holds."""
        inside = self.depth[numbers[node.span.start]] + 1
        for part, is_listed in _parts_of(node):
            number = numbers[part.span.start]
            if is_listed and self.depth[number] == inside:
                self.items.add(self._with_sign(number))
            if isinstance(part, OutcomeNode):
                self.outcomes.add(number)
            self._find_items(part, numbers)

    def _with_sign(self, number: int) -> int:
        """The first token of an item: a term of a sum begins with the sign before it."""
        return number - 1 if self.tokens[number - 1].text in _SIGNS else number

    def _is_tall(self, opening: int) -> bool:
        """Whether a block takes several lines: was so written, is a rule or the whole file, is too wide."""
        closing = self.closing[opening]
        inside = range(opening + 1, closing)
        if not inside:
            return bool(self.tokens[opening].remarks) or self.tokens[closing].has_comment_above
        return (
            self.block[opening] is None
            or opening in self.with_clauses
            or any(self.tokens[number].broken or number in self.tall for number in (*inside, closing))
            or self._width(self._item_of(opening), closing + 1) > WIDTH
        )

    def _item_of(self, number: int) -> int:
        """The token that begins the item in which a token stands."""
        depth = self.depth[number]
        while number > 0 and not (number in self.items and self.depth[number] == depth):
            number -= 1
        return number

    def _width(self, start: int, stop: int) -> int:
        """The column at which the tokens [start, stop) would end on one line."""
        words = (self.gap(number) + self.tokens[number].text for number in range(start + 1, stop))
        return INDENT * self.depth[start] + len(self.tokens[start].text) + sum(map(len, words))

    def _crowded(self, opening: int) -> Iterator[int]:
        """The items of a block that must begin a line: they would share one that is too long, or they hold
        braces, or follow an item that does."""
        closing = self.closing[opening]
        items = [n for n in range(opening, closing) if n in self.items and self.block[n] == opening]
        line: list[int] = []
        after_braces = False
        for item, stop in pairwise([*items, closing]):
            has_braces = any(number in self.closing for number in range(item, stop))
            if self.tokens[item].broken or has_braces or after_braces:
                yield item
                yield from self._too_long(line, item)
                line = []
            line.append(item)
            after_braces = has_braces
        yield from self._too_long(line, closing)

    def _too_long(self, line: Sequence[int], stop: int) -> Sequence[int]:
        return line if line and self._width(line[0], stop) > WIDTH else ()

    def _is_sign(self, number: int) -> bool:
        """Whether a token is the sign of the number after it, and no operator or dash between two words."""
        if self.tokens[number].text not in ("-", "+") or self.tokens[number + 1].type != "NUMBER":
            return False
        return not re.match(r"[\w?)\]]", self.tokens[number - 1].text)


def _parts_of(node: Node) -> Iterator[tuple[Node, bool]]:
    """The nodes that a node holds, each with whether it is one of a list."""
    for field in fields(node):
        value = getattr(node, field.name)
        is_list = isinstance(value, tuple)
        for part in value if is_list else (value,):
            if isinstance(part, Node):
                yield part, is_list
