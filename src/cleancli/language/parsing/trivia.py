"""The tokens of a text with what stands between them: comments, blank lines and line breaks.

Nothing is lost but the spaces between tokens.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from lark import Token as LarkToken
from lark import UnexpectedInput

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.source_lines import LINE_END, line_start
from cleancli.language.parsing.ast_builder import Builder
from cleancli.language.parsing.grammar import grammar
from cleancli.language.parsing.parse import parse
from cleancli.language.syntax import Root

_BLANKS = " \t\f\ufeff"


@dataclass(frozen=True, slots=True)
class Token:
    """One token as written; `type` is its terminal in grammar/nid.lark, `$END` for the end of the file.

    `above` holds the comments that stand in lines of their own before it, and "" for each blank line;
    `broken` says whether it begins a line. `remarks` holds the comment behind it in its line, with those that
    continue it below, in its column.
    """

    text: str
    type: str
    start: int
    above: tuple[str, ...] = ()
    broken: bool = False
    remarks: tuple[str, ...] = ()

    @property
    def has_comment_above(self) -> bool:
        return any(self.above)


@dataclass(frozen=True, slots=True)
class _Gap:
    """What stands between two tokens."""

    remarks: tuple[str, ...]
    above: tuple[str, ...]
    broken: bool


def tokens_of(text: str) -> tuple[Token, ...]:
    """All tokens of a text, see `read_tokens`."""
    return read_tokens(Source("<text>", text))[1]


def read_tokens(source: Source) -> tuple[Root, tuple[Token, ...]]:
    """The syntax tree of a text, and all its tokens in order, the end of the file last, in one pass.

    Raises Refused with every syntax error.
    """
    parser = grammar().parse_interactive(source.text)
    try:
        found = [(str(t), t.type, cast(int, t.start_pos)) for t in parser.iter_parse()]
        root = cast(Root, Builder(source.path).build(parser.feed_token(LarkToken("$END", ""))))
    except UnexpectedInput:
        raise Refused(parse(source).diagnostics, [source]) from None
    return root, _with_gaps(source.text, found)


def _with_gaps(text: str, found: list[tuple[str, str, int]]) -> tuple[Token, ...]:
    """Tokens from text, type and start."""
    found.append(("", "$END", len(text)))
    ends = [0, *(start + len(word) for word, _, start in found[:-1])]
    gaps = [_gap(text, end, start) for end, (_, _, start) in zip(ends, found, strict=True)]
    behind = [gap.remarks for gap in gaps[1:]] + [()]
    return tuple(
        Token(word, type_, start, gap.above, gap.broken, remarks)
        for (word, type_, start), gap, remarks in zip(found, gaps, behind, strict=True)
    )


def _gap(text: str, start: int, end: int) -> _Gap:
    """Read [start, end), which holds blanks and comments only."""
    lines = LINE_END.split(text[start:end])
    comments = [line.strip(_BLANKS) for line in lines]
    own_line = start == 0
    column = start - line_start(text, start) + lines[0].find("#")
    remarks = [] if own_line or not comments[0] else [comments[0]]
    above = comments[:-1] if own_line else comments[1:-1]
    if end == len(text) and (len(lines) > 1 or own_line):
        above.append(comments[-1])  # nothing follows, so the last line is one of its own, too
    while remarks and above and above[0] and lines[len(remarks)].find("#") == column:
        remarks.append(above.pop(0))
    return _Gap(tuple(remarks), tuple(above), len(lines) > 1 or own_line)
