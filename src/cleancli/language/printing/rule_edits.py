"""Edits by which rules of a domain's text give way to others, with all else as it is."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple

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
    add others to the first of the sources.

    A rule is added where the first dropped rule of its action stood, or else where the first dropped rule
    did, or before what ends a domain. `default` is what a default rule that the domain has none of yet says;
    empty for none.
    """
    gaps = {source.path: list(_places(source, dropped)) for source in sources}
    main, symbols = sources[0], symbols_of(domain)
    texts: dict[Span, list[str]] = {}
    for rule in added:
        place = _place(main, gaps[main.path], rule.action)
        texts.setdefault(place, []).append(print_rule(rule, symbols))
    if default:
        place = next(reversed(texts), None) or _place(main, gaps[main.path], None)
        texts.setdefault(place, []).append(print_default(default, symbols))
    edits = [Edit(gap.span, "") for listed in gaps.values() for gap in listed if gap.span not in texts]
    for place, parts in texts.items():
        text = "\n".join(parts)
        edits.append(Edit(place, text if place.start < place.end else f"\n{text}\n"))
    return tuple(edits)


class _Gap(NamedTuple):
    """Where a rule of an action stood that is dropped."""

    action: str
    span: Span


def _place(main: Source, gaps: Sequence[_Gap], action: str | None) -> Span:
    """Where a rule of an action is added; None of a default rule."""
    for gap in (*(gap for gap in gaps if gap.action == action), *gaps):
        return gap.span
    end = _end(main)
    return Span(main.path, end, end)


def _root(source: Source) -> DomainNode:
    root = parse(source).root
    assert isinstance(root, DomainNode), "the checker has read it before"
    return root


def _places(source: Source, names: Collection[str]) -> Iterator[_Gap]:
    """Where rules stand, each with its lines and the lines of comments right above."""
    for section in _root(source).sections:
        if isinstance(section, RuleNode) and section.name.text in names:
            start = line_start(source.text, section.span.start)
            if source.text[start : section.span.start].strip(" \t"):
                yield _Gap(section.action.text, section.span)
                continue
            start = _above(source.text, start)
            rest = _REST_OF_LINE.match(source.text, section.span.end)
            end = section.span.end if rest is None else rest.end()
            yield _Gap(section.action.text, Span(source.path, start, end))


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
