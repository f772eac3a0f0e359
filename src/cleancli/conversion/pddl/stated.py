"""Numbers that .nid files can state, and that take no time to compute with.

PDDL bounds neither their digits nor how many of them are multiplied. A .nid file's numbers have 30 digits
before the point, and as fractions 400 (grammar/nid.lark).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Domain, Outcome, Price

_LARGEST = 10**30
LONGEST_DENOMINATOR = 10**100
"""What the denominator of a number is below, and the common one of all numbers of a file. Chosen: more than
anybody writes, and few enough digits for sums of thousands."""


def is_stated(value: Fraction) -> bool:
    """Whether a .nid file can state a number."""
    return abs(value) < _LARGEST and value.denominator < LONGEST_DENOMINATOR


def refuse_unstated(domain: Domain, actions: Mapping[str, Span], place: Span, findings: Findings) -> None:
    """E917 for each action, by its place, that has a number which no .nid file can state, and for a reward
    that is one, at the place of the domain."""
    numbers: dict[str, list[Fraction]] = {each.name: [*_amounts(each.cost)] for each in domain.actions}
    for rule in domain.rules:
        numbers[rule.action] += [value for outcome in rule.outcomes for value in _numbers(outcome)]
    for action, values in numbers.items():
        if not all(map(is_stated, values)):
            message = f"a probability, reward or cost of `{action}` has too many digits for a .nid file"
            findings.error("E917", message, actions[action], help="round the numbers that it is made of")
    if not all(is_stated(term.weight) for term in domain.reward):
        findings.error("E917", "what the goal pays has too many digits for a .nid file", place)


def _numbers(outcome: Outcome) -> Iterator[Fraction]:
    yield outcome.probability
    yield from _amounts(outcome.reward)
    yield from _amounts(outcome.cost)


def _amounts(price: Price) -> Iterator[Fraction]:
    yield price.number
    yield from (part.weight for part in price.parts)
