"""The likeliest trajectory of a policy, which is what a plan shows of it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

from cleancli.compiler.semantics import exact_value, idle_earliness, standing, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.planning.plan import Plan
from cleancli.planning.preference import preferred

Choose = Callable[[int, GroundState], int | None]
"""What a policy does at a step in a state: an action's index, or None to stop."""


def likeliest_course(task: Task, choose: Choose) -> tuple[int, ...]:
    """The actions taken where each has its likeliest result (of equals the first), up to where the policy
    stops, or the horizon."""
    course: list[int] = []
    state = task.initial
    while len(course) < task.horizon:
        action = choose(len(course), state)
        if action is None:
            break
        course.append(action)
        state = likeliest_after(task, state, action)
    return tuple(course)


def likeliest_after(task: Task, assignment: GroundState, action: int) -> GroundState:
    """The likeliest state after an action, of equals the first."""
    return max(successors(task, assignment, action), key=lambda pair: pair[0])[1]


def beats_nothing(task: Task, value: float, earliness: float | None = None) -> bool:
    """Whether a plan of this value is preferred to stopping at once; without its earliness, only by value."""
    stopping = standing(task, task.initial) * idle_earliness(task.horizon)
    return preferred(value, stopping if earliness is None else earliness, exact_value(task, ()), stopping)


def course_plan(
    planner: str,
    task: Task,
    course: Sequence[int],
    value: float,
    *,
    times: Sequence[float],
    measure: str = "policy",
    samples: int = 0,
) -> Plan:
    """The plan of a planner on exact states; an empty one has the value of stopping at once.

    `times` are those at which lowering, compiling and the search began, and the end.
    """
    seconds = (end - begin for begin, end in itertools.pairwise(times))
    return Plan(
        planner=planner,
        actions=tuple(task.actions[action] for action in course),
        value=value if course else exact_value(task, ()),
        measure=measure,
        samples=samples,
        horizon=task.horizon,
        coverage=None,
        seconds=dict(zip(("lower", "compile", "search"), seconds, strict=True)),
    )
