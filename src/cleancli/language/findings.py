"""What a check collects: diagnostics in the order found, and the help that names near spellings."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from cleancli.language.diagnostics import Diagnostic, Level, Refused, Source, Span
from cleancli.language.lines import Lines

RESERVED = frozenset({"count", "forall", "noise", "not", "nothing", "rest", "then", "when"})
"""Words that the grammar expects where names stand too; as a name they could not be used."""


class Findings:
    """The mistakes found in one source; `broken` names its sections that the parser could not read."""

    def __init__(
        self, source: Source, found: Iterable[Diagnostic] = (), broken: frozenset[str] = frozenset()
    ) -> None:
        self.source = source
        self.broken = broken
        self._found = list(found)
        self._lines = Lines(source.text)

    def error(self, code: str, message: str, span: Span, label: str = "", help: str = "") -> None:
        """Note a mistake."""
        self._found.append(Diagnostic(code, message, span, label, help))

    def unknown(
        self, code: str, what: str, name: str, span: Span, known: Iterable[str], where: str = ""
    ) -> None:
        """Note a name that is not declared, with the near ones, or all of them where they are few."""
        self.error(code, f"unknown {what} `{name}`{where}", span, help=meant(name, known, what))

    @property
    def count(self) -> int:
        """How many were noted so far."""
        return len(self._found)

    def line(self, span: Span) -> int:
        """The line, from 1, in which a span begins."""
        return self._lines.place(span.start)[0]

    @property
    def sorted(self) -> tuple[Diagnostic, ...]:
        """All of them in the order of the text; equal ones once."""
        return tuple(
            sorted(
                dict.fromkeys(self._found), key=lambda d: (d.span.start if d.span else -1, d.code, d.message)
            )
        )

    def refuse_errors(self) -> None:
        """Raise Refused with everything found if an error is among it."""
        found = self.sorted
        if any(d.level is Level.ERROR for d in found):
            raise Refused(found, [self.source])


def meant(name: str, known: Iterable[str], what: str) -> str:
    """A help line: "did you mean" or the list of what there is."""
    names = sorted(set(known))
    near = difflib.get_close_matches(name, names, n=2, cutoff=0.6)
    if near:
        return f"did you mean {' or '.join(f'`{n}`' for n in near)}?"
    if 0 < len(names) <= 8:
        return f"known here: {', '.join(f'`{n}`' for n in names)}"
    return "" if names else f"no {what} is declared"
