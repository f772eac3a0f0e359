"""The `learned` block of a domain: what the counts in it mean, and from which experience they come."""

from __future__ import annotations

import re

from cleancli.language import syntax
from cleancli.language.checking.declarations import sections_of
from cleancli.language.checking.notes import MOST_COUNTED
from cleancli.language.checking.settings import settings_by_key
from cleancli.language.diagnostics.diagnostic import Span, printable
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Experience, Knowledge

KEYS = {
    "estimator": "how counts and a prior become a probability",
    "m": "how many examples the prior weighs as much as",
    "match": "what a transition counts for that several outcomes may have made",
    "forgetting": "by which share an example counts for less than the next one of its rule",
}
"""The settings of the block, and what each means."""

OPTIONAL = frozenset({"forgetting"})
"""Those that need not be said."""

WORDS = {"estimator": ("decreasing_m", "m", "fitted_m", "likelihood"), "match": ("shared", "strict")}
"""What the settings that are words may be, the usual one first."""

LARGEST_M = 1_000_000
"""Examples that a prior may weigh as much as. Chosen: above it nothing is ever learned."""

MOST_FORGETTING = 0.5
"""Share that may be forgotten with each example. Chosen: above it hardly more than the last one counts."""

HASH_DIGITS = 16
"""Hexadecimal digits of a SHA-256 by which experience is told from other experience. Chosen: 64 bits."""

_HASH = re.compile(f"[0-9a-f]{{{HASH_DIGITS}}}")


def check_learned(node: syntax.Learned, findings: Findings) -> Knowledge:
    """What the block says (E216, E502, E504 to E506, E513)."""
    settings = settings_by_key(sections_of(node.entries, syntax.Setting), KEYS, findings)
    for key in KEYS:
        if key not in settings and key not in OPTIONAL:
            _refuse_without(key, node, findings)
    return Knowledge(
        _word(settings.get("estimator"), findings),
        _number(settings.get("m"), LARGEST_M, findings),
        _word(settings.get("match"), findings),
        _experience(sections_of(node.entries, syntax.ExperienceNode), findings),
        _number(settings.get("forgetting"), MOST_FORGETTING, findings),
        node.span,
    )


def _refuse_without(key: str, node: syntax.Learned, findings: Findings) -> None:
    head = Span(node.span.path, node.span.start, node.span.start + len("learned"))
    usual = WORDS[key][0] if key in WORDS else "10"
    findings.error(
        "E513", f"`learned` needs `{key}`: {KEYS[key]}", head, help=f"add for example `{key} = {usual}`"
    )


def _word(setting: syntax.Setting | None, findings: Findings) -> str:
    if setting is None:
        return ""
    key, value = setting.key.text, setting.value
    if not isinstance(value, syntax.Word):
        help = findings.meant("", WORDS[key], key)
        findings.error("E504", f"`{key}` wants a word", value.span, help=help)
        return ""
    if value.text not in WORDS[key]:
        findings.unknown("E506", key, value.text, value.span, WORDS[key])
    return value.text


def _number(setting: syntax.Setting | None, most: float, findings: Findings) -> float:
    """A number from 0 on; 0 where there is none."""
    if setting is None:
        return 0.0
    key, value = setting.key.text, setting.value
    if not isinstance(value, syntax.Quantity):
        findings.error("E504", f"`{key}` wants a number", value.span)
        return 0.0
    if not 0 <= value.value <= most:
        findings.error("E505", f"`{key}` lies between 0 and {most}", value.span)
    return float(value.value)


def _experience(nodes: tuple[syntax.ExperienceNode, ...], findings: Findings) -> tuple[Experience, ...]:
    """The experience that was counted; E216 for some that is counted twice."""
    first: dict[str, Span] = {}
    for node in nodes:
        digest = node.sha256.text
        if not _HASH.fullmatch(digest):
            help = "the learner writes it: it begins the SHA-256 of the lines that were counted"
            findings.error(
                "E504",
                f"`sha256` wants {HASH_DIGITS} digits from 0 to 9 and a to f",
                node.sha256.span,
                help=help,
            )
        elif digest in first:
            help = f"it was counted in {findings.line(first[digest])} already"
            findings.error("E216", "this experience is counted twice", node.span, help=help)
        first.setdefault(digest, node.span)
        _refuse_number(node.transitions, findings)
    return tuple(Experience(printable(n.name.text), n.sha256.text, int(n.transitions.value)) for n in nodes)


def _refuse_number(number: syntax.Number, findings: Findings) -> None:
    if not number.is_whole:
        findings.error("E504", "`transitions` wants a whole number", number.span)
    elif not 1 <= number.value <= MOST_COUNTED:
        findings.error("E505", f"`transitions` lies between 1 and {MOST_COUNTED}", number.span)
