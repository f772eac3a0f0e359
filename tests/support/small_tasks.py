"""The domain of §4 as text, and random tasks."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from cleancli.compiler.task import (
    GroundAction,
    GroundOutcome,
    GroundRule,
    RewardCondition,
    StateVariable,
    Task,
    by_time,
)
from cleancli.language.model import OutcomeKind

SECTION_4 = """
domain d {
  types      { area }
  predicates { dirt(?a - area) scattered(?a - area) }
  derived    { dirty := count ?a - area: dirt(?a) }
  actions    { clean(?a - area) join(?a ?b - area) }
  rule clean_scattered: clean(?a) { when dirt(?a), scattered(?a) then 0.5: not dirt(?a) rest: nothing }
  rule clean_compact: clean(?a) { when dirt(?a), not scattered(?a) then 0.8: not dirt(?a) rest: nothing }
  rule join: join(?a, ?b) {
    when dirt(?a), dirt(?b), ?a != ?b
    then 0.3: not dirt(?a), scattered(?b)
         0.2: not dirt(?a), not scattered(?b)
         0.5: nothing
  }
  default { 1: nothing }
  reward { decrease(dirty) }
}
"""

TWO_SCATTERED = "objects { a b - area } init { dirt(a), dirt(b), scattered(a), scattered(b) }"


def action(task: Task, text: str) -> int:
    """The index of an action written like `join(a, b)`."""
    return [str(a) for a in task.actions].index(text)


def decrease(*condition: tuple[int, frozenset[int]]) -> RewardCondition:
    """A condition that pays 1 when it ends."""
    return RewardCondition(condition, Fraction(1), Fraction(0))


def random_task(seed: int) -> Task:
    """A task of 5 variables and 6 actions; an action has one rule per value of some variable."""
    rng = np.random.default_rng(seed)
    sizes = [int(n) for n in rng.integers(2, 4, size=5)]
    variables = tuple(StateVariable("v", (str(i),), tuple("abc"[:n])) for i, n in enumerate(sizes))
    rules = []
    for action in range(6):
        pivot = int(rng.integers(5))
        for value in range(sizes[pivot]):
            other = int(rng.integers(5))
            condition = {pivot: frozenset({value})}
            condition.setdefault(other, frozenset(range(sizes[other] - 1)))
            rules.append(GroundRule(0, action, tuple(sorted(condition.items())), _outcomes(rng, sizes)))
    return Task(
        variables=variables,
        initial=tuple(int(rng.integers(n)) for n in sizes),
        actions=tuple(GroundAction(f"act{i}", (), None) for i in range(6)),
        rules=tuple(rules),
        rewards=(
            *(decrease((v, frozenset({0}))) for v in range(4)),
            decrease((0, frozenset({0})), (4, frozenset({0}))),
            decrease((1, frozenset({1})), (2, frozenset({0, 1}))),
        ),
        constant_reward=Fraction(0),
        goal=(),
        counted=(((0, frozenset(range(3))),),) * 4,
        lengthening=(),
        horizon=5,
        discount=0.9,
        discounts=(0.9,) * 6,
        step=None,
        untimed=tuple(f"act{i}" for i in range(6)),
        waiting=False,
    )


def timed(task: Task) -> Task:
    """The same, discounted by time: its actions last 1 s, 2 s and so on, and all of them set the pace."""
    seconds = [float(index + 1) for index in range(len(task.actions))]
    actions = tuple(replace(a, duration=s) for a, s in zip(task.actions, seconds, strict=True))
    return by_time(replace(task, actions=actions, step=sum(seconds) / len(seconds), untimed=()))


def weighted_task(seed: int) -> Task:
    """The same with costs, with weights, and with conditions that are paid while they hold, so that waiting
    is a choice."""
    task = random_task(seed)
    rng = np.random.default_rng([seed, 1])
    rewards = [
        replace(r, decrease=Fraction(rng.normal()), state=Fraction(rng.normal()) * (index % 2))
        for index, r in enumerate(task.rewards)
    ]
    actions = [replace(a, cost=Fraction(rng.uniform(0, 0.3))) for a in task.actions]
    return replace(
        task,
        rewards=tuple(rewards),
        actions=tuple(actions),
        constant_reward=Fraction(rng.normal()),
        waiting=True,
    )


def costly_task(seed: int) -> Task:
    """A random task with costs and nothing that is paid while it holds: waiting before an action gains
    nothing."""
    task = random_task(seed)
    rng = np.random.default_rng([seed, 2])
    return replace(task, actions=tuple(replace(a, cost=Fraction(rng.uniform(0, 0.1))) for a in task.actions))


def _outcomes(rng: np.random.Generator, sizes: list[int]) -> tuple[GroundOutcome, ...]:
    tenths = rng.multinomial(10, [0.3, 0.3, 0.2, 0.2])
    outcomes = []
    for index, share in enumerate(tenths):
        chosen = sorted(rng.choice(len(sizes), size=2, replace=False)) if index < 2 else []
        effects = tuple((int(v), int(rng.integers(sizes[v]))) for v in chosen)
        kind = OutcomeKind.CHANGE if effects else OutcomeKind.NOISE
        outcomes.append(GroundOutcome(Fraction(int(share), 10), kind, effects))
    return tuple(outcomes)
