"""Text to syntax tree: parse, and where that fails blank the block at fault and parse again.

Every block is so parsed on its own: one mistake is reported for each, however many there are.
"""

from __future__ import annotations

import difflib
import gc
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

from lark import UnexpectedInput

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.source_lines import Lines
from cleancli.language.parsing.ast_builder import Builder
from cleancli.language.parsing.errors import Reader
from cleancli.language.parsing.grammar import grammar, keywords
from cleancli.language.parsing.lexemes import BLANK, COMMENT
from cleancli.language.parsing.recovery import Block, blank, outline
from cleancli.language.record import Record
from cleancli.language.syntax import Root

KINDS = ("domain", "problem", "scene", "study")
_MOST_ERRORS = 20
_SETTING = re.compile(r"\b(?:include|domain|horizon|discount)\b|\w+(?=\s*[=:])")
"""What can stand between the sections of a file."""


class Parsed(Record):
    """What could be read of a text. `broken` names the sections that were left out because of mistakes (by
    the first word of their headers); `root` is None where not even the outermost block could be read."""

    root: Root | None
    broken: frozenset[str]
    diagnostics: tuple[Diagnostic, ...]


@contextmanager
def _nothing_to_collect() -> Iterator[None]:
    """Pause the collection of cycles: trees have none, and searching growing trees takes half of the time."""
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def kind_of(source: Source) -> str:
    """Which of KINDS the text is; raises Refused (E105) for anything else."""
    span = beginning(source)
    word = source.text[span.start : span.end]
    if word in KINDS:
        return word
    forms = f"a file holds one block: {', '.join(f'`{kind} NAME {{ ... }}`' for kind in KINDS[:-1])}"
    forms += f" or `{KINDS[-1]} NAME {{ ... }}`"
    if not word:
        raise Refused(
            [Diagnostic("E105", "the file is empty", Span(source.path, 0, 0), help=forms)], [source]
        )
    near = difflib.get_close_matches(word, KINDS, n=1)
    message = f"a file cannot begin with `{word}`"
    advice = f"did you mean `{near[0]}`?" if near else forms
    if word in ("(", ";"):
        advice = "if this is PDDL, `cleancli convert` makes .nid files of it"
    raise Refused([Diagnostic("E105", message, span, help=advice)], [source])


def beginning(source: Source) -> Span:
    """Where the text's first word or sign stands, after blanks and comments; at the end where there is
    none."""
    match = re.match(rf"(?:{BLANK}|{COMMENT})*(?P<first>\w+|\S|)", source.text)
    assert match is not None
    return Span(source.path, *match.span("first"))


@_nothing_to_collect()
def parse(source: Source) -> Parsed:
    """The syntax tree with every syntax error found (E101 to E107); raises Refused if it is no .nid text."""
    kind_of(source)
    shape = outline(source)
    diagnostics = list(shape.diagnostics[:_MOST_ERRORS])
    broken = {block.name for block in shape.blocks if shape.body[block.start : block.end].isspace()}
    text = shape.body
    while len(diagnostics) < _MOST_ERRORS:
        reader = Reader(source.path, text, len(source.text), keywords())
        try:
            tree = grammar().parse(text)
        except UnexpectedInput as error:
            diagnostics.append(reader.diagnose(error))
            place = min(error.pos_in_stream or 0, len(text) - 1)
            in_block = any(block.start <= place < block.end for block in shape.blocks)
            shorter, names = _without_fault(text, place, shape.blocks)
            if shorter in (text, "") or shorter.isspace() or (not in_block and shape.diagnostics):
                return Parsed(None, frozenset(broken), tuple(diagnostics))
            broken |= names
            text = shorter
        else:
            return Parsed(cast(Root, Builder(source.path).build(tree)), frozenset(broken), tuple(diagnostics))
    return Parsed(None, frozenset(broken), tuple(diagnostics))


def _without_fault(text: str, place: int, blocks: tuple[Block, ...]) -> tuple[str, frozenset[str]]:
    """Blank the section around the mistake, or else what stands between sections in its line."""
    for block in blocks:
        if block.start <= place < block.end:
            return blank(text, block.start, block.end), frozenset({block.name})
    lines = Lines(text)
    number = lines.place(place)[0]
    line_start = lines.start(number)
    line_end = line_start + len(lines.line(number))
    start = max([line_start, *(block.end for block in blocks if block.end <= place)])
    end = min([line_end, *(block.start for block in blocks if block.start > place)])
    between = text[start:end]
    if "{" in between or "}" in between:
        return text, frozenset()
    return blank(text, start, end), frozenset(_SETTING.findall(between)[:1])
