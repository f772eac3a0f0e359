"""How often each outcome happened, where several may have made a transition (§5).

Expectation and maximisation: each transition is shared among the outcomes that fit it, in proportion to how
likely each makes it, and the shares are counted as examples are; what they make of the probabilities and of
the rates of slips gives the next shares, until nothing changes. Without a prior this climbs to the greatest
likelihood, with the m-estimate to the greatest posterior under a Dirichlet prior of that weight (Dempster,
Laird and Rubin 1977).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.language.model import Domain
from cleancli.learning.estimate import Estimator
from cleancli.learning.evidence import Weights
from cleancli.learning.match import Fit, Match, outcomes_of, prior_probabilities
from cleancli.learning.prior_weight import Foretold, averaged, chances_of_weights
from cleancli.learning.share import Counts, estimated, learn_parameters, shared_out

SLIPS_BEFORE = (0.5, 10.0)
"""Slips of each kind, and chances of one, that count beside what was seen: about one in twenty. Chosen; a few
dozen transitions outweigh it."""

TOLERANCE = 1e-8
"""Change of a probability below which nothing changes."""

ROUNDS = 5000
"""Chosen: far more than the slowest of the shipped domains needs."""

_NEVER = 1e-300
"""In place of probability 0, so that what nothing else explains still goes somewhere."""


@dataclass(frozen=True, slots=True)
class SlipRates:
    """How often a change of other objects that an outcome announces does not happen, and how often a fact of
    theirs changes that it does not announce."""

    missed: float = SLIPS_BEFORE[0] / SLIPS_BEFORE[1]
    stray: float = SLIPS_BEFORE[0] / SLIPS_BEFORE[1]


@dataclass(frozen=True, slots=True)
class Beliefs:
    """What is believed of a domain: probabilities per rule (None: the default rule), the values of its shared
    parameters, and how often outcomes slip."""

    probabilities: Mapping[int | None, tuple[float, ...]]
    parameters: Mapping[str, float]
    slips: SlipRates


Estimators = Mapping[int | None, Estimator]
"""Of rules that have their own."""

_OwnPriors = Mapping[int | None, tuple[Floats, Floats]]
"""Of each rule what is 1 for outcomes whose probabilities their own examples tell, and 0 for those that are
fixed or share a parameter; and their priors, both (outcomes,)."""


@dataclass(frozen=True, slots=True)
class _Group:
    """The transitions of a rule, alike ones together: how many there are of each (n,), which outcomes may
    have made them (n, outcomes), and the parts of each `Fit` (n, outcomes, 4)."""

    numbers: Floats
    possible: Bools
    fits: Floats


def prior_beliefs(domain: Domain) -> Beliefs:
    """What is believed before any transition was seen."""
    rules = (*range(len(domain.rules)), None)
    priors = {rule: tuple(map(float, prior_probabilities(outcomes_of(domain, rule)))) for rule in rules}
    return Beliefs(priors, {p.name: float(p.probability) for p in domain.parameters}, SlipRates())


def nothing_counted(domain: Domain) -> Counts:
    """That no outcome was seen."""
    return {rule: (0.0,) * len(known) for rule, known in prior_beliefs(domain).probabilities.items()}


def shares(match: Match, beliefs: Beliefs) -> tuple[float, ...]:
    """To how much of a transition each outcome is believed to have led; all 0 where none fits."""
    (found,) = _shares(_group([(match, 1)]), beliefs.probabilities[match.rule], beliefs.slips)
    return tuple(map(float, found))


def likeliest_outcome(match: Match, beliefs: Beliefs) -> int | None:
    """The outcome that a transition was most likely made by, of equals the first; None where none fits."""
    return largest(shares(match, beliefs))


def largest(found: Sequence[float]) -> int | None:
    """The outcome with the largest share, of equals the first; None where none has any."""
    return max(range(len(found)), key=lambda index: found[index]) if any(found) else None


def expected(
    domain: Domain, seen: Weights, estimator: Estimator, m: float, before: Counts, fits_m: bool = False
) -> tuple[Counts, Beliefs]:
    """How often each outcome is expected to have happened, with what was counted before, and what that makes
    of the probabilities. Where it `fits_m`, the prior weighs what it proves to be worth."""
    groups = {rule: _group(found) for rule, found in _by_rule(seen).items()}
    prior = beliefs = prior_beliefs(domain)
    concerned = {
        rule: found for rule, found in before.items() if rule in groups or _has_parameter(domain, rule)
    }
    counts: Counts = {}
    own: Estimators = {}
    priors = _own_priors(domain)
    for _ in range(ROUNDS):
        last = beliefs
        counts, slips = _counted(groups, last, concerned)
        if fits_m:
            own = _fitted(priors, groups, last, {**before, **counts}, before, m)
        beliefs = maximised(domain, prior, counts, slips, estimator, m, own)
        if _difference(beliefs, last) < TOLERANCE:
            break
    # Nothing but fitted weights changes what is believed of the other rules.
    others = maximised(domain, prior, before, beliefs.slips, estimator, m, own)
    probabilities = {**others.probabilities, **beliefs.probabilities}
    return {**before, **counts}, replace(beliefs, probabilities=probabilities)


def told(domain: Domain, counts: Counts, m: float) -> Estimators:
    """Estimators of the rules that counts are of, whose priors weigh what they prove to be worth, where it is
    known which outcome each example was."""
    return _fitted(_own_priors(domain), {}, prior_beliefs(domain), counts, counts, m)


def _own_priors(domain: Domain) -> _OwnPriors:
    found = {}
    for rule, priors in prior_beliefs(domain).probabilities.items():
        outcomes = outcomes_of(domain, rule)
        own = np.array([float(not outcome.fixed and outcome.parameter is None) for outcome in outcomes])
        found[rule] = own, np.array(priors) * own
    return found


def _fitted(
    priors: _OwnPriors,
    groups: Mapping[int | None, _Group],
    beliefs: Beliefs,
    counts: Counts,
    before: Counts,
    m: float,
) -> Estimators:
    """The same of transitions that are shared by what is believed, and that with those `before` make the
    counts."""
    found = {
        rule: _foretold(
            priors[rule], groups.get(rule), beliefs.probabilities[rule], beliefs.slips, seen, before[rule]
        )
        for rule, seen in counts.items()
        if m and any(seen)
    }
    return dict(zip(found, map(averaged, chances_of_weights(list(found.values()), m)), strict=True))


def _foretold(
    priors: tuple[Floats, Floats],
    group: _Group | None,
    believed: Sequence[float],
    slips: SlipRates,
    counts: Sequence[float],
    before: Sequence[float],
) -> Foretold:
    """A rule's examples beside what else was counted: those before, each of one outcome, and transitions."""
    own, priors_of_own = priors
    numbers, shared, likelihoods = np.array(before), np.eye(len(own)), np.eye(len(own))
    if group is not None:
        numbers = np.concatenate([numbers, group.numbers])
        shared = np.vstack([shared, _shares(group, believed, slips)])
        logs = _joint(group, np.ones(len(own)), slips)
        likelihoods = np.vstack([likelihoods, np.exp(logs - _highest(logs))])
    others = np.maximum(np.array(counts) - shared, 0) * own
    return Foretold(numbers * (shared @ own), likelihoods * own, others, priors_of_own)


