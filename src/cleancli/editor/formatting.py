"""The canonical layout as one small edit, so that an editor keeps its cursor and folds."""

from __future__ import annotations

from cleancli.editor.library import Document
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.printing.formatter import layout


def formatting(asked: Document) -> tuple[Edit, ...]:
    """The edit that gives a text its canonical layout; none where it has it, or a syntax error."""
    old = asked.source.text
    if asked.parsed is None or asked.parsed.diagnostics:
        return ()
    try:
        new = layout(old)
    except Refused:
        return ()
    if new == old:
        return ()
    head = _common(old, new)
    tail = _common(old[head:][::-1], new[head:][::-1])
    # A line end of two characters is one place for an editor: neither edge may come between them.
    while head and old[head - 1] == "\r":
        head -= 1
    while tail and old[len(old) - tail] == "\n":
        tail -= 1
    return (Edit(Span(asked.source.path, head, len(old) - tail), new[head : len(new) - tail]),)


def _common(one: str, other: str) -> int:
    """How many characters two texts begin with alike."""
    differs = (index for index, (a, b) in enumerate(zip(one, other, strict=False)) if a != b)
    return next(differs, min(len(one), len(other)))
