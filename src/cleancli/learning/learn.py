"""From transitions to better probabilities (§5.1)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from cleancli.language.model import Domain, Outcome
from cleancli.learning.durations import (
    LearnedCorrection,
    LearnedDuration,
    learn_corrections,
    learn_durations,
)
from cleancli.learning.estimate import ESTIMATORS
from cleancli.learning.evidence import Evidence, Weights, collected, weights
from cleancli.learning.expectation import (
    Beliefs,
    SlipRates,
    expected,
    likeliest,
    maximised,
    nothing_counted,
    prior_beliefs,
    told,
)
from cleancli.learning.experience import Transition
from cleancli.learning.match import Matcher, outcomes_of, prior_probabilities
from cleancli.learning.method import DEFAULT, Method
from cleancli.learning.share import Counts, counts_rounded, exactly, in_units


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
    the domain's order, the default rule last; what is believed now; how long actions take, and how much
    longer than was expected."""

    rules: tuple[Learned, ...]
    beliefs: Beliefs
    durations: tuple[LearnedDuration, ...] = ()
    corrections: tuple[LearnedCorrection, ...] = ()


def learn(domain: Domain, transitions: Iterable[Transition], method: Method = DEFAULT) -> Lesson:
    """What transitions teach about a domain's probabilities. Raises `Refused` (E602)."""
    return learned_from(domain, collected(Matcher(domain, method.is_strict), transitions), method)


def learned_from(domain: Domain, evidence: Evidence, method: Method, adding: bool = False) -> Lesson:
    """The same of transitions that were matched already; where `adding`, beside what the domain's text has
    counted."""
    estimator = ESTIMATORS[method.estimator]
    before = _faded(counted(domain), evidence, method) if adding else nothing_counted(domain)
    seen = weights(evidence, method.forgetting)
    if method.is_strict:
        counts = likeliest(domain, seen, before)
        own = told(domain, counts, method.m) if method.fits_m else {}
        beliefs = maximised(domain, prior_beliefs(domain), counts, SlipRates(), estimator, method.m, own)
    else:
        counts, beliefs = expected(domain, seen, estimator, method.m, before, method.fits_m)
    durations = learn_durations(domain, evidence.times, adding, method.forgetting)
    corrections = learn_corrections(evidence.estimates, method.forgetting)
    return Lesson(tuple(_rules(domain, seen, counts, beliefs)), beliefs, durations, corrections)


def _faded(before: Counts, evidence: Evidence, method: Method) -> Counts:
    """What was counted before, as much as it counts after the examples that came since."""
    if not method.forgetting:
        return before
    kept = {rule: (1 - method.forgetting) ** number for rule, number in evidence.examples().items()}
    return {rule: tuple(kept.get(rule, 1.0) * count for count in counts) for rule, counts in before.items()}


def counted(domain: Domain) -> Counts:
    """How often each outcome was seen, by what the domain's text says.

    Of a shared parameter the text says how often all its outcomes were seen together. They are as likely in
    each rule, so that each rule had its part in proportion to what else was seen of it.
    """
    outcomes = {rule: outcomes_of(domain, rule) for rule in nothing_counted(domain)}
    own = {rule: sum(map(_seen, found), start=Fraction(0)) for rule, found in outcomes.items()}
    together: Counter[str] = Counter()
    for rule, found in outcomes.items():
        together.update({o.parameter: own[rule] for o in found if o.parameter is not None})

    def part(rule: int | None, outcome: Outcome) -> Fraction:
        if outcome.parameter is None:
            return _seen(outcome)
        everything = together[outcome.parameter]
        return (outcome.seen or Fraction(0)) * own[rule] / everything if everything else Fraction(0)

    return {rule: tuple(float(part(rule, o)) for o in found) for rule, found in outcomes.items()}


def _seen(outcome: Outcome) -> Fraction:
    """How often an outcome was seen whose count is its own."""
    return Fraction(0) if outcome.parameter is not None else outcome.seen or Fraction(0)


def revised(domain: Domain, lesson: Lesson) -> Domain:
    """The domain with the probabilities and the durations that were learned; all else is as it was."""
    rules, default = list(domain.rules), domain.default
    for learned in lesson.rules:
        outcomes = tuple(
            replace(outcome, probability=probability)
            for outcome, probability in zip(
                outcomes_of(domain, learned.rule), learned.probabilities, strict=True
            )
        )
        if learned.rule is None:
            default = outcomes
        else:
            rules[learned.rule] = replace(rules[learned.rule], outcomes=outcomes)
    seconds = {each.action: each.seconds for each in lesson.durations}
    actions = tuple(
        replace(action, duration=seconds.get(action.name, action.duration)) for action in domain.actions
    )
    return replace(domain, actions=actions, rules=tuple(rules), default=default)


def _rules(domain: Domain, seen: Weights, counts: Counts, beliefs: Beliefs) -> Iterator[Learned]:
    parameters = in_units(domain, beliefs.parameters)
    changed = {p.name for p in domain.parameters if parameters[p.name] != p.probability}
    unexplained: dict[int | None, float] = {}
    for match, number in seen.items():
        if not any(match.fits):
            unexplained[match.rule] = unexplained.get(match.rule, 0) + number
    for rule, probabilities in beliefs.probabilities.items():
        outcomes = outcomes_of(domain, rule)
        left = round(unexplained.get(rule, 0))
        has_examples = any(counts[rule]) or left
        if has_examples or any(outcome.parameter in changed for outcome in outcomes):
            yield Learned(
                rule,
                prior_probabilities(outcomes),
                exactly(outcomes, probabilities, parameters),
                counts_rounded(counts[rule]),
                left,
            )
