"""How many examples the priors of rules weigh as much as, by how well they foretell the examples.

The m-estimate (eq. 4) is the mean of a Dirichlet distribution with the parameters m P₀, after the examples.
Here m is not given. Each rule has its own, of which its examples tell, each foretold from all others (the
leave-one-out likelihood of Minka 2000, "Estimating a Dirichlet distribution"), and the other rules too: the
logarithms of all follow one normal distribution, whose mean and spread are not known either (hierarchical
Bayes). So where priors proved wrong, that of a rule that was hardly tried weighs little. All that m, the mean
and the spread may be is enumerated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Floats
from cleancli.learning.estimate import Estimator, m_estimate

FACTORS: Floats = 10 ** np.arange(-1.5, 2.6, 0.5)
"""What m may be of that which was asked for. Chosen: from hardly any prior to one that hardly changes."""

AROUND = 1.5
"""Standard deviation of the mean logarithm before anything was seen, around what was asked for. Chosen: that
priors are worth a fifth or five times as much is no surprise."""

SPREADS = (0.5, 2.5)
"""Standard deviations of a rule's logarithm around the mean, each as likely before anything was seen. Chosen:
that priors are all worth about as much, or that some are right and some are wrong."""


@dataclass(frozen=True, slots=True)
class Foretold:
    """Examples of a rule, alike ones together, and what foretells them, of outcomes of which something is
    learned.

    `numbers` (n,) says how many there are of each kind, `likelihoods` (n, outcomes) how likely each outcome
    makes one, `others` (n, outcomes) how often each outcome happened in all examples but one of the kind, and
    `priors` (outcomes,) what was believed before.
    """

    numbers: Floats
    likelihoods: Floats
    others: Floats
    priors: Floats


def _distributions() -> tuple[Floats, Floats]:
    """All normal distributions of the logarithms (distributions, factors), and the logarithm of how likely
    each was before anything was seen."""
    places = np.log(FACTORS)
    found = [np.exp(-(((places - mean) / spread) ** 2) / 2) for mean in places for spread in SPREADS]
    before: Floats = -((np.repeat(places, len(SPREADS)) / AROUND) ** 2) / 2
    return np.array([each / each.sum() for each in found]), before


_GIVEN, _BEFORE = _distributions()


def chances_of_weights(rules: Sequence[Foretold], m: float) -> Floats:
    """How likely each of `FACTORS` is the one of each rule (rules, factors), where `m` > 0 was asked for."""
    logs = np.array([_log_likelihoods(rule, m * FACTORS) for rule in rules]).reshape(-1, len(FACTORS))
    likelihoods = np.exp(logs - logs.max(axis=1, keepdims=True))
    of_rules = likelihoods @ _GIVEN.T  # (rules, distributions)
    of_all = _BEFORE + np.log(of_rules).sum(axis=0)
    chances = np.exp(of_all - of_all.max())
    found: Floats = likelihoods * ((chances / chances.sum() / of_rules) @ _GIVEN)
    return found


def _log_likelihoods(rule: Foretold, weights: Floats) -> Floats:
    """Of a rule's examples under each weight (weights,), as far as they depend on it."""
    by_prior = rule.likelihoods @ rule.priors
    told = by_prior > 0
    by_others = (rule.likelihoods * rule.others).sum(axis=1)[told, None]
    of_each = by_others + weights * by_prior[told, None]
    of_any = rule.others.sum(axis=1)[told, None] + weights * rule.priors.sum()
    found: Floats = rule.numbers[told] @ np.log(of_each / of_any)
    return found


def averaged(chances: Floats) -> Estimator:
    """The mean of the m-estimates whose m are `FACTORS` of what was asked for, by how likely each is."""
    by_factor: list[tuple[float, float]] = list(zip(FACTORS.tolist(), chances.tolist(), strict=True))

    def estimate(seen: float, examples: float, prior: float, m: float) -> float:
        return sum(chance * m_estimate(seen, examples, prior, factor * m) for factor, chance in by_factor)

    return estimate
