"""What many episodes of a planner come to: means and shares, each with its 95 % confidence interval."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.special import stdtrit

from cleancli.simulation.episode import Episode, Reason
from cleancli.statistics.shares import wilson

LEVEL = 0.95


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean or share with its interval; without one (both None) where there is but a single episode."""

    mean: float
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class Summary:
    """Of one planner. `success` is None where the problem has neither goal nor count to decrease, `seconds`
    where a duration is not declared; `gain` is the discounted return less that of the first planner, episode
    by episode, None for the first. Planning seconds are per plan."""

    planner: str
    episodes: int
    discounted: Estimate
    plain: Estimate
    gain: Estimate | None
    actions: Estimate
    cost: Estimate
    seconds: Estimate | None
    success: Estimate | None
    planning_median: float | None
    planning_95: float | None
    reasons: Mapping[Reason, int]


def summarized(planner: str, episodes: Sequence[Episode], first: Sequence[Episode] | None) -> Summary:
    """The summary of a planner's episodes; `first` are those of the planner to compare with, in order."""
    reasons = Counter(episode.reason for episode in episodes)
    planning = [seconds for episode in episodes for seconds in episode.planning]
    return Summary(
        planner=planner,
        episodes=len(episodes),
        discounted=mean_of([episode.discounted for episode in episodes]),
        plain=mean_of([episode.plain for episode in episodes]),
        gain=None if first is None else _gain(episodes, first),
        actions=mean_of([float(len(episode.actions)) for episode in episodes]),
        cost=mean_of([episode.cost for episode in episodes]),
        seconds=_seconds(episodes),
        success=_success(episodes),
        planning_median=_quantile(planning, 0.5),
        planning_95=_quantile(planning, 0.95),
        reasons={reason: reasons[reason] for reason in Reason if reasons[reason]},
    )


def _gain(episodes: Sequence[Episode], first: Sequence[Episode]) -> Estimate:
    pairs = zip(episodes, first, strict=True)
    return mean_of([episode.discounted - other.discounted for episode, other in pairs])


def _seconds(episodes: Sequence[Episode]) -> Estimate | None:
    seconds = [episode.seconds for episode in episodes if episode.seconds is not None]
    return mean_of(seconds) if len(seconds) == len(episodes) else None


def _success(episodes: Sequence[Episode]) -> Estimate | None:
    successes = [episode.success for episode in episodes if episode.success is not None]
    return share_of(sum(successes), len(successes)) if successes else None


def _quantile(values: Sequence[float], share: float) -> float | None:
    return float(np.quantile(values, share)) if values else None


def mean_of(values: Sequence[float]) -> Estimate:
    """The mean with Student's t interval; at least one value."""
    mean, number = float(np.mean(values)), len(values)
    if number == 1:
        return Estimate(mean, None, None)
    half = float(stdtrit(number - 1, (1 + LEVEL) / 2)) * float(np.std(values, ddof=1)) / sqrt(number)
    return Estimate(mean, mean - half, mean + half)


def share_of(successes: int, number: int) -> Estimate:
    """A share with its interval."""
    return Estimate(successes / number, *wilson(successes, number))
