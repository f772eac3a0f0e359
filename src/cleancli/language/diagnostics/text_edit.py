"""Edits of a text at spans."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from cleancli.language.diagnostics.diagnostic import Span


@dataclass(frozen=True, slots=True)
class Edit:
    """Replace what stands at `span` by `replacement`; an empty span inserts."""

    span: Span
    replacement: str


def apply_edits(text: str, edits: Iterable[Edit]) -> str:
    """The text with all edits made; offsets mean the old text, and nothing outside the spans changes.

    Raises ValueError for spans that overlap, insert at one place twice, or lie outside the text.
    """
    ordered = sorted(edits, key=lambda edit: (edit.span.start, edit.span.end))
    parts = []
    done = 0
    previous: Span | None = None
    for edit in ordered:
        span = edit.span
        if not 0 <= span.start <= span.end <= len(text):
            raise ValueError(f"edit at {span.start}..{span.end} lies outside the text")
        if span.start < done or span == previous:
            raise ValueError(f"edits overlap at {span.start}")
        parts += [text[done : span.start], edit.replacement]
        done, previous = span.end, span
    return "".join(parts) + text[done:]
