"""The next try: here, or on a plan towards a state where something is not known.

As in R-MAX (Brafman and Tennenholtz 2002; through rules Lang, Toussaint and Kersting 2012), a plan takes what
is not known to lead to a state that is worth the most that can be, and all else to do as the rules say.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from cleancli.compiler.fluents import values_of
from cleancli.compiler.ground import ground
from cleancli.compiler.task import GroundAction, without
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import (
    Assign,
    Condition,
    Count,
    Domain,
    Horizon,
    Literal,
    Outcome,
    OutcomeKind,
    Problem,
    Reference,
    RewardKind,
    RewardTerm,
    Rule,
    Symbol,
)
from cleancli.learning.exploration.explored import UNCOVERED, Explored, ExploredAction
from cleancli.learning.exploration.parts import signed
from cleancli.learning.exploration.worth import UNCHANGED, Try, by_rule, least_worth, near, tries
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options, PlanningRefused
from cleancli.planning.planner import Plans

STEPS, DISCOUNT = 10, 0.95
"""Actions of a plan towards what is not known, and what each is worth less than the one before; chosen, the
discount as in §6."""
MOST_HOPES = 10
"""Contexts that a plan may lead to, those that are worth most; chosen."""

Key = tuple[str, tuple[str, ...]]
"""An action's name and its objects."""

_TRIED = "tried!"
_UNITS = 10**6


@dataclass(frozen=True, slots=True)
class Hope:
    """A context in which it is not known what an action does, and what it is worth to try it there."""

    action: str
    condition: Condition
    references: tuple[Reference, ...]
    worth: float


def next_try(
    found: Explored,
    problem: Problem,
    known: int,
    planner: Plans,
    asked: Options,
    excluded: Collection[Key] = (),
) -> Try | None:
    """What to do next to learn: None where all that can be reached, as far as the rules say and the planner
    sees, is known by so many examples (eq. 6). Ties are drawn by the seed that is `asked` for."""
    rng = np.random.default_rng(asked.seed)
    everything = tries(found, problem.objects, values_of(problem.state), rng)
    here = [each for each in everything if (each.action, each.objects) not in excluded]
    least = least_worth(known)
    draws = rng.random(len(here))
    best = max(zip(here, draws, strict=True), key=lambda each: (each[0].worth, each[1]), default=(None, 0.0))[
        0
    ]
    worth = 0.0 if best is None or best.worth < least else best.worth
    hopes = [each for each in hopes_of(found) if each.worth >= least and each.worth * DISCOUNT > worth]
    hopes.sort(key=lambda each: -each.worth)
    on_the_way = _planned(found.domain, problem, hopes[:MOST_HOPES], planner, asked, excluded)
    if on_the_way is not None and on_the_way.worth >= worth:
        return on_the_way
    return best if worth else None


def hopes_of(found: Explored) -> Iterator[Hope]:
    """The contexts that plans may lead to: those of rules; where one holds and something does not that held
    each time that it changed anything; and where something holds that an action which has changed nothing
    was seldom seen with."""
    feasible = {action.name for action in found.domain.actions}
    for known in (known for name, known in found.actions.items() if name in feasible):
        for number, rule in enumerate(known.rules):
            yield Hope(rule.action, rule.condition, rule.references, by_rule(known, number))
            yield from _near(found.domain, known, number)
        if all(each.rule == UNCOVERED for each in known.specific):
            for column, count in enumerate(known.held.sum(axis=0)):
                condition = (signed(found.domain, known.parts, column),)
                yield Hope(known.action.name, condition, (), UNCHANGED / (int(count) + 1) ** 2)


def _near(domain: Domain, known: ExploredAction, number: int) -> Iterator[Hope]:
    """A rule's context without one part that held each time that it changed anything."""
    rule = known.rules[number]
    own = known.held[known.by == number]
    for specific in known.specific:
        if specific.rule == number:
            inside = specific.covers(known.held)
            for column in np.flatnonzero(specific.holds):
                without_it = int((~own[:, column]).sum())
                opposite = signed(
                    domain, known.parts, (int(column) + len(known.parts)) % (2 * len(known.parts))
                )
                condition = (*rule.condition, opposite)
                yield Hope(rule.action, condition, rule.references, near(known, inside, without_it))


def _planned(
    domain: Domain,
    problem: Problem,
    hopes: Sequence[Hope],
    planner: Plans,
    asked: Options,
    excluded: Collection[Key],
) -> Try | None:
    """The first action of a plan towards what is hoped for, if there is one."""
    if not hopes:
        return None
    hoping = optimistic(domain, hopes)
    towards = replace(problem, goal=(), horizon=Horizon(STEPS), discount=DISCOUNT)
    try:
        task = ground(hoping, towards)
        barred = [action.key for action in task.actions if _real(action).key in excluded]
        plan = planner(prepare(without(task, frozenset(barred))), asked)
    except (Refused, PlanningRefused):
        return None  # It is no mistake of a user's that rules under way cannot be planned with.
    if not plan.actions:
        return None
    return Try(*_real(plan.actions[0]).key, plan.value)


def _real(action: GroundAction) -> GroundAction:
    return replace(action, name=action.name.partition("!")[0])


def optimistic(domain: Domain, hopes: Sequence[Hope]) -> Domain:
    """The domain with an action more for each hope, which leads to a state in which all is got that it is
    worth; only the first counts, and nothing else is paid for."""
    tried = Literal(_TRIED, (), frozenset({False}))
    bests = [f"best!{number}" for number in range(len(hopes))]
    actions = {action.name: action for action in domain.actions}
    rules, reward, counts = [], [], []
    for number, (hope, best) in enumerate(zip(hopes, bests, strict=True)):
        name, variables = f"{hope.action}!{number}", actions[hope.action].parameters
        effects = (Assign(_TRIED, (), True), Assign(best, (), True))
        outcome = Outcome(Fraction(1), OutcomeKind.CHANGE, effects)
        rules.append(Rule(name, name, variables, (*hope.condition, tried), (outcome,), hope.references))
        counts.append(Count(f"un{best}", (), (Literal(best, (), frozenset({False})),)))
        worth = Fraction(round(hope.worth * _UNITS), _UNITS)
        reward.append(RewardTerm(worth, RewardKind.DECREASE, f"un{best}"))
    new = (replace(actions[hope.action], name=rule.action) for hope, rule in zip(hopes, rules, strict=True))
    return replace(
        domain,
        symbols=(*domain.symbols, *(Symbol(name, ()) for name in (_TRIED, *bests))),
        counts=(*domain.counts, *counts),
        actions=(*domain.actions, *new),
        rules=(*domain.rules, *rules),
        reward=tuple(reward),
    )
