"""What a plan is to be best by: what each objective means with a horizon and without one."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from cleancli.compiler.task import NoDurationError, Objective, Reaching, Task, by_time
from cleancli.planning.plan import PlanningRefused

OBJECTIVES = tuple(objective.value for objective in Objective)


def aimed(task: Task, asked: str | None) -> Task:
    """The task with the objective that is asked for, one of `OBJECTIVES`; None is the usual one: the reward,
    and without a horizon what `ground` says.

    Raises `PlanningRefused` where the problem gives it no meaning, and `NoDurationError`.
    """
    if asked is None:
        return task
    objective = Objective(asked)
    return _up_to_the_horizon(task, objective) if task.reaching is None else _reaching(task, objective)


def _up_to_the_horizon(task: Task, objective: Objective) -> Task:
    match objective:
        case Objective.REWARD:
            return task
        case Objective.TIME:
            return by_time(task)
        case Objective.COST | Objective.PROBABILITY:
            raise PlanningRefused(
                f"up to a horizon plans are for the reward, not for {objective.value} alone",
                "write `horizon = unlimited` and a goal, or let the reward say it: `10 * goal - cost`",
            )


def _reaching(task: Task, objective: Objective) -> Task:
    return replace(task, reaching=Reaching(objective, _costs(task, objective)))


def _costs(task: Task, objective: Objective) -> tuple[Fraction, ...]:
    """What each action costs by an objective. Durations, which are floats, count as the decimal numbers that
    they are printed as."""
    match objective:
        case Objective.REWARD:
            raise PlanningRefused(
                "without a horizon there is no end up to which a reward would be summed up",
                "ask for `--objective probability`, `cost` or `time`, or give the problem a horizon",
            )
        case Objective.PROBABILITY:
            return (Fraction(1),) * len(task.actions)
        case Objective.COST:
            if task.actions and not any(action.declared_cost for action in task.actions):
                raise PlanningRefused(
                    "no action that matters here has a cost",
                    "declare one: `[cost = 2]`, or ask for `--objective probability` or `time`",
                )
            return tuple(action.declared_cost for action in task.actions)
        case Objective.TIME:
            durations = [action.duration for action in task.actions if action.duration is not None]
            if task.untimed or len(durations) < len(task.actions):
                raise NoDurationError(task.untimed)
            return tuple(Fraction(repr(seconds)) for seconds in durations)
