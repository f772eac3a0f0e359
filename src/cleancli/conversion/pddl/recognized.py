"""What tells PPDDL from other texts. It stands apart from what reads and converts PPDDL, which takes time to
load and which few commands need."""

from __future__ import annotations

import re

from cleancli.language.diagnostics.diagnostic import Source

SUFFIXES = (".pddl", ".ppddl")
"""What the names of PPDDL files end with."""

_BEGINNING = re.compile(r"\ufeff?(\s|;[^\r\n]*[\r\n])*\(")


def is_pddl(source: Source) -> bool:
    """Whether a text is PDDL: its file is called so, or its first sign is a parenthesis, with which no .nid
    file begins."""
    return source.path.lower().endswith(SUFFIXES) or _BEGINNING.match(source.text) is not None
