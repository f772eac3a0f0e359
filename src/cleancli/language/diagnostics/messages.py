"""Selects the diagnostics to show: each once, and no more than a person reads."""

from __future__ import annotations

import os
from collections.abc import Iterable

from cleancli.language.diagnostics.diagnostic import Diagnostic, Level
from cleancli.language.diagnostics.plural import plural
from cleancli.language.record import Record

MOST = 100
"""Messages of one run, unless all are asked for."""


class Excerpt(Record):
    """The diagnostics that are shown, in their order, and how many mistakes and warnings are not."""

    shown: tuple[Diagnostic, ...]
    mistakes: int = 0
    warnings: int = 0

    @property
    def left_out(self) -> int:
        """How many are not shown."""
        return self.mistakes + self.warnings

    @property
    def note(self) -> str:
        """How many are not shown: `2 more mistakes and 1 more warning`."""
        numbers = ((self.mistakes, "more mistake"), (self.warnings, "more warning"))
        return " and ".join(plural(number, what) for number, what in numbers if number)


def distinct(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Each mistake once: the first of those that say the same of one place, by whatever path it is named."""
    real: dict[str, str] = {}
    first: dict[tuple[object, ...], Diagnostic] = {}
    for diagnostic in diagnostics:
        span = diagnostic.span
        place: tuple[object, ...] = ()
        if span is not None:
            path = real.setdefault(span.path, os.path.realpath(span.path))
            place = path, span.start, span.end
        first.setdefault((diagnostic.code, diagnostic.message, *place), diagnostic)
    return tuple(first.values())


def excerpt(diagnostics: Iterable[Diagnostic], most: int | None = MOST) -> Excerpt:
    """The first `most` of them (None: all), mistakes before warnings where not all can be shown."""
    found = tuple(diagnostics)
    if most is None or len(found) <= most:
        return Excerpt(found)
    errors = [number for number, d in enumerate(found) if d.level is Level.ERROR]
    others = [number for number, d in enumerate(found) if d.level is not Level.ERROR]
    chosen = sorted((errors + others)[:most])
    mistakes = max(0, len(errors) - most)
    return Excerpt(tuple(found[n] for n in chosen), mistakes, len(found) - most - mistakes)
