"""How probabilities are learned, as a user asks for it."""

from __future__ import annotations

from dataclasses import dataclass

from cleancli.learning.estimate import DEFAULT_M, FITTED

MATCHES = ("shared", "strict")

KNOWN = 12
"""Examples after which a rule counts as known; the value used in §6.3."""

DELTA = 0.05
"""Chance that an estimate may be further off than was asked for (eq. 6). Chosen."""


@dataclass(frozen=True, slots=True)
class Method:
    """The `estimator` by its name, the weight of the prior in examples, what a transition counts for (see
    `match.Matcher`): for all outcomes that may have made it, or for the likeliest of those that fit strictly;
    and by which share an example counts for less than the next one of its rule.
    """

    estimator: str = "decreasing-m"
    m: float = DEFAULT_M
    match: str = "shared"
    forgetting: float = 0.0

    @property
    def fits_m(self) -> bool:
        return self.estimator == FITTED

    @property
    def is_strict(self) -> bool:
        return self.match == "strict"


DEFAULT = Method()
