"""Collects the diagnostics of a check in the order found, and suggests near spellings of unknown names."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable

from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.source_lines import Lines

RESERVED = frozenset(
    {
        "closure", "count", "exists", "forall", "if", "noise", "not", "nothing", "or", "rest", "then",
        "unlimited", "when", "with",
    }
)  # fmt: skip
"""Words that the grammar expects where names stand too; as a name they could not be used."""

_FIRST = frozenset({"E401"})
FEW = 8
"""Names that a help line lists all of. Chosen."""

_MOST_COMPARED = 100_000
"""Names that spellings are compared with, of all mistakes in a file: about a second's work."""


class Findings:
    """The mistakes found in one text and those it includes.

    `broken` names the sections that the parser could not read; `used` the names that something refers to, by
    kind ("type", "constant", "symbol", "parameter", "action"); `unclear` those whose declaration is
    wrong, by what messages call them: what such a name means is not known, and no mistake follows from it.
    """

    def __init__(
        self, source: Source, found: Iterable[Diagnostic] = (), broken: frozenset[str] = frozenset()
    ) -> None:
        self.sources = [source]
        self.broken = broken
        self.used: set[tuple[str, str]] = set()
        self.unclear: set[tuple[str, str]] = set()
        self._found = list(found)
        self._errors = len(self._found)
        self._lines: dict[str, Lines] = {}
        self._compared = 0

    @property
    def source(self) -> Source:
        """The text that was asked for, which may include the others."""
        return self.sources[0]

    def include(self, source: Source, found: Iterable[Diagnostic], broken: frozenset[str]) -> None:
        """Take in what the parser found in a text that this one includes."""
        self.sources.append(source)
        self.broken |= broken
        found = tuple(found)
        self._found += found
        self._errors += len(found)

    def error(self, code: str, message: str, span: Span, label: str = "", help: str = "") -> None:
        """Note a mistake."""
        self._errors += 1
        self._found.append(Diagnostic(code, message, span, label, help))

    def warning(self, code: str, message: str, span: Span, label: str = "", help: str = "") -> None:
        """Note something that is allowed, but hardly meant."""
        self._found.append(Diagnostic(code, message, span, label, help, Level.WARNING))

    def unknown(
        self,
        code: str,
        what: str,
        name: str,
        span: Span,
        known: Iterable[str],
        where: str = "",
        most: int = FEW,
    ) -> None:
        """Note a name that is not declared, with the near ones, or all of them where they are few."""
        self.error(code, f"unknown {what} `{name}`{where}", span, help=self.meant(name, known, what, most))

    def meant(self, name: str, known: Iterable[str], what: str, most: int = FEW) -> str:
        """As the function `meant`, until it has been asked so often that nobody reads the answers."""
        names = set(known)
        if self._compared + len(names) > _MOST_COMPARED:
            return ""
        self._compared += len(names)
        return meant(name, names, what, most)

    def use(self, kind: str, name: str) -> None:
        """Note that something refers to a declared name."""
        self.used.add((kind, name))

    def fold(self, codes: re.Pattern[str]) -> int:
        """Take back everything that was noted under these codes, and say how much that was."""
        kept = [diagnostic for diagnostic in self._found if not codes.fullmatch(diagnostic.code)]
        folded = len(set(self._found)) - len(set(kept))
        self._found = kept
        self._errors = sum(diagnostic.level is Level.ERROR for diagnostic in kept)
        return folded

    @property
    def errors(self) -> int:
        """How many mistakes were noted so far, warnings aside."""
        return self._errors

    def line(self, span: Span) -> str:
        """`line 3`, or `line 3 of base.nid` in an included file: where a span begins."""
        if span.path not in self._lines:
            text = next(source.text for source in self.sources if source.path == span.path)
            self._lines[span.path] = Lines(text)
        number = self._lines[span.path].place(span.start)[0]
        return f"line {number}" if span.path == self.source.path else f"line {number} of {span.path}"

    @property
    def sorted(self) -> tuple[Diagnostic, ...]:
        """All of them, file by file in the order of the text; equal ones once, and first what others follow
        from."""
        order = {source.path: number for number, source in enumerate(self.sources)}

        def place(diagnostic: Diagnostic) -> tuple[bool, int, int, str, str]:
            span = diagnostic.span
            where = (-1, -1) if span is None else (order.get(span.path, -1), span.start)
            return (diagnostic.code not in _FIRST, *where, diagnostic.code, diagnostic.message)

        return tuple(sorted(dict.fromkeys(self._found), key=place))

    def refuse_errors(self) -> None:
        """Raise Refused with everything found if an error is among it."""
        if self.errors:
            raise Refused(self.sorted, self.sources)


def meant(name: str, known: Iterable[str], what: str, most: int = FEW) -> str:
    """A help line: "did you mean" or the list of what there is, where that are `most` at most."""
    names = sorted(set(known))
    near = difflib.get_close_matches(name, names, n=2, cutoff=0.6)
    if near:
        return f"did you mean {' or '.join(f'`{n}`' for n in near)}?"
    if 0 < len(names) <= most:
        return f"known here: {', '.join(f'`{n}`' for n in names)}"
    return "" if names else f"no {what} is declared"
