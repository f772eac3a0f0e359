"""How counts and a prior become a probability (§5.1)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

DEFAULT_M = 10.0
"""Weight of the prior in examples; the value used in §6.3."""

Estimator = Callable[[int, int, float, float], float]
"""(times seen, examples of the rule, prior, m) -> probability."""


def m_estimate(seen: int, examples: int, prior: float, m: float = DEFAULT_M) -> float:
    """The m-estimate (eq. 4), `seen` being its p and `examples` its p + n."""
    return (seen + m * prior) / (examples + m)


def decreasing_m_estimate(seen: int, examples: int, prior: float, m: float = DEFAULT_M) -> float:
    """The decreasing m-estimate (eq. 5); with no examples, where eq. 5 is undefined, the prior."""
    if examples == 0:
        return prior
    return m_estimate(seen, examples, prior, m / math.sqrt(examples))


ESTIMATORS: Mapping[str, Estimator] = MappingProxyType(
    {"decreasing-m": decreasing_m_estimate, "m": m_estimate}
)
