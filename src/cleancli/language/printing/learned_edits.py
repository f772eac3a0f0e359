"""Edits by which a domain's text says what its numbers rest on now, with its comments as they are."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.source_lines import LINE_END, line_start
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.model import Domain, Knowledge
from cleancli.language.parsing.parse import parse
from cleancli.language.printing.printer import print_experience, print_learned, print_settings
from cleancli.language.syntax import DomainNode, ExperienceNode, Learned, Setting

_BLANK_LINE = re.compile(r"[ \t]*(?:\r\n|\n|\r)")


def learned_edits(domain: Domain, source: Source, learned: Knowledge) -> tuple[Edit, ...]:
    """The edits of the file that was asked for, `source`: of its own `learned` block, or that add one before
    its last brace. What is counted already stays where it stands, and what is new follows it."""
    before, end = domain.learned, domain.end
    assert end is not None, "a domain read from text knows its places"
    if before is None or before.span is None or before.span.path != source.path:
        return (_inserted(source, end.start, print_learned(learned)),)
    block = _block(source)
    known, kept = ({each.sha256 for each in known.experience} for known in (before, learned))
    dropped = [e for e in block.entries if isinstance(e, ExperienceNode) and e.sha256.text not in kept]
    new = print_experience([each for each in learned.experience if each.sha256 not in known])
    added = [*_added_settings(block, learned), *new]
    lines = "".join(f"    {line}\n" for line in added)
    return (
        *_settings(block, before, learned),
        *(Edit(_with_line(source.text, node.span), "") for node in dropped),
        *([_inserted(source, before.span.end - 1, lines)] if added else []),
    )


def _block(source: Source) -> Learned:
    root = parse(source).root
    assert isinstance(root, DomainNode), "the checker has read it before"
    return next(section for section in root.sections if isinstance(section, Learned))


def _settings(block: Learned, before: Knowledge, learned: Knowledge) -> Iterator[Edit]:
    """New values of the settings that have others; what is optional and usual now says 0."""
    old, new = print_settings(before), print_settings(learned)
    for entry in _settings_of(block):
        key = entry.key.text
        if old.get(key, "0") != new.get(key, "0"):
            yield Edit(entry.value.span, new.get(key, "0"))


def _added_settings(block: Learned, learned: Knowledge) -> list[str]:
    """Lines of the settings that the block does not name yet."""
    named = {entry.key.text for entry in _settings_of(block)}
    return [f"{key} = {value}" for key, value in print_settings(learned).items() if key not in named]


def _settings_of(block: Learned) -> list[Setting]:
    return [entry for entry in block.entries if isinstance(entry, Setting)]


def _inserted(source: Source, brace: int, lines: str) -> Edit:
    """Lines of their own before a brace that closes a block, with the text's line ends."""
    start = line_start(source.text, brace)
    if source.text[start:brace].strip(" \t"):
        start, lines = brace, f"\n{lines}"
    found = LINE_END.search(source.text)
    end = found.group() if found else "\n"
    return Edit(Span(source.path, start, start), lines.replace("\n", end))


def _with_line(text: str, span: Span) -> Span:
    """A span with all of its line, if nothing else stands there."""
    start, behind = line_start(text, span.start), _BLANK_LINE.match(text, span.end)
    if text[start : span.start].strip(" \t") or behind is None:
        return span
    return Span(span.path, start, behind.end())