def _has_parameter(domain: Domain, rule: int | None) -> bool:
    """Whether a rule shares a parameter."""
    return any(outcome.parameter is not None for outcome in outcomes_of(domain, rule))


def log_likelihoods(seen: Weights, beliefs: Beliefs) -> dict[int | None, float]:
    """Of the transitions of each rule, how likely they are by what is believed; minus infinity where no
    outcome explains one."""
    found = {}
    for rule, matches in _by_rule(seen).items():
        group = _group(matches)
        logs = _joint(group, beliefs.probabilities[rule], beliefs.slips)
        found[rule] = float(np.logaddexp.reduce(logs, axis=1) @ group.numbers)
    return found


def likeliest(domain: Domain, seen: Weights, before: Counts) -> Counts:
    """The paper's strict reading: each transition counts for the one outcome that fits it and was the
    likeliest before learning, of equals for the first; with what was counted before."""
    priors = prior_beliefs(domain).probabilities
    counts = {rule: list(found) for rule, found in before.items()}
    for match, number in seen.items():
        fitting = [index for index, fit in enumerate(match.fits) if fit is not None]
        if fitting:
            counts[match.rule][max(fitting, key=lambda index: priors[match.rule][index])] += number
    return {rule: tuple(found) for rule, found in counts.items()}


