"""The reward of a domain over the variables of a task: what ends or holds, and what it pays.

Guaranteed by the checker: counts that reward and horizon name are declared, and a reward without a decrease
comes with a horizon.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from cleancli.compiler.disjoint_cases import CASE_LIMIT
from cleancli.compiler.encoding import Numbering
from cleancli.compiler.ground_formula import Formula, Known, disjoint
from cleancli.compiler.instances import closure_refused
from cleancli.compiler.partial_evaluation import ClosureTooLargeError, Conditions
from cleancli.compiler.prices import most
from cleancli.compiler.task import (
    GroundCondition,
    Objective,
    RewardCondition,
    condition_order,
    held,
    in_seconds,
)
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import (
    Count,
    Domain,
    Horizon,
    Price,
    Problem,
    RewardKind,
    Unlimited,
    wanted_decreased,
    weight_of,
)


@dataclass(frozen=True, slots=True)
class Rewards:
    """A task's reward, but for what actions cost; the fields are those of `Task`."""

    rewards: tuple[RewardCondition, ...]
    constant_reward: Fraction
    goal: tuple[GroundCondition, ...]
    counted: tuple[GroundCondition, ...] | None
    lengthening: tuple[GroundCondition, ...]
    horizon: int


def rewards_of(
    domain: Domain, problem: Problem, conditions: Conditions, numbering: Numbering, known: Known
) -> Rewards:
    """The reward, the goal and the horizon of a problem. Raises `Refused` (E605, E606)."""
    counts = {c.name: _counted(c, conditions, numbering, known) for c in domain.counts}
    goal = _goal(problem, conditions, numbering, known)
    decrease: dict[GroundCondition, Fraction] = defaultdict(Fraction)
    state: dict[GroundCondition, Fraction] = defaultdict(Fraction)
    for term in domain.reward:
        weight = term.weight
        match term.kind:
            case RewardKind.DECREASE:
                for condition in counts[_name(term.count)]:
                    decrease[condition] += weight
            case RewardKind.COUNT:
                for condition in counts[_name(term.count)]:
                    state[condition] += weight
            case RewardKind.GOAL:
                for condition in goal:
                    decrease[condition] -= weight
            case RewardKind.COST | RewardKind.DURATION:
                pass  # is paid by the action
    decreasing = wanted_decreased(domain)
    horizon = Horizon(0) if isinstance(problem.horizon, Unlimited) else problem.horizon
    horizon = horizon or Horizon(1, decreasing)
    lengthening = () if horizon.count is None else counts[horizon.count]
    return Rewards(
        rewards=tuple(
            RewardCondition(condition, decrease[condition], state[condition])
            for condition in sorted({*decrease, *state}, key=condition_order)
            if condition and (decrease[condition] or state[condition])
        ),
        constant_reward=state[()],
        goal=goal,
        counted=None if decreasing is None else counts[decreasing],
        lengthening=lengthening,
        horizon=horizon.constant + held(lengthening, numbering.initial),
    )


def waiting_can_pay(domain: Domain) -> bool:
    """Whether a step that changes nothing can be worth taking before others: a state is paid for what it is,
    a decrease or the goal has a negative weight, or an action earns by its cost, or by what its outcome pays.

    Otherwise what is done later is worth no more than done now, so that waiting gains nothing.
    """
    kinds = (RewardKind.DECREASE, RewardKind.GOAL)
    return any(
        (term.kind is RewardKind.COUNT and term.weight != 0) or (term.kind in kinds and term.weight < 0)
        for term in domain.reward
    ) or any(cost < 0 for cost in least_costs(domain).values())


def costs_of(domain: Domain) -> dict[str, Fraction]:
    """What each action costs whatever its objects, with its declared duration, in units of the reward that a
    step loses by it."""
    weight, price = weight_of(domain, RewardKind.COST), price_of(domain)
    return {
        action.name: -weight * action.cost.number + price * in_seconds(action.duration)
        for action in domain.actions
    }


def least_costs(domain: Domain) -> dict[str, Fraction]:
    """As `costs_of`, the least that each action may cost, whatever values the functions have and whichever
    outcome happens."""
    weight, least = weight_of(domain, RewardKind.COST), costs_of(domain)
    ends = dict(_ends(domain))
    for action in domain.actions:
        earned = [Fraction(0)]
        for rule in domain.rules:
            if rule.action == action.name:
                earned += [most(each.reward + each.cost.times(weight), ends) for each in rule.outcomes]
        by_objects = Price(parts=action.cost.parts).times(weight)
        least[action.name] -= most(by_objects, ends) + max(earned)
    return least


def _ends(domain: Domain) -> Iterator[tuple[str, tuple[int, int]]]:
    """The least and the greatest value of each function that has integers."""
    for symbol in domain.symbols:
        low, high = symbol.values[0], symbol.values[-1]
        if isinstance(low, int) and isinstance(high, int):
            yield symbol.name, (low, high)


def price_of(domain: Domain) -> Fraction:
    """What a second of an action costs, in units of the reward that a step loses by it."""
    return -weight_of(domain, RewardKind.DURATION)


def usual_objective(domain: Domain, problem: Problem) -> Objective:
    """What a plan is to be best by where nothing else is asked for: the reward, and without a horizon costs
    where the domain has some, or else how many actions it takes."""
    if not isinstance(problem.horizon, Unlimited):
        return Objective.REWARD
    outcomes = (outcome for rule in domain.rules for outcome in rule.outcomes)
    costly = any(action.cost for action in domain.actions) or any(each.cost for each in outcomes)
    return Objective.COST if costly else Objective.PROBABILITY


def _name(count: str | None) -> str:
    assert count is not None, "the checker lets no such term without a count pass"
    return count


def _counted(
    count: Count, conditions: Conditions, numbering: Numbering, known: Known
) -> tuple[GroundCondition, ...]:
    """Conditions of which as many hold as bindings of the count do; equal ones stand there as often."""
    found: list[GroundCondition] = []
    try:
        for _, formula in conditions.extensions(count.variables, count.condition, {}):
            found += _exclusive(formula, numbering, known, f"the count `{count.name}`")
    except ClosureTooLargeError as error:
        raise Refused([closure_refused(error, None, f"in the count `{count.name}`")]) from None
    return tuple(sorted(found, key=condition_order))


def _goal(
    problem: Problem, conditions: Conditions, numbering: Numbering, known: Known
) -> tuple[GroundCondition, ...]:
    """Conditions that exclude each other and of which one holds where the goal does."""
    if not problem.goal:
        return ()
    try:
        formula = conditions.formula(problem.goal, {})
    except ClosureTooLargeError as error:
        raise Refused([closure_refused(error, None, "in the goal")]) from None
    return () if formula is None else _exclusive(formula, numbering, known, "the goal")


def _exclusive(
    formula: Formula, numbering: Numbering, known: Known, what: str
) -> tuple[GroundCondition, ...]:
    found = list(itertools.islice(disjoint(formula, known), CASE_LIMIT + 1))
    if len(found) > CASE_LIMIT:
        message = f"{what} falls into more than {CASE_LIMIT:,} cases"
        help = "ask for less at once, take fewer objects, or leave to the facts what does not change"
        raise Refused([Diagnostic("E605", message, None, help=help)])
    return tuple(sorted((numbering.condition(required) for required in found), key=condition_order))
