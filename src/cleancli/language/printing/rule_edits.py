"""Edits by which rules of a domain's text give way to others, with all else as it is."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence

from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.source_lines import line_start
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.model import Domain, Outcome, Rule
from cleancli.language.parsing.parse import parse
from cleancli.language.printing.printer import print_default, print_rule, symbols_of
from cleancli.language.syntax import Default, DomainNode, Learned, Reward, RuleNode

_COMMENT_LINE = re.compile(r"[ \t]*#[^\r\n]*(?:\r\n|\n|\r)")
_REST_OF_LINE = re.compile(r"[ \t]*(?:#[^\r\n]*)?(?:\r\n|\n|\r|\Z)")


def rule_edits(
    domain: Domain,
    sources: Sequence[Source],
    dropped: Collection[str],
    added: Sequence[Rule],
    default: Sequence[Outcome] = (),
) -> tuple[Edit, ...]:
    """The edits that drop the rules of these names, with the comments that stand right above them, and that
    add others to the first of the sources: where its first dropped rule stood, or before what ends a domain.

    `default` is what a default rule that the domain has none of yet says; empty for none.
    """
    edits: list[Edit] = []
    for source in sources:
        edits += [Edit(span, "") for span in _places(source, dropped)]
    symbols = symbols_of(domain)
    text = "\n".join(print_rule(rule, symbols) for rule in added)
    text += f"\n{print_default(default, symbols)}" if default else ""
    if text:
        main = sources[0]
        here = [edit for edit in edits if edit.span.path == main.path]
        if here:
            edits[edits.index(here[0])] = Edit(here[0].span, text)
        else:
            end = _end(main)
            edits.append(Edit(Span(main.path, end, end), f"\n{text}\n"))
    return tuple(edits)


def _root(source: Source) -> DomainNode:
    root = parse(source).root
    assert isinstance(root, DomainNode), "the checker has read it before"
    return root


def _places(source: Source, names: Collection[str]) -> Iterator[Span]:
    """Where rules stand, each with its lines and the lines of comments right above."""
    for section in _root(source).sections:
        if isinstance(section, RuleNode) and section.name.text in names:
            start = line_start(source.text, section.span.start)
            if source.text[start : section.span.start].strip(" \t"):
                yield section.span
                continue
            start = _above(source.text, start)
            rest = _REST_OF_LINE.match(source.text, section.span.end)
            yield Span(source.path, start, section.span.end if rest is None else rest.end())


def _above(text: str, start: int) -> int:
    """Where the lines of comments begin that stand right above the start of a line."""
    while start:
        above = line_start(text, start - 1)
        if _COMMENT_LINE.fullmatch(text, above, start) is None:
            break
        start = above
    return start


def _end(source: Source) -> int:
    """Where more rules may stand: before the block of the default rule, of rewards or of what was learned, or
    before the last brace."""
    root = _root(source)
    after = [each.span.start for each in root.sections if isinstance(each, Default | Reward | Learned)]
    return min(after, default=root.span.end - 1)