def maximised(
    domain: Domain,
    prior: Beliefs,
    counts: Counts,
    slips: SlipRates,
    estimator: Estimator,
    m: float,
    own: Estimators = MappingProxyType({}),
) -> Beliefs:
    """What counts make of the probabilities, with what was believed before any of them as the prior. Rules
    may have estimators of their `own`."""
    parameters = learn_parameters(domain, counts, estimator, m)
    probabilities = {}
    for rule, seen in counts.items():
        estimates = estimated(seen, prior.probabilities[rule], own.get(rule, estimator), m)
        probabilities[rule] = shared_out(outcomes_of(domain, rule), estimates, parameters)
    return Beliefs(probabilities, parameters, slips)


def _by_rule(seen: Weights) -> dict[int | None, list[tuple[Match, float]]]:
    """Always in the same order, whichever came first, so that sums are the same to the last digit."""
    found: dict[int | None, list[tuple[Match, float]]] = {}
    for match in sorted(seen, key=_order):
        found.setdefault(match.rule, []).append((match, seen[match]))
    return found


def _order(match: Match) -> tuple[int, tuple[tuple[int, ...], ...]]:
    return -1 if match.rule is None else match.rule, tuple(fit or () for fit in match.fits)


def _group(found: Sequence[tuple[Match, float]]) -> _Group:
    fits = [[fit or Fit() for fit in match.fits] for match, _ in found]
    possible = [[fit is not None for fit in match.fits] for match, _ in found]
    return _Group(
        np.array([number for _, number in found], dtype=float),
        np.array(possible, dtype=bool),
        np.array(fits, dtype=float),
    )


def _shares(group: _Group, probabilities: Sequence[float], slips: SlipRates) -> Floats:
    """To how much of each transition each outcome led (n, outcomes); a row sums to 1, or 0 if none fits."""
    logs = _joint(group, probabilities, slips)
    weights = np.where(group.possible, np.exp(logs - _highest(logs)), 0)
    total = weights.sum(axis=1, keepdims=True)
    shared: Floats = np.divide(weights, total, out=np.zeros_like(weights), where=total > 0)
    return shared


def _highest(logs: Floats) -> Floats:
    """The greatest of each row (n, 1), or 0 where all are minus infinity."""
    highest: Floats = logs.max(axis=1, keepdims=True)
    return np.where(np.isfinite(highest), highest, 0)


def _joint(group: _Group, probabilities: Sequence[float] | Floats, slips: SlipRates) -> Floats:
    """The logarithm of how likely each outcome came about and made each transition (n, outcomes)."""
    rates = np.array([1 - slips.missed, slips.missed, slips.stray, 1 - slips.stray])
    logs = np.log(np.maximum(probabilities, _NEVER)) + group.fits @ np.log(rates)
    return np.where(group.possible, logs, -np.inf)


def _counted(
    groups: Mapping[int | None, _Group], beliefs: Beliefs, before: Counts
) -> tuple[Counts, SlipRates]:
    """Expected counts of all rules beside those before, and the rates of slips that go with them."""
    counts = dict(before)
    parts = np.zeros(len(Fit._fields))
    for rule, group in groups.items():
        seen = _shares(group, beliefs.probabilities[rule], beliefs.slips) * group.numbers[:, None]
        counts[rule] = tuple(float(each) for each in seen.sum(axis=0) + np.array(before[rule]))
        parts += np.einsum("no,nof->f", seen, group.fits)
    hits, misses, strays, quiet = map(float, parts)
    return counts, SlipRates(_rate(misses, hits + misses), _rate(strays, strays + quiet))


def _rate(slips: float, chances: float) -> float:
    before, chances_before = SLIPS_BEFORE
    return (slips + before) / (chances + chances_before)


def _difference(one: Beliefs, other: Beliefs) -> float:
    """By how much any probability or rate differs."""
    changes = [
        abs(now - was)
        for rule, now_all in one.probabilities.items()
        for now, was in zip(now_all, other.probabilities[rule], strict=True)
    ]
    changes.append(abs(one.slips.missed - other.slips.missed))
    changes.append(abs(one.slips.stray - other.slips.stray))
    return max(changes)
