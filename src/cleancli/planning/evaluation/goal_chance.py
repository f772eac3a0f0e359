"""How likely a policy, or a sequence, comes to the goal within the horizon."""

from __future__ import annotations

import functools
import math
from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from cleancli.compiler.semantics import reaches_goal, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.planning.policy import Place, Policy

PLACES = 20_000
"""The distribution over a policy's places is followed while all steps have so many together: some tenths of a
second. Chosen."""

RUNS = 2_000
"""Runs that are drawn otherwise; the probability is then right to 0.011 (one standard error). Chosen."""

ODDS_SEED = 7
"""The runs have random numbers of their own, apart from those of planners. Chosen."""


@dataclass(frozen=True, slots=True)
class GoalChance:
    """The probability that the goal holds at some time up to the horizon, where an episode would end. Of so
    many `runs` that were drawn it is the share, and `error` its standard error; exact where they are None."""

    probability: float
    error: float
    runs: int | None


def goal_chance(task: Task, policy: Policy, seed: int) -> GoalChance:
    """The chance of the goal for a policy of a task with a horizon. The seed is that of the runs."""
    exact = _exact(task, policy)
    if exact is not None:
        return GoalChance(exact, 0.0, None)
    rng = np.random.default_rng([seed % 2**64, ODDS_SEED])
    share = sum(_reaches(task, policy, rng) for _ in range(RUNS)) / RUNS
    return GoalChance(share, math.sqrt(share * (1 - share) / RUNS), RUNS)


def _exact(task: Task, policy: Policy) -> float | None:
    """By the distribution over places after each step; None where they are too many."""

    @functools.cache
    def following(state: GroundState, action: int) -> tuple[tuple[float, GroundState], ...]:
        return successors(task, state, action)

    chance, places, spread = 0.0, 0, {policy.start: 1.0}
    while spread:
        places += len(spread)
        if places > PLACES:
            return None
        ahead: dict[Place, float] = defaultdict(float)
        for place, mass in spread.items():
            if reaches_goal(task, place.state):
                chance += mass
            elif place.action >= 0:
                for probability, after in following(place.state, place.action):
                    ahead[policy.after(place, after)] += mass * probability
        spread = ahead
    return min(chance, 1.0)


def _reaches(task: Task, policy: Policy, rng: np.random.Generator) -> bool:
    """Whether a drawn run comes to the goal."""
    place = policy.start
    while not reaches_goal(task, place.state):
        if place.action < 0:
            return False
        results = successors(task, place.state, place.action)
        drawn = rng.choice(len(results), p=[probability for probability, _ in results])
        place = policy.after(place, results[drawn][1])
    return True
