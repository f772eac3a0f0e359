"""What all nodes have in common."""

from __future__ import annotations

from dataclasses import field

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.record import Record


class Node(Record):
    """Anything that stands in the text. Its span is given by name, and equality ignores it."""

    span: Span = field(kw_only=True, compare=False)
