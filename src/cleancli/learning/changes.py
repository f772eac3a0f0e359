"""Whether a rule began to do something else in the course of its examples, and when (§5.1: a new grasp).

While a rule stays as it is, the share of an outcome in its examples goes up and down around the mean, and the
sums of what each is above it, divided by their spread, wander as a Brownian bridge does. A change bends them.
This is the fluctuation test of the likelihood's scores (Hjort and Koning 2002, Zeileis and Hornik 2007): the
score of an outcome's logit is its share less its probability.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from cleancli.array_types import Floats
from cleancli.learning.evidence import Evidence
from cleancli.learning.expectation import Beliefs, shares

SIGNIFICANT = 0.01
"""Chance of finding a change in evidence without any. Chosen."""

FEWEST = 20
"""Examples of a rule without which nothing is said. Chosen: the Brownian bridge is a limit."""

EDGE = 5
"""Examples at least on either side of a change. Chosen."""

_FLAT = 1e-9
"""Part of the largest variance below which outcomes do not vary apart from each other."""

_CERTAIN, _TERMS = 0.2, 30
"""A bridge goes further than 0.2 but for a chance of 5e-13, and from there on so many terms are exact."""


@dataclass(frozen=True, slots=True)
class RuleChange:
    """That a rule (None: the default rule) does something else from a transition on, by its index among all;
    with chance `p` of so much without a change, and how often its outcomes led to the examples before and
    after, up to the changes that come next."""

    rule: int | None
    transition: int
    p: float
    before: tuple[float, ...]
    after: tuple[float, ...]


def changes(evidence: Evidence, beliefs: Beliefs) -> tuple[RuleChange, ...]:
    """All that are found, in the order of their transitions."""

    @cache
    def shares_of(kind: int) -> tuple[float, ...]:
        return shares(evidence.kinds[kind], beliefs)

    rules = list(evidence.rules())
    found: list[RuleChange] = []
    for rule, indices in rules:
        of_each = np.array([shares_of(evidence.order[index]) for index in indices])
        found += _of_rule(rule, indices, of_each, len(rules))
    return tuple(sorted(found, key=lambda each: each.transition))


def _of_rule(rule: int | None, numbers: list[int], found: Floats, rules: int) -> Iterator[RuleChange]:
    """Those of one rule, of whose examples `numbers` are the indices and `found` the shares (n, outcomes);
    what counts as chance is shared among so many rules (Bonferroni)."""
    places = sorted(_places(found, SIGNIFICANT / rules).items())
    bounds = [0, *(place for place, _ in places), len(found)]
    for index, (place, p) in enumerate(places):
        before, after = found[bounds[index] : place], found[place : bounds[index + 2]]
        means = (tuple(map(float, part.mean(axis=0))) for part in (before, after))
        yield RuleChange(rule, numbers[place], p, *means)


def _places(found: Floats, significant: float) -> dict[int, float]:
    """Where the shares change, and how unlikely that is by chance; what lies on either side is searched as
    well."""
    p, place = fluctuation(found)
    if p >= significant:
        return {}
    later = {place + each: chance for each, chance in _places(found[place:], significant).items()}
    return {**_places(found[:place], significant), place: p, **later}


def fluctuation(found: Floats) -> tuple[float, int]:
    """Of shares (n, outcomes) in turn: the chance of sums so far from a Brownian bridge if nothing changed,
    and the first example of what would be the likeliest change."""
    number = len(found)
    if number < FEWEST:
        return 1.0, 0
    above = found - found.mean(axis=0)
    variances, axes = np.linalg.eigh(above.T @ above / number)
    varies = variances > max(_FLAT, _FLAT * variances[-1])
    if not varies.any():
        return 1.0, 0
    bridges = np.cumsum(above @ axes[:, varies] / np.sqrt(variances[varies]), axis=0) / np.sqrt(number)
    chance = kolmogorov(float(np.abs(bridges).max()))
    # Bridges are independent of each other (Šidák).
    p = 1.0 if chance == 1 else -math.expm1(int(varies.sum()) * math.log1p(-chance))
    ends = np.arange(1, number)
    apart = (bridges[:-1] ** 2).sum(axis=1) / (ends * (number - ends))
    inside = apart[EDGE - 1 : number - EDGE]
    return p, EDGE + int(inside.argmax())


def kolmogorov(distance: float) -> float:
    """The chance that a Brownian bridge goes so far from zero (Kolmogorov 1933).

    Written out, because loading scipy for it would take longer than learning from a run does.
    """
    if distance < _CERTAIN:
        return 1.0
    k = np.arange(1, _TERMS)
    return min(1.0, float(2 * np.sum((-1.0) ** (k + 1) * np.exp(-2 * (k * distance) ** 2))))
