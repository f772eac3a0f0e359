"""How many examples the priors weigh as much as, by how well they foretell the examples (empirical Bayes).

The m-estimate (eq. 4) is the mean of a Dirichlet distribution with the parameters m P₀, after the examples.
Here m is not given but fitted: each example is foretold from all others of its rule, and that m is taken
which makes the examples likeliest (the leave-one-out likelihood of Minka 2000, "Estimating a Dirichlet
distribution"). It is one number for all rules: where priors were wrong about some, those of the others weigh
little as well, and where they were right, more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Floats

SPREAD = 1.5
"""Standard deviation of the logarithm of m before anything was seen, around what was asked for. Chosen: a
fifth or five times as much is no surprise."""

_REACH = math.log(1e4)
"""How far from what was asked for the logarithm of m is sought."""

_HALVINGS = 40


@dataclass(frozen=True, slots=True)
class Foretold:
    """Examples of a rule, alike ones together, and what foretells them.

    `numbers` (n,) says how many there are of each kind, `likelihoods` (n, outcomes) how likely each outcome
    makes one, `others` (n, outcomes) how often each outcome happened in all examples but one of the kind, and
    `priors` (outcomes,) what was believed before. All are 0 for outcomes of which nothing is learned.
    """

    numbers: Floats
    likelihoods: Floats
    others: Floats
    priors: Floats


def fitted(examples: Sequence[Foretold], m: float) -> float:
    """The weight under which the examples are likeliest; `m` without any, and where that is 0."""
    if not m or not examples:
        return m
    numbers = np.concatenate([each.numbers for each in examples])
    own, by_prior, others, priors = np.hstack([_parts(each) for each in examples])
    # An example that nothing but its own outcome's prior foretells says nothing of m, nor does one of a rule
    # with nothing to learn.
    told = (by_prior > 0) & (priors > 0)
    numbers, own, by_prior, others, priors = (part[told] for part in (numbers, own, by_prior, others, priors))

    def slope(logarithm: float) -> float:
        """Of the log-likelihood, by the logarithm of m."""
        weight = math.exp(logarithm)
        gained = by_prior / (own + weight * by_prior) - priors / (others + weight * priors)
        return weight * float(numbers @ gained) - (logarithm - math.log(m)) / SPREAD**2

    low, high = math.log(m) - _REACH, math.log(m) + _REACH
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if slope(middle) > 0 else (low, middle)
    return math.exp((low + high) / 2)


def _parts(rule: Foretold) -> Floats:
    """Of each kind (4, n) what other examples and the prior say for it, and how much there is of both."""
    ones = np.ones(len(rule.numbers))
    parts: Floats = np.array(
        [
            (rule.likelihoods * rule.others).sum(axis=1),
            rule.likelihoods @ rule.priors,
            rule.others.sum(axis=1),
            rule.priors.sum() * ones,
        ]
    )
    return parts
