"""The symbolic world: what truly happens to the facts of a problem when an action is done.

Its rules may be other than a planner's. All that is paid, lasts or discounts is the world's too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from cleancli.compiler.fluents import Fluent, values_of
from cleancli.compiler.ground import ground
from cleancli.compiler.prices import by_functions
from cleancli.compiler.rewards import costs_of
from cleancli.compiler.semantics import covering_rule, payment, reaches_goal, reward, sample
from cleancli.compiler.task import GroundAction, GroundState, Task, by_time, held, is_unreachable
from cleancli.language.model import Action, Domain, Fact, Problem, RewardKind, State, weight_of


@dataclass(frozen=True, slots=True)
class World:
    """A problem under the rules that hold. After the grounded actions, `task` lists each declared action once
    more, without rules: it stands for the groundings that can change nothing, and says what they cost, but
    for what functions say (`priced` holds the actions of which they do; in the reward a cost counts
    `cost_weight` times). `numbers` are the indices of the grounded actions, `idle` those of the others, by
    name. `rest` are the facts that never change. What comes a second later is worth `second_discount` times
    as much (1 where steps discount)."""

    task: Task
    rest: State
    numbers: Mapping[tuple[str, tuple[str, ...]], int]
    idle: Mapping[str, int]
    has_goal: bool
    second_discount: float
    priced: Mapping[str, Action]
    cost_weight: Fraction

    def facts(self, assignment: GroundState) -> State:
        """All facts of a state."""
        return self.rest | changing_facts(self.task, assignment)


@dataclass(frozen=True, slots=True)
class DrawnStep:
    """An action done: its `reward` (eq. 2 and what else is paid), `payment` and `discount` as in the task,
    what it costs by the world's domain, and its duration in seconds where that declares one."""

    action: GroundAction
    reward: float
    payment: float
    discount: float
    cost: float
    seconds: float | None


def world_of(domain: Domain, problem: Problem, timed: bool = False) -> World:
    """The world of a problem by the rules of `domain`; where `timed`, time discounts and not steps.

    Raises `Refused` (E6xx) and `NoDurationError`.
    """
    grounded, costs = ground(domain, problem), costs_of(domain)
    idle = tuple(GroundAction(a.name, (), a.duration, costs[a.name], a.cost.number) for a in domain.actions)
    actions = grounded.actions + idle
    task = replace(grounded, actions=actions, discounts=(grounded.discount,) * len(actions))
    return World(
        by_time(task) if timed else task,
        unchanging_facts(task, problem.state),
        {(action.name, action.objects): index for index, action in enumerate(grounded.actions)},
        {action.name: index for index, action in enumerate(idle, start=len(grounded.actions))},
        bool(problem.goal),
        task.discount ** (1 / task.step) if timed and task.step is not None else 1.0,
        {action.name: action for action in domain.actions if action.cost.parts},
        weight_of(domain, RewardKind.COST),
    )


def changing_facts(task: Task, assignment: GroundState) -> State:
    """The facts that the variables of a state stand for."""
    return frozenset(
        Fact(variable.symbol, variable.objects, variable.values[value])
        for variable, value in zip(task.variables, assignment, strict=True)
        if variable.values[value] is not False
    )


def unchanging_facts(task: Task, facts: State) -> State:
    """Those of the facts that no variable of the task stands for."""
    variables: set[Fluent] = {(variable.symbol, variable.objects) for variable in task.variables}
    return frozenset(fact for fact in facts if (fact.symbol, fact.objects) not in variables)


def assignment_of(task: Task, facts: State) -> GroundState | None:
    """The state of the task that the facts say; None where a variable's value is not one of the task's, or
    where the task may lack rules for the state."""
    values = values_of(facts)
    found = []
    for variable in task.variables:
        value = values.get((variable.symbol, variable.objects), False)
        if value not in variable.values:
            return None
        found.append(variable.values.index(value))
    state = tuple(found)
    return None if is_unreachable(task, state) else state


def do(
    world: World, state: GroundState, action: GroundAction, rng: np.random.Generator
) -> tuple[DrawnStep, GroundState]:
    """Draws what comes of an action; each call takes one number from `rng`, so that the n-th action of an
    episode meets the same random numbers whoever planned it."""
    number, more = world.numbers.get((action.name, action.objects)), Fraction(0)
    if number is None:
        number = world.idle[action.name]
        if action.name in world.priced:
            declared = world.priced[action.name]
            binding = dict(zip(declared.parameters, action.objects, strict=True))
            more = by_functions(declared.cost, binding, values_of(world.rest))
    task = world.task
    drawn, after = sample(task, state, number, rng)
    paid = reward(task, state, number, after) + float(world.cost_weight * more)
    rule = covering_rule(task, state, number)
    if drawn is None or rule is None:
        rng.random()
    else:
        paid -= float(rule.outcomes[drawn].cost)
        more += rule.outcomes[drawn].declared_cost
    cost, seconds = float(task.actions[number].declared_cost + more), task.actions[number].duration
    return DrawnStep(action, paid, payment(task, number), task.discounts[number], cost, seconds), after


def succeeded(world: World, state: GroundState) -> bool | None:
    """Whether the goal holds; without a goal, whether nothing is left of the count that the reward wants
    decreased; None where there is neither."""
    if world.has_goal:
        return reaches_goal(world.task, state)
    counted = world.task.counted
    return None if counted is None else held(counted, state) == 0
