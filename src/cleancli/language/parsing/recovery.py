"""The braces of a text, found before parsing, so that a mistake in one block hides none in the next."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.source_lines import Lines, line_start
from cleancli.language.parsing.lexemes import LEXEME, WORD
from cleancli.language.record import Record

_LETTER = re.compile(r"[^\r\n]")
_DEEPEST = {"scene": 3, "study": 4}
"""Blocks one in another, in files whose sections may have sections."""
TITLED = frozenset({"grasp", "part", "compare"})
"""Sections that have a title."""
_MOST_REPORTED = 100
"""Braces: of those that follow from one another, nobody reads more."""


class Block(Record):
    """A section of the file: `name` is the first word of its header, [start, end) reaches from there past the
    closing brace; an unclosed one ends where the next begins."""

    name: str
    start: int
    end: int


class Outline(Record):
    """The sections inside the file's one block; `body` is the text up to where that block ends, with the
    sections blanked that are not closed, and with a closing brace added where it is missing."""

    blocks: tuple[Block, ...]
    body: str
    diagnostics: tuple[Diagnostic, ...]


def blank(text: str, start: int, end: int) -> str:
    """The text with [start, end) replaced by spaces, line ends kept, so that no offset moves."""
    return text[:start] + _LETTER.sub(" ", text[start:end]) + text[end:]


_BEFORE_LOOSE = frozenset({"then", "when", "with", ":", ">", "=>"})
"""What stands in rules before a brace that belongs to no block, but is written there by habit."""


@dataclass(slots=True)
class _Open:
    name: str
    start: int
    brace: int
    is_loose: bool = False


class _Scan:
    """One pass over the tokens of a text, up to the most mistakes that are reported; `stack` holds the blocks
    that are open.

    With `by_margin`, a section within another that is not indented deeper than the open one stands beside it.
    """

    def __init__(self, source: Source, by_margin: bool) -> None:
        self.source = source
        self.by_margin = by_margin
        self.stack: list[_Open] = []
        self.blocks: list[Block] = []
        self.unclosed: list[Block] = []
        self.diagnostics: list[Diagnostic] = []
        self.words: list[re.Match[str]] = []
        self.root_end: int | None = None

    def run(self) -> None:
        for match in LEXEME.finditer(self.source.text):
            token = match.group()
            if token.startswith("#"):
                continue
            if len(self.diagnostics) >= _MOST_REPORTED:
                break
            if self.root_end is not None:
                self._report_after_end(match)
                return
            if token == "{":
                self._open(match)
            elif token == "}":
                self._close(match)
            else:
                self.words.append(match)
        while self.stack:
            self._leave_unclosed(self.stack.pop(), len(self.source.text))

    def _open(self, match: re.Match[str]) -> None:
        if self._is_loose():
            # The parser says what is wrong with it.
            self.stack.append(_Open("", match.start(), match.start(), is_loose=True))
            self.words.clear()
            return
        header = self._header(match)
        while len(self.stack) > 1 and self._cannot_hold(self.stack[-1], header):
            self._leave_unclosed(self.stack.pop(), header.start)
        self.stack.append(header)
        self.words.clear()

    def _is_loose(self) -> bool:
        """Whether a brace that follows is one around outcomes, conditions or effects of a rule."""
        in_rule = len(self.stack) > 1 and (
            self.stack[-1].is_loose or self.stack[-1].name in ("rule", "default")
        )
        return in_rule and bool(self.words) and self.words[-1].group() in _BEFORE_LOOSE

    def _cannot_hold(self, outer: _Open, inner: _Open) -> bool:
        """Only scenes and studies have sections within sections."""
        if len(self.stack) >= _DEEPEST.get(self.stack[0].name.partition(" ")[0], 0):
            return True
        if not self.by_margin:
            return False
        text = self.source.text
        line, outer_line = line_start(text, inner.start), line_start(text, outer.start)
        margin = text[line : inner.start]
        return margin.isspace() and outer_line != line and len(margin) <= outer.start - outer_line

    def _header(self, match: re.Match[str]) -> _Open:
        if not self.stack and self.words:
            name = " ".join(word.group() for word in self.words)
            return _Open(name, self.words[0].start(), match.start())
        for word in reversed(self.words):
            if word.group() == "rule":
                return _Open("rule", word.start(), match.start())
        if len(self.words) > 1 and self.words[-2].group() in TITLED:
            return _Open(self.words[-2].group(), self.words[-2].start(), match.start())
        last = self.words[-1] if self.words else None
        found = re.search(rf"{WORD}$", last.group()) if last else None
        if last and found:
            return _Open(found.group(), last.start() + found.start(), match.start())
        return _Open("", match.start(), match.start())

    def _close(self, match: re.Match[str]) -> None:
        self.words.clear()
        if not self.stack:
            self._report(
                "E103", "this brace closes nothing", match.start(), match.end(), "no block is open here"
            )
            return
        block = self.stack.pop()
        if len(self.stack) == 1:
            self.blocks.append(Block(block.name, block.start, match.end()))
        if not self.stack:
            self.root_end = match.end()

    def _leave_unclosed(self, block: _Open, end: int) -> None:
        if block.is_loose:
            return
        name = f"the `{block.name}` block" if block.name else "this block"
        self._report(
            "E102",
            f"{name} is never closed",
            block.brace,
            block.brace + 1,
            "opened here",
            "add the missing `}`",
        )
        if self.stack:
            self.unclosed.append(Block(block.name, block.start, end))
        self.words.clear()

    def _report_after_end(self, match: re.Match[str]) -> None:
        assert self.root_end is not None
        if match.group() == "}":
            self._report(
                "E103",
                "this brace closes nothing",
                match.start(),
                match.end(),
                "every block is closed before it",
            )
        else:
            line = Lines(self.source.text).place(self.root_end - 1)[0]
            self._report(
                "E105",
                "the file goes on after its block has ended",
                match.start(),
                match.end(),
                "a file holds one block",
                f"it ended with the `}}` in line {line}: is there one too many before it?",
            )

    def _report(self, code: str, message: str, start: int, end: int, label: str, help: str = "") -> None:
        if len(self.diagnostics) < _MOST_REPORTED:
            span = Span(self.source.path, start, end)
            self.diagnostics.append(Diagnostic(code, message, span, label, help))


def _without(text: str, blocks: Iterable[Block]) -> str:
    """The text with these blocks blanked, of which some may lie in others; copied once, however many."""
    parts, place = [], 0
    for block in sorted(blocks, key=lambda block: block.start):
        start, end = max(block.start, place), min(block.end, len(text))
        if start < end:
            parts += [text[place:start], _LETTER.sub(" ", text[start:end])]
            place = end
    return "".join([*parts, text[place:]])


def outline(source: Source) -> Outline:
    """Find the sections of a file and report braces that do not match (E102, E103, E105).

    How a file is indented means nothing, and helps to find the brace that is missing where one is.
    """
    scan = _Scan(source, by_margin=False)
    scan.run()
    if scan.diagnostics:
        scan = _Scan(source, by_margin=True)
        scan.run()
    body = source.text if scan.root_end is None else source.text[: scan.root_end]
    body = _without(body, scan.unclosed)
    if scan.root_end is None and any(d.code == "E102" for d in scan.diagnostics):
        body += "}"
    return Outline(tuple(scan.blocks) + tuple(scan.unclosed), body, tuple(scan.diagnostics))
