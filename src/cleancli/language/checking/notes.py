"""What the learner noted beside a number: how often it was seen, and that it is to stay as it is.

Guaranteed by the parser: structure. The prior is read by whoever knows what the number means.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import TypeVar

from cleancli.language import syntax
from cleancli.language.diagnostics.sink import Findings

MOST_COUNTED = 1_000_000_000
"""Transitions that a count may speak of: more than any robot sees. Chosen."""

_WORDS = {
    syntax.Prior: "prior",
    syntax.QuantityPrior: "prior",
    syntax.Seen: "seen",
    syntax.Fixed: "fixed",
}
_Mark = TypeVar("_Mark", syntax.Prior, syntax.QuantityPrior, syntax.Seen, syntax.Fixed)


def mark_of(kind: type[_Mark], marks: Iterable[syntax.Node], findings: Findings) -> _Mark | None:
    """The mark of a kind, None where there is none; E311 for a second one."""
    found = [mark for mark in marks if isinstance(mark, kind)]
    for second in found[1:]:
        findings.error("E311", f"a second `{_WORDS[kind]}`", second.span)
    return found[0] if found else None


def times_seen(marks: Iterable[syntax.Node], findings: Findings) -> Fraction | None:
    """How often something was seen (E311), None where that is not said."""
    seen = mark_of(syntax.Seen, marks, findings)
    if seen is None:
        return None
    if seen.count.value > MOST_COUNTED:
        findings.error("E311", f"`seen` counts at most {MOST_COUNTED} times", seen.count.span)
    return seen.count.value


def is_fixed(marks: Iterable[syntax.Node], findings: Findings) -> bool:
    """Whether the learner leaves the number alone."""
    return mark_of(syntax.Fixed, marks, findings) is not None
