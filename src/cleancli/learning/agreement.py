"""Whether experience agrees with the probabilities that a domain's text says: a likelihood-ratio test."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite

from scipy.special import gammaincc

from cleancli.language.model import Domain
from cleancli.learning.estimate import maximum_likelihood
from cleancli.learning.evidence import Evidence, weights
from cleancli.learning.expectation import Beliefs, expected, log_likelihoods, nothing_counted
from cleancli.learning.match import outcomes_of

SIGNIFICANT = 0.01
"""Chance of finding a rule that disagrees where all are right. Chosen."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """How well a rule's examples agree with its probabilities (`rule` None: the default rule).

    `statistic` is twice by how much the best probabilities make the examples likelier, in natural logarithms.
    Where the stated ones are right it follows about a chi-square distribution with `freedom` degrees (Wilks
    1938), and is as large or larger with probability `p`; less often where outcomes cannot be told apart.
    """

    rule: int | None
    examples: int
    statistic: float
    freedom: int
    p: float


def agreements(domain: Domain, evidence: Evidence) -> tuple[Agreement, ...]:
    """One for each rule that has examples, in the domain's order, the default rule last."""
    seen = weights(evidence, 0.0)
    _, best = expected(domain, seen, maximum_likelihood, 0.0, nothing_counted(domain))
    stated = Beliefs(
        {
            rule: tuple(float(outcome.probability) for outcome in outcomes_of(domain, rule))
            for rule in best.probabilities
        },
        best.parameters,
        best.slips,
    )
    found = []
    by_stated, examples = log_likelihoods(seen, stated), evidence.examples()
    for rule, by_best in log_likelihoods(seen, best).items():
        # What no outcome explains contradicts the rule, whatever its probabilities.
        statistic = max(0.0, 2 * (by_best - by_stated[rule])) if isfinite(by_best) else inf
        freedom = max(1, len(outcomes_of(domain, rule)) - 1)
        p = float(gammaincc(freedom / 2, statistic / 2))
        found.append(Agreement(rule, examples[rule], statistic, freedom, p))
    return tuple(sorted(found, key=lambda each: (each.rule is None, each.rule or 0)))


def disagreeing(found: tuple[Agreement, ...]) -> tuple[Agreement, ...]:
    """The rules whose examples would be so unlikely with their probabilities that chance explains it in less
    than `SIGNIFICANT` of all tests of so many rules (Bonferroni)."""
    return tuple(each for each in found if each.p < SIGNIFICANT / len(found))
