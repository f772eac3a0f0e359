"""One layout for every text: tokens and comments stay, blanks and line breaks move.

Guaranteed by `read_tokens`: every token, and what stands between. The layout knows braces, separators and the
words that begin a clause; the items between braces it learns from the syntax tree, whatever they mean.

- A block on one line stays so if it fits; all others have an item or more to a line, two blanks deeper.
- The file's own block and rules are never on one line; `when`, `with`, `then` and every outcome begin one.
- Heads of settings and of blocks on one line, marks, and comments behind the code stand in columns.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.source_lines import LINE_END
from cleancli.language.parsing.trivia import Token, read_tokens
from cleancli.language.printing.formatter_blocks import INDENT, Blocks

_CONTINUED = 4
_BEHIND_CLAUSE = len("then ")
_HEAD_ENDS = frozenset({"=", ":=", "{"})


def layout(text: str, path: str = "<text>") -> str:
    """The text in the canonical layout; line ends stay what the first one is.

    Raises Refused with the mistakes of a text that does not parse.
    """
    root, tokens = read_tokens(Source(path, text))
    lines = _in_columns(_lines(Blocks(tokens, root)))
    found = LINE_END.search(text)
    end = found.group() if found else "\n"
    new = ("\ufeff" if text.startswith("\ufeff") else "") + "".join(line + end for line in lines)
    new_root, new_tokens = read_tokens(Source(path, new))
    if new_root != root or _content(new_tokens) != _content(tokens):
        raise AssertionError(f"the layout would change what `{path}` says")
    return new


def _content(tokens: Iterable[Token]) -> list[str]:
    """All tokens and comments in order."""
    return [part for token in tokens for part in (*token.above, token.text, *token.remarks) if part]


# ---- where lines begin


@dataclass(frozen=True, slots=True)
class _Line:
    """One line to be: its code or a comment that stands alone (a blank line has neither), and the comments
    behind the code.

    `block` is the brace in whose block it stands. `head` and `mark` are how much of the code comes before the
    sign after its first word, and before its last bracket, where these stand in columns; an item that is
    `headless` ends a run of heads.
    """

    code: str
    indent: int
    block: int | None
    remarks: tuple[str, ...] = ()
    head: int | None = None
    mark: int | None = None
    headless: bool = False


def _lines(blocks: Blocks) -> list[_Line]:
    """All lines, not yet in columns."""
    starts = [number for number in range(len(blocks.tokens)) if _breaks(blocks, number)]
    lines: list[_Line] = []
    column = 0
    for start, stop in pairwise([*starts, len(blocks.tokens)]):
        indent, column = _indent(blocks, start, column)
        lines += _above(blocks, start, indent)
        if blocks.tokens[start].type != "$END":
            lines.append(_line(blocks, start, stop, indent))
    return lines


def _breaks(blocks: Blocks, number: int) -> bool:
    """Whether a token begins a line."""
    if number == 0:
        return True
    before, token = blocks.tokens[number - 1], blocks.tokens[number]
    if before.remarks or token.has_comment_above or token.type == "$END":
        return True
    if number - 1 in blocks.tall or number in blocks.tall_ends or number - 1 in blocks.tall_ends:
        return True
    if blocks.block[number] not in blocks.tall:
        return False
    if number in blocks.outcomes:
        return number - 1 not in blocks.clauses
    if number in blocks.clauses:
        return True
    if number in blocks.items:
        return token.broken or blocks.depth[number] == 1 or number in blocks.crowded
    return token.broken and before.text == ","


def _indent(blocks: Blocks, number: int, column: int) -> tuple[int, int]:
    """Where the line of a token begins, and where lines begin that continue it; `column` is what the lines
    before said of that."""
    base = INDENT * blocks.depth[number]
    if number in blocks.clauses:
        is_then = blocks.tokens[number].type == "THEN"
        return base, base + _BEHIND_CLAUSE + _CONTINUED * is_then
    if number in blocks.outcomes and blocks.block[number] in blocks.with_clauses:
        base += _BEHIND_CLAUSE
    elif blocks.continues(number):
        return column, column
    return base, base + _CONTINUED


def _above(blocks: Blocks, number: int, indent: int) -> list[_Line]:
    """The comments and blank lines before the line of a token: one blank line for several, and none at the
    ends of a block or of the file, or within an item."""
    closes = blocks.tokens[number].text == "}"
    block = blocks.block_above(number)
    indent += INDENT * closes
    above = [_Line(text, indent, block) for text in blocks.tokens[number].above]
    if blocks.continues(number):
        above = [line for line in above if line.code]
    while above and not above[0].code and (number == 0 or number - 1 in blocks.tall):
        del above[0]
    while above and not above[-1].code and (closes or blocks.tokens[number].type == "$END"):
        del above[-1]
    return [line for at, line in enumerate(above) if line.code or not at or above[at - 1].code]


def _line(blocks: Blocks, start: int, stop: int, indent: int) -> _Line:
    tokens = blocks.tokens[start:stop]
    rest = [blocks.gap(number) + blocks.tokens[number].text for number in range(start + 1, stop)]
    pieces = [tokens[0].text, *rest]
    has_head = len(tokens) > 1 and tokens[1].text in _HEAD_ENDS
    head = mark = None
    if start in blocks.items and start not in blocks.outcomes:
        if has_head and stop - 1 not in blocks.tall:
            head = len(tokens[0].text)
        if tokens[-1].text == "]" and not any(n in blocks.items for n in range(start + 1, stop)):
            mark = len("".join(pieces[: _last_brackets(tokens) + 1])) - 1
    headless = start in blocks.items and not has_head
    return _Line("".join(pieces), indent, blocks.block[start], tokens[-1].remarks, head, mark, headless)


def _last_brackets(tokens: Sequence[Token]) -> int:
    """The opening one of the brackets that a line ends in; brackets may stand in brackets."""
    depth = 0
    for number in range(len(tokens) - 1, -1, -1):
        depth += {"]": 1, "[": -1}.get(tokens[number].text, 0)
        if not depth:
            return number
    raise AssertionError("the parser has matched them")


# ---- columns


def _in_columns(lines: Sequence[_Line]) -> list[str]:
    """The lines as text: heads of one block stand in a column up to a blank line or another item, marks and
    comments in one where their lines are adjacent."""
    lines = _adjacent(_heads(lines), lambda line: line.mark is not None, _marks)
    return [text for _, run in groupby(lines, lambda line: bool(line.remarks)) for text in _text(list(run))]


def _heads(lines: Sequence[_Line]) -> list[_Line]:
    columns: dict[tuple[int | None, int], int] = defaultdict(int)
    runs: list[tuple[int | None, int]] = []
    ended: dict[int | None, int] = defaultdict(int)
    for line in lines:
        ended[line.block] += line.headless or not line.code
        runs.append((line.block, ended[line.block]))
        columns[runs[-1]] = max(columns[runs[-1]], line.head or 0)
    return [
        line if line.head is None else _padded(line, line.head, columns[run])
        for line, run in zip(lines, runs, strict=True)
    ]


def _marks(run: list[_Line]) -> list[_Line]:
    column = max(line.mark or 0 for line in run)
    return [_padded(line, line.mark or 0, column) for line in run]


def _adjacent(
    lines: Iterable[_Line], wanted: Callable[[_Line], bool], change: Callable[[list[_Line]], list[_Line]]
) -> list[_Line]:
    """The lines with each run of those that are wanted, in one block, changed together."""
    runs = groupby(lines, lambda line: (wanted(line), line.block))
    return [line for (chosen, _), run in runs for line in (change(list(run)) if chosen else run)]


def _padded(line: _Line, at: int, column: int) -> _Line:
    """The line with what stands `at` moved to `column`."""
    blanks = " " * (column - at)
    mark = None if line.mark is None else line.mark + len(blanks)
    return replace(line, code=line.code[:at] + blanks + line.code[at:], mark=mark)


def _text(run: Sequence[_Line]) -> list[str]:
    """Adjacent lines that all have comments behind their code, or none of which has."""
    column = max(line.indent + len(line.code) for line in run) + 2
    texts = []
    for line in run:
        code = " " * line.indent + line.code if line.code else ""
        first, *more = line.remarks or ("",)
        texts.append(code.ljust(column) + first if first else code)
        texts += [" " * column + remark for remark in more]
    return texts
