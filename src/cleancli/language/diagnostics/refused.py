"""The refusal of an input, which carries its diagnostics and shows them as its text."""

from __future__ import annotations

from collections.abc import Iterable

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source


class Refused(Exception):
    """Input that can't be used; carries every diagnostic found and the sources they point into. Its text is
    what `cleancli check` prints of them."""

    def __init__(self, diagnostics: Iterable[Diagnostic], sources: Iterable[Source] = ()) -> None:
        self.diagnostics = tuple(diagnostics)
        self.sources = tuple(sources)
        super().__init__(self.diagnostics, self.sources)

    def __str__(self) -> str:
        # Loaded here: every command that starts loads this module, and few refusals are read as text.
        from cleancli.language.diagnostics.messages import excerpt
        from cleancli.language.diagnostics.render import render

        part = excerpt(self.diagnostics)
        return "\n".join(filter(None, (render(part.shown, self.sources).rstrip(), part.note)))
