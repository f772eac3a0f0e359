"""What is expected of a sequence of actions, step by step.

From the exact distribution over states while it has few, and otherwise from rollouts.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.compiler.lowering.state_tables import Process
from cleancli.compiler.semantics import SupportTooLargeError
from cleancli.compiler.task import GroundCondition, Task
from cleancli.language.model import OutcomeKind
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.evaluation.state_distribution import (
    Spread,
    branched,
    certain,
    covering,
    drawn,
    marginals,
    paying,
    spent,
)

FEW_STATES = 10_000
"""An exact distribution has at most so many states: a step then takes some ten milliseconds. Chosen."""

RUNS = 10_000
"""Runs that are drawn otherwise; a probability is then right to 0.005 (one standard error). Chosen."""

Effects = tuple[tuple[int, int], ...]
"""Pairs (variable, value index) that an outcome sets; empty where it changes nothing."""


@dataclass(frozen=True, slots=True)
class Result:
    """What a step may come to: outcomes with these effects, of whichever rule, and their probability."""

    probability: float
    kind: OutcomeKind
    effects: Effects


@dataclass(frozen=True, slots=True)
class ForecastStep:
    """One step, from what is expected before it: `covered` is the probability that a rule of the action
    covers the state, `rules` pairs (index in the domain, probability), likeliest first, as `results` are.

    `reward` is not discounted; `remaining` is the count that the reward wants decreased, after the step, None
    where there is none. `goal`: the probability that the goal holds after the step.
    """

    action: int
    covered: float
    rules: tuple[tuple[int, float], ...]
    reward: float
    results: tuple[Result, ...]
    remaining: float | None
    goal: float


@dataclass(frozen=True, slots=True)
class Forecast:
    """The steps of a sequence. `runs` were drawn; None where the distribution is exact.

    `remaining` is that before the first step. `marginals` (steps + 1, S) are the probabilities of each value
    of each variable, before the first step and after each.
    """

    runs: int | None
    remaining: float | None
    steps: tuple[ForecastStep, ...]
    marginals: Floats


def forecast(
    prepared: Prepared, actions: Sequence[int], seed: int, *, states: int = FEW_STATES, runs: int = RUNS
) -> Forecast:
    """What each of the actions, given by index, is expected to do; whatever happens, all are done."""
    try:
        return _forecast(prepared, exact_course(prepared, actions, states), actions, None)
    except SupportTooLargeError:
        return _forecast(prepared, drawn_course(prepared, actions, seed, runs), actions, runs)


def exact_course(prepared: Prepared, actions: Sequence[int], limit: int) -> list[Spread]:
    """The exact distribution before the first action and after each.

    Raises `SupportTooLargeError` where one has more than `limit` states.
    """
    course = [certain(prepared.task.initial)]
    for action in actions:
        course.append(branched(prepared.process, course[-1], action, limit))
    return course


def drawn_course(prepared: Prepared, actions: Sequence[int], seed: int, runs: int) -> list[Spread]:
    """So many drawn states before the first action and after each."""
    rng = np.random.default_rng(seed)
    course = [certain(prepared.task.initial, runs)]
    for action in actions:
        course.append(drawn(prepared.process, course[-1], action, rng.random(runs)))
    return course


def _forecast(
    prepared: Prepared, course: Sequence[Spread], actions: Sequence[int], runs: int | None
) -> Forecast:
    task, p = prepared.task, prepared.process
    counts = [_counted(task, spread) for spread in course]
    paid = [paying(p, spread) for spread in course]
    steps = tuple(
        _step(
            task,
            p,
            course[i],
            action,
            reward=paid[i][0] - paid[i + 1][0] + paid[i + 1][1] - spent(p, course[i], action),
            remaining=counts[i + 1],
            goal=_goal(task, course[i + 1]),
        )
        for i, action in enumerate(actions)
    )
    return Forecast(runs, counts[0], steps, np.array([marginals(p, spread) for spread in course]))


def _step(
    task: Task,
    p: Process,
    before: Spread,
    action: int,
    *,
    reward: float,
    remaining: float | None,
    goal: float,
) -> ForecastStep:
    rule = covering(p, before.states, action)
    chance = np.bincount(rule + 1, before.weights, minlength=len(task.rules) + 1)[1:]
    rules: Counter[int] = Counter()
    found: dict[tuple[OutcomeKind, Effects], float] = defaultdict(float)
    for r in np.flatnonzero(chance):
        rules[task.rules[r].rule] += chance[r]
        for outcome in task.rules[r].outcomes:
            found[outcome.kind, outcome.effects] += float(chance[r]) * float(outcome.probability)
    results = [Result(p, kind, effects) for (kind, effects), p in found.items() if p > 0]
    return ForecastStep(
        action=action,
        covered=min(float(chance.sum()), 1.0),
        rules=tuple(sorted(((r, float(p)) for r, p in rules.items()), key=lambda pair: (-pair[1], pair[0]))),
        reward=reward,
        results=tuple(sorted(results, key=lambda r: (-r.probability, r.kind.value, r.effects))),
        remaining=remaining,
        goal=goal,
    )


def _counted(task: Task, spread: Spread) -> float | None:
    """The expected number of counted conditions that hold; None where the reward decreases no count."""
    if task.counted is None:
        return None
    return sum(float(spread.weights @ _holding(condition, spread)) for condition in task.counted)


def _goal(task: Task, spread: Spread) -> float:
    """The probability that the goal holds; 0 without one."""
    holds = np.zeros(len(spread.states), dtype=np.bool_)
    for condition in task.goal:
        holds |= _holding(condition, spread)
    return float(spread.weights @ holds)


def _holding(condition: GroundCondition, spread: Spread) -> Bools:
    """In which states a condition holds."""
    fits = np.ones(len(spread.states), dtype=np.bool_)
    for variable, allowed in condition:
        fits &= np.isin(spread.states[:, variable], sorted(allowed))
    return fits
