"""Names for .nid files: those of PDDL's files, in the letters that they were first written in, where they can
stay. Hyphens, and other signs that no name of a .nid file has, become an underscore: `push--far` becomes
`push_far`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from cleancli.conversion.pddl.syntax import Name
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.sink import RESERVED

_SIGN = re.compile(r"[^A-Za-z0-9_]+")


class Naming:
    """Gives a name to each thing of one kind, none twice.

    Names are in lower case in syntax, so `sources` tell how they were written.
    """

    def __init__(self, sources: Mapping[str, Source]) -> None:
        self._sources = sources
        self._taken: set[str] = set()
        self._given: dict[str, str] = {}

    def of(self, name: Name, initial: str) -> str:
        """What something is called, now and each time; `initial` stands before a name that begins with a
        digit."""
        return self.of_text(name.text, name.span.path, name.span.start, initial)

    def of_text(self, text: str, path: str, start: int, initial: str) -> str:
        """As `of`, for a name that stands in the file at `path`."""
        given = self._given.get(text)
        if given is None:
            written = self._sources[path].text[start : start + len(text)]
            given = self._given[text] = self.fresh(written, initial)
        return given

    def fresh(self, wanted: str, initial: str = "n") -> str:
        """The wanted name, with underscores behind it while it is taken."""
        name = readable(wanted, initial)
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        return name

    def written(self, name: Name) -> str:
        """A name in the letters that stand in the file."""
        return self._sources[name.span.path].text[name.span.start : name.span.end]


def readable(name: str, initial: str) -> str:
    """The name in signs that a .nid file's names have, and no word of the language."""
    changed = name.removeprefix("?")
    if not (changed.isascii() and changed.isidentifier()):
        changed = _SIGN.sub("_", changed)
        if not changed or changed[0].isdigit():
            return f"{initial}{changed}"
    return f"{changed}_" if changed in RESERVED else changed
