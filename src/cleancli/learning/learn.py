"""From transitions to better probabilities (§5.1)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from cleancli.language.model import Domain
from cleancli.learning.estimate import DEFAULT_M, ESTIMATORS
from cleancli.learning.expectation import Beliefs, Evidence, SlipRates, expected, likeliest, maximised
from cleancli.learning.experience import Transition
from cleancli.learning.match import Matcher, outcomes_of, prior_probabilities
from cleancli.learning.share import Counts, exactly, in_units, rounded

COUNTED = 100
"""Parts of an example that counts are rounded to."""


@dataclass(frozen=True, slots=True)
class Learned:
    """New probabilities of one rule (None: the default rule), one per outcome; they sum to exactly 1.

    `seen` says of how many examples each outcome was the result, where one that several outcomes explain is
    shared among them; `unexplained` are those that fit none, in a rule without noise.
    """

    rule: int | None
    priors: tuple[Fraction, ...]
    probabilities: tuple[Fraction, ...]
    seen: tuple[Fraction, ...]
    unexplained: int


@dataclass(frozen=True, slots=True)
class Lesson:
    """What transitions teach: of every rule that they give an example of, or whose parameter they change, in
    the domain's order, the default rule last; and what is believed now."""

    rules: tuple[Learned, ...]
    beliefs: Beliefs


MATCHES = ("shared", "strict")


@dataclass(frozen=True, slots=True)
class Method:
    """How to learn: the estimator by its name, the weight of the prior in examples, and what a transition
    counts for (see `Matcher`): for all outcomes that fit, or for the likeliest of those that fit strictly."""

    estimator: str = "decreasing-m"
    m: float = DEFAULT_M
    match: str = "shared"

    @property
    def is_strict(self) -> bool:
        return self.match == "strict"


DEFAULT = Method()


def learn(domain: Domain, transitions: Iterable[Transition], method: Method = DEFAULT) -> Lesson:
    """What transitions teach about a domain's probabilities. Raises `Refused` (E602)."""
    return learned_from(domain, Counter(map(Matcher(domain, method.is_strict).match, transitions)), method)


def learned_from(domain: Domain, evidence: Evidence, method: Method) -> Lesson:
    """The same of transitions that were matched already."""
    estimator = ESTIMATORS[method.estimator]
    if method.is_strict:
        counts = likeliest(domain, evidence)
        beliefs = maximised(domain, counts, SlipRates(), estimator, method.m)
    else:
        counts, beliefs = expected(domain, evidence, estimator, method.m)
    return Lesson(tuple(_rules(domain, evidence, counts, beliefs)), beliefs)


def _rules(domain: Domain, evidence: Evidence, counts: Counts, beliefs: Beliefs) -> Iterator[Learned]:
    parameters = in_units(domain, beliefs.parameters)
    changed = {p.name for p in domain.parameters if parameters[p.name] != p.probability}
    unexplained: Counter[int | None] = Counter()
    for match, number in evidence.items():
        if not any(match.fits):
            unexplained[match.rule] += number
    for rule, probabilities in beliefs.probabilities.items():
        outcomes = outcomes_of(domain, rule)
        has_examples = any(counts[rule]) or unexplained[rule]
        if has_examples or any(outcome.parameter in changed for outcome in outcomes):
            yield Learned(
                rule,
                prior_probabilities(outcomes),
                exactly(outcomes, probabilities, parameters),
                rounded(counts[rule], Fraction(round(sum(counts[rule]))), COUNTED),
                unexplained[rule],
            )
