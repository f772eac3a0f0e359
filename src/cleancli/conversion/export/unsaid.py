"""What another language has no words for, told all at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from cleancli.conversion.export.formulas import NotSaid
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused


class Unsaid:
    """Collects E919; `language` is what the message calls the language, `sources` the texts of the domain."""

    def __init__(self, language: str, sources: Sequence[Source]) -> None:
        self._language = language
        self._sources = tuple(sources)
        self._found: list[Diagnostic] = []

    def note(self, message: str, span: Span | None = None, help: str = "") -> None:
        """Something that can't be said, at its place, or at that of the domain."""
        place = span or Span(self._sources[0].path, 0, 0)
        self._found.append(
            Diagnostic("E919", f"{self._language} cannot say this: {message}", place, help=help)
        )

    @contextmanager
    def of(self, place: Span | None, of: str = "") -> Iterator[None]:
        """Notes what is raised because of what stands at a place, `of` which the message speaks."""
        try:
            yield
        except NotSaid as unsaid:
            self.note(f"{of}{': ' if of else ''}{unsaid}", place)

    def refuse(self) -> None:
        """Raises Refused with all that was noted, if anything was."""
        if self._found:
            raise Refused(self._found, self._sources)
