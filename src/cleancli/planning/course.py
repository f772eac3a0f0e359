"""From a policy to a plan: the sequence of actions that it takes if the likeliest happens."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

from cleancli.compiler.task import Assignment, Task
from cleancli.compiler.transition import exact_value, successors
from cleancli.planning.plan import Options, Plan

Choose = Callable[[int, Assignment], int | None]
"""What a policy does at a step in a state: an action's index, or nothing."""


def likeliest_course(task: Task, choose: Choose) -> tuple[int, ...]:
    """The actions taken where each has its likeliest result (of equals the first), up to the first time that
    nothing is done, or the horizon."""
    course: list[int] = []
    state = task.initial
    while len(course) < task.horizon:
        action = choose(len(course), state)
        if action is None:
            break
        course.append(action)
        state = likeliest_after(task, state, action)
    return tuple(course)


def likeliest_after(task: Task, assignment: Assignment, action: int) -> Assignment:
    """The likeliest state after an action, of equals the first."""
    return max(successors(task, assignment, action), key=lambda pair: pair[0])[1]


def course_plan(
    planner: str,
    task: Task,
    options: Options,
    course: Sequence[int],
    value: float,
    *,
    times: Sequence[float],
    measure: str = "policy",
    samples: int = 0,
) -> Plan:
    """The plan of a planner on exact states; empty where it is not worth `margin` more than doing nothing.

    `times` are those at which lowering, compiling and the search began, and the end.
    """
    nothing = exact_value(task, ())
    worthy = value > nothing + options.margin
    seconds = (end - begin for begin, end in itertools.pairwise(times))
    return Plan(
        planner=planner,
        actions=tuple(task.actions[action] for action in course) if worthy else (),
        value=value if worthy else nothing,
        measure=measure,
        samples=samples,
        horizon=task.horizon,
        coverage=None,
        seconds=dict(zip(("lower", "compile", "search"), seconds, strict=True)),
    )
