"""Optimism about rules that are not known yet: R-MAX (Brafman and Tennenholtz 2002), for rules as Lang,
Toussaint and Kersting (2012) have it.

The model that is planned with takes an unknown rule to lead to a state that is worth as much as anything can
be. So a plan either is near the best, or leads to where something is learned.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from fractions import Fraction

from cleancli.compiler.lifted_state import StateView
from cleancli.compiler.rewards import least_costs
from cleancli.language.model import (
    Assign,
    Count,
    Domain,
    Horizon,
    Literal,
    Outcome,
    OutcomeKind,
    Problem,
    RewardKind,
    RewardTerm,
    Rule,
    Symbol,
    Unlimited,
    wanted_decreased,
)

OPTIMISM = ("prior", "rmax")
"""What is hoped of rules that are not known yet: what their probabilities say, or the best there is."""

_TRIED, _UNTRIED = "tried!", "untried!"
"""Names that no text can declare."""


def optimistic(domain: Domain, problem: Problem, unknown: Collection[int]) -> Domain:
    """The domain to plan the problem with where some of its rules, by their indices, are not known.

    Each leads to a fact of its own, whose coming true pays once as much as can be got from now on. A rule is
    known if all its outcomes but one at most are fixed. The problem has a horizon: no reward counts without
    one.
    """
    best = most(domain, problem)
    if not unknown or not best:
        return domain
    happy = Outcome(Fraction(1), OutcomeKind.CHANGE, (Assign(_TRIED, (), True),))
    rules = tuple(
        replace(rule, outcomes=(happy,)) if index in unknown and _can_be_learned(rule) else rule
        for index, rule in enumerate(domain.rules)
    )
    return replace(
        domain,
        symbols=(*domain.symbols, Symbol(_TRIED, ())),
        counts=(*domain.counts, Count(_UNTRIED, (), (Literal(_TRIED, (), frozenset({False})),))),
        rules=rules,
        reward=(*domain.reward, RewardTerm(best, RewardKind.DECREASE, _UNTRIED)),
    )


def _can_be_learned(rule: Rule) -> bool:
    return sum(not outcome.fixed for outcome in rule.outcomes) > 1


def most(domain: Domain, problem: Problem) -> Fraction:
    """A bound of the reward that can be got from the problem's state on, whatever actions do.

    What is paid for a decrease comes to no more than the count is now (eq. 2), and for a rise to no more than
    is missing to its greatest value; for the goal once; for a state and by a cost below zero in each step.
    """
    view = StateView(domain, problem.objects, problem.state)
    counts = {count.name: count for count in domain.counts}

    def now(name: str) -> int:
        count = counts[name]
        return sum(1 for _ in view.extensions(count.variables, count.condition, {}))

    def greatest(name: str) -> int:
        return math.prod(len(view.state.objects[variable.type]) for variable in counts[name].variables)

    assert not isinstance(problem.horizon, Unlimited)
    horizon = problem.horizon or Horizon(1, wanted_decreased(domain))
    steps = horizon.constant + (0 if horizon.count is None else now(horizon.count))
    best = steps * max(Fraction(0), *(-cost for cost in least_costs(domain).values()))
    for term in domain.reward:
        match term.kind, term.count:
            case RewardKind.DECREASE, str(name):
                best += term.weight * (now(name) if term.weight > 0 else now(name) - greatest(name))
            case RewardKind.COUNT, str(name):
                best += steps * max(Fraction(0), term.weight) * greatest(name)
            case RewardKind.GOAL, _:
                best += abs(term.weight)
    return best
