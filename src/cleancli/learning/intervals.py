"""How sure the examples make a probability, whatever the prior says: intervals that hold it 95 times in 100.

Of examples each of which is known to be the result of one outcome, Jeffreys' interval holds for an outcome's
probability (Brown, Cai and DasGupta 2001). Examples that several outcomes share tell less: as many as would
tell as much are found from the information that is observed (Louis 1982), and take their place.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import betaincinv

from cleancli.array_types import Floats
from cleancli.language.model import Domain
from cleancli.learning.evidence import Weights
from cleancli.learning.expectation import Beliefs, shares
from cleancli.learning.learn import Learned, Lesson
from cleancli.learning.match import outcomes_of

MISSED = 0.05
"""Chance that an interval does not hold the probability."""

JEFFREYS = 0.5
"""What his prior adds to the examples of an outcome, and to those of all others."""

_LEAST = 1e-9
"""In place of no information."""

Interval = tuple[float, float]
"""The least and the greatest probability."""

Intervals = Mapping[int | None, tuple[Interval, ...]]
"""Of each rule, an interval for each outcome; that of what is fixed has no width."""


class Told(NamedTuple):
    """What `examples` tell of an outcome: how many are held to be its, how many must be and how many may be;
    `effective` is how many would tell as much if each was known to be one outcome's."""

    examples: float = 0.0
    seen: float = 0.0
    surely: float = 0.0
    possibly: float = 0.0
    effective: float = 0.0


def intervals(domain: Domain, evidence: Weights, lesson: Lesson) -> Intervals:
    """Of the probabilities in a lesson, by the examples that it is from. A shared parameter has the examples
    of all its rules."""
    told = {each.rule: _told(domain, evidence, lesson.beliefs, each) for each in lesson.rules}
    pooled: dict[str, Told] = {}
    for rule, found in told.items():
        for outcome, of_rule in zip(outcomes_of(domain, rule), found, strict=True):
            if outcome.parameter is not None:
                before = pooled.get(outcome.parameter, Told())
                pooled[outcome.parameter] = Told(*np.add(before, of_rule).tolist())
    return {each.rule: tuple(_of_rule(domain, each, told[each.rule], pooled)) for each in lesson.rules}


def _of_rule(
    domain: Domain, learned: Learned, told: Sequence[Told], pooled: Mapping[str, Told]
) -> Iterator[Interval]:
    """The outcomes' intervals; fixed ones leave less than 1 to the others."""
    outcomes = outcomes_of(domain, learned.rule)
    left = 1.0 - sum(float(outcome.probability) for outcome in outcomes if outcome.fixed)
    for outcome, of_rule in zip(outcomes, told, strict=True):
        if outcome.fixed:
            yield float(outcome.probability), float(outcome.probability)
            continue
        low, high = _interval(of_rule if outcome.parameter is None else pooled[outcome.parameter])
        yield low * left, high * left


def _interval(told: Told) -> Interval:
    """An outcome is at least as likely as an example that must be its, and at most as one that may be."""
    low, high = interval(told.effective * told.seen / max(told.examples, _LEAST), told.effective)
    return (
        max(low, interval(told.surely, told.examples)[0]),
        min(high, interval(told.possibly, told.examples)[1]),
    )


def interval(seen: float, examples: float) -> Interval:
    """Of a probability of which so many of the examples speak: equal chances of missing it on both sides, but
    for what none or all of the examples speak of, which reaches to the end."""
    against = examples - seen
    low = betaincinv(seen + JEFFREYS, against + JEFFREYS, MISSED / 2) if seen > 0 else 0.0
    high = betaincinv(seen + JEFFREYS, against + JEFFREYS, 1 - MISSED / 2) if against > 0 else 1.0
    return float(low), float(high)


def effective_examples(shared: Floats, numbers: Floats, counted: Floats) -> Floats:
    """How many examples would tell as much of each outcome's probability if each was known to be the result
    of one outcome (outcomes,). `shared` is to how much of each transition each outcome led (n, outcomes),
    `numbers` how many there are of each (n,), `counted` the examples of each outcome that are known to be its
    (outcomes,).
    """
    seen = numbers @ shared + counted
    total = float(seen.sum())
    probabilities = seen / max(total, _LEAST)
    # What is observed about relative changes of the probabilities, which keep their sum (Louis, eq. 3.2).
    observed = (shared.T * numbers) @ shared + np.diag(counted + _LEAST)
    number = len(seen)
    bordered = np.zeros((number + 1, number + 1))
    bordered[:number, :number] = observed
    bordered[:number, number] = bordered[number, :number] = probabilities
    variances = np.diag(np.linalg.pinv(bordered))[:number]
    between = (probabilities > 0) & (probabilities < 1)
    found = np.full(number, total)
    found[between] = (1 - probabilities[between]) / (
        probabilities[between] * np.maximum(variances[between], _LEAST)
    )
    effective: Floats = np.minimum(found, total)
    return effective


def _told(domain: Domain, evidence: Weights, beliefs: Beliefs, learned: Learned) -> list[Told]:
    """What a rule's examples tell of each outcome, what is fixed aside."""
    free = [index for index, outcome in enumerate(outcomes_of(domain, learned.rule)) if not outcome.fixed]
    found = [(match, number) for match, number in evidence.items() if match.rule == learned.rule]
    of_all = np.array([shares(match, beliefs) for match, _ in found], dtype=float)
    shared, numbers = (
        of_all.reshape(-1, len(learned.seen))[:, free],
        np.array([number for _, number in found], dtype=float),
    )
    seen = np.array([float(learned.seen[index]) for index in free])
    counted = np.maximum(0.0, seen - numbers @ shared)
    possible = shared > 0
    alone = possible & (possible.sum(axis=1, keepdims=True) == 1)
    parts = np.stack(
        [
            np.full(len(free), seen.sum()),
            seen,
            numbers @ alone + counted,
            numbers @ possible + counted,
            effective_examples(shared, numbers, counted),
        ]
    )
    told = dict(zip(free, (Told(*column) for column in parts.T.tolist()), strict=True))
    return [told.get(index, Told()) for index in range(len(learned.seen))]
