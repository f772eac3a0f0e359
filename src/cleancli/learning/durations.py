"""How long actions take, from how long they took (§5)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from statistics import stdev

from cleancli.language.model import Action, Domain
from cleancli.learning.estimate import decreasing_m_estimate
from cleancli.learning.share import counted

PRIOR_WEIGHT = 1.0
"""Executions that a stated duration weighs as much as, divided by the root of their number as in eq. 5.
Chosen: an action takes about as long each time, so that one execution tells more than a guess does."""

DIGITS = 3
"""Significant digits of a learned duration in the text."""

Times = tuple[tuple[str, tuple[int, ...]], ...]
"""By the action's name, the milliseconds that each execution took, in turn."""


Estimates = tuple[tuple[str, tuple[tuple[int, int], ...]], ...]
"""By the action's name, the milliseconds that each execution took, beside those that were expected, in
turn."""


@dataclass(frozen=True, slots=True)
class LearnedCorrection:
    """By how much longer an action takes than is expected for its objects where they lie, how many executions
    count, and the standard deviation of what they took in proportion."""

    action: str
    factor: float
    seen: Fraction
    spread: float


def learn_corrections(estimates: Estimates, forgetting: float = 0.0) -> tuple[LearnedCorrection, ...]:
    """Of each action of which something was expected: eq. 5 of the ratios, with 1 as the prior."""
    return tuple(
        _corrected(name, [took / each for took, each in pairs], forgetting) for name, pairs in estimates
    )


def _corrected(action: str, ratios: Sequence[float], forgetting: float) -> LearnedCorrection:
    weights = _weights(len(ratios), forgetting)
    total = sum(weight * ratio for weight, ratio in zip(weights, ratios, strict=True))
    factor = decreasing_m_estimate(total, sum(weights), 1.0, PRIOR_WEIGHT)
    return LearnedCorrection(action, factor, counted(sum(weights)), stdev(ratios) if len(ratios) > 1 else 0.0)


def _weights(number: int, forgetting: float) -> list[float]:
    """What executions in turn count for: the last one for one."""
    return [(1 - forgetting) ** age for age in range(number - 1, -1, -1)]


@dataclass(frozen=True, slots=True)
class LearnedDuration:
    """Seconds that an action is believed to take, those that were stated before anything was timed, how many
    executions count, and the standard deviation of those that it took."""

    action: str
    prior: float
    seconds: float
    seen: Fraction
    spread: float


def learn_durations(
    domain: Domain, times: Times, adding: bool, forgetting: float = 0.0
) -> tuple[LearnedDuration, ...]:
    """Of each action that states a duration, is not fixed and was timed; where `adding`, what the domain's
    text has counted counts on. With `forgetting` each execution counts for less by that share than the one
    after it."""
    return tuple(_learned(domain, dict(times), adding, forgetting))


def _learned(
    domain: Domain, times: Mapping[str, tuple[int, ...]], adding: bool, forgetting: float
) -> Iterator[LearnedDuration]:
    for action in domain.actions:
        timed = times.get(action.name, ())
        if action.duration is None or action.duration_fixed or not timed:
            continue
        prior = action.duration if action.duration_prior is None else action.duration_prior
        kept = (1 - forgetting) ** len(timed)
        before, total = _timed_before(action, prior) if adding else (0.0, 0.0)
        weights = _weights(len(timed), forgetting)
        number = sum(weights) + kept * before
        spent = sum(weight * each for weight, each in zip(weights, timed, strict=True)) / 1000
        seconds = decreasing_m_estimate(spent + kept * total, number, prior, PRIOR_WEIGHT)
        yield LearnedDuration(action.name, prior, _rounded(seconds), counted(number), _spread(timed))


def _spread(timed: Sequence[int]) -> float:
    """The standard deviation in seconds; 0 of fewer than two."""
    return stdev(timed) / 1000 if len(timed) > 1 else 0.0


def _timed_before(action: Action, prior: float) -> tuple[float, float]:
    """How often the text has timed an action, and the sum of the seconds that it was learned from."""
    number = float(action.duration_seen or 0)
    if not number or action.duration is None:
        return 0.0, 0.0
    weight = PRIOR_WEIGHT / math.sqrt(number)
    return number, action.duration * (number + weight) - weight * prior


def _rounded(seconds: float) -> float:
    """To some digits, and to at least a millisecond."""
    if seconds < 0.001:
        return 0.001
    return round(seconds, DIGITS - 1 - math.floor(math.log10(seconds)))
