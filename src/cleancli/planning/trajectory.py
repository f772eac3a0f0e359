"""The likeliest trajectory of a policy, which is what a plan shows of it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import partial

from cleancli.compiler.semantics import exact_value, idle_earliness, standing, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.planning.plan import Branch, Plan
from cleancli.planning.preference import preferred

Choose = Callable[[int, GroundState], int | None]
"""What a policy does at a step in a state: an action's index, or None to stop."""


def likeliest_course(task: Task, choose: Choose) -> tuple[int, ...]:
    """The actions taken where each has the result that is `followed`, up to where the policy stops, or the
    horizon."""
    course: list[int] = []
    state = task.initial

    def repeats() -> bool:
        return len(course) < task.horizon and choose(len(course), state) == course[-1]

    while len(course) < task.horizon:
        action = choose(len(course), state)
        if action is None:
            break
        course.append(action)
        state = followed(task, state, action, repeats)
    return tuple(course)


def followed(task: Task, state: GroundState, action: int, repeats: Callable[[], bool]) -> GroundState:
    """The result of an action that a course follows: the likeliest, of equals the first. Where that changes
    nothing and the policy `repeats` the action then, it is the likeliest result that changes something, so
    that what fails and is tried again stands in the course once."""
    results = successors(task, state, action)
    likeliest = _likeliest(results)
    changing = [(probability, after) for probability, after in results if after != state]
    return _likeliest(changing) if likeliest == state and changing and repeats() else likeliest


def _likeliest(results: Sequence[tuple[float, GroundState]]) -> GroundState:
    return max(results, key=lambda pair: pair[0])[1]


CourseFrom = Callable[[int, GroundState], Sequence[int] | None]
"""The likeliest course of a policy after so many steps in a state; None where the policy does not say."""


def branches(task: Task, course: Sequence[int], course_from: CourseFrom, most: int) -> tuple[Branch, ...]:
    """What a policy does after other results than those that its likeliest course follows: at most so many of
    them, those that are most likely to come."""
    found: list[tuple[float, int, GroundState, GroundState]] = []
    state, likelihood = task.initial, 1.0
    for step, action in enumerate(course if most else (), start=1):
        repeats = partial(_repeats, course_from, step, state, action)
        expected, likely = followed(task, state, action, repeats), 0.0
        for probability, after in successors(task, state, action):
            if after == expected:
                likely = probability
            else:
                found.append((likelihood * probability, step, state, after))
        state, likelihood = expected, likelihood * likely
    told: list[Branch] = []
    for probability, step, before, after in sorted(found, key=lambda each: -each[0]):
        way = course_from(step, after) if len(told) < most else None
        if way is not None:
            effects = tuple((v, x) for v, x in enumerate(after) if x != before[v])
            told.append(Branch(step, probability, effects, tuple(task.actions[action] for action in way)))
    return tuple(sorted(told, key=lambda branch: branch.step))


def _repeats(course_from: CourseFrom, step: int, state: GroundState, action: int) -> bool:
    """Whether a policy does an action again in a state. Where it does not say, a base policy goes on, and
    that is taken to stay at what changed nothing."""
    course = course_from(step, state)
    return course is None or tuple(course[:1]) == (action,)


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
    branches: tuple[Branch, ...] = (),
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
        branches=branches if course else (),
    )
