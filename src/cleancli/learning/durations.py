"""How long actions take, from how long they took (§5)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from cleancli.language.model import Action, Domain
from cleancli.learning.estimate import decreasing_m_estimate

PRIOR_WEIGHT = 1.0
"""Executions that a stated duration weighs as much as, divided by the root of their number as in eq. 5.
Chosen: an action takes about as long each time, so that one execution tells more than a guess does."""

DIGITS = 3
"""Significant digits of a learned duration in the text."""


class Timed(NamedTuple):
    """How often an action was timed; the sum of its milliseconds, and of their squares. Whole numbers, so
    that the order in which they are added changes no digit."""

    number: int = 0
    total: int = 0
    squares: int = 0

    def __or__(self, other: Timed) -> Timed:
        """Both together."""
        return Timed(self.number + other.number, self.total + other.total, self.squares + other.squares)

    @property
    def spread(self) -> float:
        """The standard deviation in seconds; 0 of fewer than two."""
        if self.number < 2:
            return 0.0
        variance = Fraction(self.squares) - Fraction(self.total**2, self.number)
        return math.sqrt(variance / (self.number - 1)) / 1000


Times = Mapping[str, Timed]
"""By the action's name."""


def once(milliseconds: int) -> Timed:
    """One execution."""
    return Timed(1, milliseconds, milliseconds**2)


def together(one: Times, other: Times) -> dict[str, Timed]:
    """All that was timed of each action."""
    return {name: one.get(name, Timed()) | other.get(name, Timed()) for name in (*one, *other)}


@dataclass(frozen=True, slots=True)
class LearnedDuration:
    """Seconds that an action is believed to take, those that were stated before anything was timed, and the
    standard deviation of those that it took."""

    action: str
    prior: float
    seconds: float
    seen: int
    spread: float


def learn_durations(domain: Domain, times: Times, adding: bool) -> tuple[LearnedDuration, ...]:
    """Of each action that states a duration, is not fixed and was timed; where `adding`, what the domain's
    text has counted counts on."""
    return tuple(_learned(domain, times, adding))


def _learned(domain: Domain, times: Times, adding: bool) -> Iterator[LearnedDuration]:
    for action in domain.actions:
        timed = times.get(action.name, Timed())
        if action.duration is None or action.duration_fixed or not timed.number:
            continue
        prior = action.duration if action.duration_prior is None else action.duration_prior
        before, total = _counted(action, prior) if adding else (0, 0.0)
        number = timed.number + before
        mean = (timed.total / 1000 + total) / number
        seconds = decreasing_m_estimate(number * mean, number, prior, PRIOR_WEIGHT)
        yield LearnedDuration(action.name, prior, _rounded(seconds), number, timed.spread)


def _counted(action: Action, prior: float) -> tuple[int, float]:
    """How often the text has timed an action, and the sum of the seconds that it was learned from."""
    number = round(action.duration_seen or 0)
    if not number or action.duration is None:
        return 0, 0.0
    weight = PRIOR_WEIGHT / math.sqrt(number)
    return number, action.duration * (number + weight) - weight * prior


def _rounded(seconds: float) -> float:
    """To some digits, and to at least a millisecond."""
    if seconds < 0.001:
        return 0.001
    return round(seconds, DIGITS - 1 - math.floor(math.log10(seconds)))
