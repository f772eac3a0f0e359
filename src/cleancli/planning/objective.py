"""What a plan is to be best by: what each objective means with a horizon and without one."""

from __future__ import annotations

from dataclasses import replace

from cleancli.compiler.task import NoDurationError, Objective, Task, by_time, reaching_by
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
    match objective:
        case Objective.REWARD:
            raise PlanningRefused(
                "without a horizon there is no end up to which a reward would be summed up",
                "ask for `--objective probability`, `cost` or `time`, or give the problem a horizon",
            )
        case Objective.COST:
            costly = any(action.declared_cost for action in task.actions)
            costly = costly or any(rule.declared_cost for rule in task.rules)
            if task.actions and not costly:
                raise PlanningRefused(
                    "no action that matters here has a cost",
                    "declare one: `[cost = 2]`, or ask for `--objective probability` or `time`",
                )
        case Objective.TIME:
            if task.untimed or any(action.duration is None for action in task.actions):
                raise NoDurationError(task.untimed)
    return replace(task, reaching=reaching_by(objective, task.actions))
