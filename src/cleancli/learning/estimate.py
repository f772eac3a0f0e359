"""How counts and a prior become a probability (§5.1), and how many examples make it known (§5.2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

DEFAULT_M = 10.0
"""Weight of the prior in examples; the value used in §6.3."""

Estimator = Callable[[float, float, float, float], float]
"""(times seen, examples of the rule, prior, m) -> probability. Counts may be fractions: an example that
several outcomes explain is shared among them."""


def m_estimate(seen: float, examples: float, prior: float, m: float = DEFAULT_M) -> float:
    """The m-estimate (eq. 4), `seen` being its p and `examples` its p + n; the prior where both weigh 0."""
    weight = examples + m
    return (seen + m * prior) / weight if weight else prior


def decreasing_m_estimate(seen: float, examples: float, prior: float, m: float = DEFAULT_M) -> float:
    """The decreasing m-estimate (eq. 5); with no examples, where eq. 5 is undefined, the prior."""
    if not examples:
        return prior
    return m_estimate(seen, examples, prior, m / math.sqrt(examples))


def maximum_likelihood(seen: float, examples: float, prior: float, m: float = DEFAULT_M) -> float:
    """The share of the examples, which is eq. 4 with m = 0; the prior without any. `m` counts for nothing."""
    return m_estimate(seen, examples, prior, 0)


FITTED = "fitted-m"
"""The m-estimate, with an m for each rule that is fitted to the examples (prior_weight.py)."""

ESTIMATORS: Mapping[str, Estimator] = MappingProxyType(
    {
        "decreasing-m": decreasing_m_estimate,
        "m": m_estimate,
        FITTED: m_estimate,
        "likelihood": maximum_likelihood,
    }
)


def examples_needed(epsilon: float, delta: float) -> int:
    """Examples after which an estimate is off by at most epsilon with probability 1 - delta (eq. 6)."""
    return math.ceil(math.log(2 / delta) / (2 * epsilon**2))
