"""From transitions to better probabilities, and from those to edits of the text they came from (§5.1)."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.language.diagnostics import Span
from cleancli.language.edit import Edit
from cleancli.language.model import Domain, Outcome
from cleancli.learning.estimate import DEFAULT_M, Estimator, decreasing_m_estimate
from cleancli.learning.experience import Transition
from cleancli.learning.match import explain, outcomes_of, prior_probabilities

DIGITS = 4
"""Decimals of a learned probability in the text."""


@dataclass(frozen=True, slots=True)
class Learned:
    """New probabilities of one rule (None: the default rule), one per outcome; they sum to exactly 1.

    `seen` counts the examples per outcome; `unexplained` those that fit none, in a rule without noise.
    """

    rule: int | None
    priors: tuple[Fraction, ...]
    probabilities: tuple[Fraction, ...]
    seen: tuple[int, ...]
    unexplained: int


def learn(
    domain: Domain,
    transitions: Sequence[Transition],
    estimator: Estimator = decreasing_m_estimate,
    m: float = DEFAULT_M,
) -> tuple[Learned, ...]:
    """Estimates for every rule that the transitions give an example of; domain's order, default last."""
    counts = Counter(explain(domain, transition) for transition in transitions)
    covered = {explanation.rule for explanation in counts}
    order = [index for index in (*range(len(domain.rules)), None) if index in covered]
    learned = []
    for rule in order:
        outcomes = outcomes_of(domain, rule)
        seen = tuple(
            sum(count for e, count in counts.items() if e.rule == rule and e.outcome == index)
            for index in range(len(outcomes))
        )
        unexplained = sum(count for e, count in counts.items() if e.rule == rule and e.outcome is None)
        priors = prior_probabilities(outcomes)
        estimates = [estimator(seen[index], sum(seen), float(prior), m) for index, prior in enumerate(priors)]
        learned.append(Learned(rule, priors, _rounded(estimates), seen, unexplained))
    return tuple(learned)


def edits(domain: Domain, text: str, learned: Sequence[Learned]) -> tuple[Edit, ...]:
    """The text edits that put the estimates in: numbers and their `[prior p, seen n]`, nothing else.

    The prior stays in the file, so learning again from the same experience changes nothing. `rest` stays too:
    it is what the other outcomes leave.
    """
    result = []
    for estimate in learned:
        outcomes = outcomes_of(domain, estimate.rule)
        for outcome, probability, seen in zip(outcomes, estimate.probabilities, estimate.seen, strict=True):
            if not outcome.is_rest:
                result.extend(_outcome_edits(outcome, text, probability, seen))
    return tuple(result)


def _outcome_edits(outcome: Outcome, text: str, probability: Fraction, seen: int) -> list[Edit]:
    number, weight = outcome.probability_span, outcome.weight_span
    assert number is not None, "a domain read from text knows its places"
    assert weight is not None
    old = text[number.start : number.end]
    new = _decimal(probability)
    if outcome.seen is None:
        return [Edit(number, f"{new} [prior {old}, seen {seen}]")]
    result = [] if probability == outcome.probability else [Edit(number, new)]
    if seen != outcome.seen:
        result.append(Edit(_seen_span(text, weight), str(seen)))
    return result


def _seen_span(text: str, weight: Span) -> Span:
    """The digits after `seen` inside an outcome's weight."""
    found = re.search(r"\bseen\s+(\d+)", text[weight.start : weight.end])
    assert found is not None, "the parser has found it there before"
    return Span(weight.path, weight.start + found.start(1), weight.start + found.end(1))


def _rounded(estimates: Sequence[float]) -> tuple[Fraction, ...]:
    """The estimates in units of 10^-DIGITS, summing to exactly 1 (largest remainders are rounded up)."""
    unit = 10**DIGITS
    scaled = [estimate * unit for estimate in estimates]
    floors = [math.floor(value) for value in scaled]
    by_remainder = sorted(range(len(scaled)), key=lambda index: (floors[index] - scaled[index], index))
    for index in by_remainder[: unit - sum(floors)]:
        floors[index] += 1
    return tuple(Fraction(value, unit) for value in floors)


def _decimal(probability: Fraction) -> str:
    """Shortest decimal of a multiple of 10^-DIGITS, with at least one digit after the point."""
    text = f"{float(probability):.{DIGITS}f}".rstrip("0")
    return text + "0" if text.endswith(".") else text
