"""One closed loop in the symbolic world: plan from the present state, do the first actions, plan again."""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cleancli.compiler.semantics import idle_worth, standing
from cleancli.compiler.task import GroundAction, GroundState
from cleancli.language.model import State
from cleancli.planning.plan import Options
from cleancli.simulation.agent import Acting
from cleancli.simulation.symbolic_world import DrawnStep, World, do, succeeded


class Reason(enum.Enum):
    """Why an episode is over."""

    GOAL = "the goal holds"
    CLEARED = "nothing is left of the count"
    IDLE = "the planner finds nothing worth doing"
    LIMIT = "the limit of actions is reached"


@dataclass(frozen=True, slots=True)
class EpisodeLimits:
    """`commit`: actions of a plan that are done before the next one is made (§4.2.4). With `horizon` given,
    the n-th action is planned with as many steps less; else with the horizon of the state then reached. With
    `think` the world's time goes on while a plan is made."""

    max_actions: int = 60
    commit: int = 1
    horizon: int | None = None
    think: bool = False


@dataclass(frozen=True, slots=True)
class Episode:
    """What came of one closed loop.

    The returns count `max_actions` steps: after the end nothing is done, and the state is paid for what it
    is. `success` is None where there is neither a goal nor a count to decrease. `cost` is that of all actions
    as declared; `seconds` of robot time, None where a duration is not declared; `planning` in seconds, a
    number per plan, which are part of the robot time where thinking counts.
    """

    number: int
    reason: Reason
    success: bool | None
    discounted: float
    plain: float
    actions: tuple[GroundAction, ...]
    cost: float
    seconds: float | None
    planning: tuple[float, ...]


class _Stream(enum.IntEnum):
    """What randomness is wanted for; numbers are part of an episode's identity and never reused."""

    WORLD = 0
    PLANNING = 1


Saw = Callable[[State, GroundAction, State], object]
"""Is told all facts before an action that was done, the action, and all facts after it."""


def episode(
    world: World, agent: Acting, number: int, options: Options, limits: EpisodeLimits, saw: Saw | None = None
) -> Episode:
    """The numbered episode of the seed in `options`; it depends on no other episode, unless the agent
    remembers what it `saw`.

    The world's draws are the same for all planners, each plan has a seed of its own. Raises what planners do.
    """
    rng = np.random.default_rng(_seeds(options.seed, number, _Stream.WORLD))
    state, steps, planning = world.task.initial, list[DrawnStep](), list[float]()
    waits = [0.0]
    rest: tuple[GroundAction, ...] = ()
    reason = _over(world, state, steps, limits)
    while reason is None:
        plan_seed = _seeds(options.seed, number, _Stream.PLANNING, len(steps)).generate_state(1)
        asked = replace(options, seed=int(plan_seed[0]), previous=rest)
        horizon = None if limits.horizon is None else max(limits.horizon - len(steps), 0)
        plan, seconds = agent.plan(world.facts(state), asked, horizon)
        planning.append(seconds)
        if limits.think:
            waits[-1] += seconds
        if not plan.actions:
            reason = Reason.IDLE
        for action in plan.actions[: limits.commit]:
            before = state
            step, state = do(world, before, action, rng)
            if saw is not None:
                saw(world.facts(before), action, world.facts(state))
            steps.append(step)
            waits.append(0.0)
            reason = _over(world, state, steps, limits)
            if reason is not None:
                break
        rest = plan.actions[limits.commit :]
    discounted, plain = returns(world, steps, waits, state, limits.max_actions)
    durations = [step.seconds for step in steps if step.seconds is not None]
    return Episode(
        number,
        reason,
        succeeded(world, state),
        discounted,
        plain,
        tuple(step.action for step in steps),
        sum(step.cost for step in steps),
        sum(durations) + sum(waits) if len(durations) == len(steps) else None,
        tuple(planning),
    )


def replayed(
    world: World, played: Episode, seed: int
) -> Iterator[tuple[GroundState, DrawnStep, GroundState]]:
    """Each action of an episode once more, with the states before and after it: draws hang on nothing else
    than the seed, the episode's number, and what was done."""
    rng, state = np.random.default_rng(_seeds(seed, played.number, _Stream.WORLD)), world.task.initial
    for action in played.actions:
        before = state
        step, state = do(world, before, action, rng)
        yield before, step, state


def end_of(world: World, played: Episode, seed: int) -> GroundState:
    """The state that an episode ended in."""
    states = [after for _, _, after in replayed(world, played, seed)]
    return states[-1] if states else world.task.initial


def returns(
    world: World, steps: Sequence[DrawnStep], waits: Sequence[float], last: GroundState, length: int
) -> tuple[float, float]:
    """The discounted and the plain return of `length` steps, in which nothing is done after those given; as
    `exact_value` of compiler/semantics.py counts. `waits` are the seconds that pass before each step, and
    before the end; nothing is paid for them."""
    discounted, plain, factor = 0.0, 0.0, 1.0
    for step, wait in zip(steps, waits, strict=False):
        factor *= world.second_discount**wait
        discounted += factor * step.payment * step.reward
        plain += step.reward
        factor *= step.discount
    factor *= world.second_discount ** waits[-1]
    paid, left = standing(world.task, last), max(length - len(steps), 0)
    idle = float(idle_worth(world.task.discount, left)[-1])
    return discounted + factor * idle * paid, plain + left * paid


def _over(
    world: World, state: GroundState, steps: Sequence[DrawnStep], limits: EpisodeLimits
) -> Reason | None:
    if succeeded(world, state):
        return Reason.GOAL if world.has_goal else Reason.CLEARED
    return Reason.LIMIT if len(steps) >= limits.max_actions else None


def _seeds(seed: int, number: int, stream: _Stream, *place: int) -> np.random.SeedSequence:
    return np.random.SeedSequence(seed, spawn_key=(number, stream, *place))
