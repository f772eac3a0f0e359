"""The likeliest trajectory of a policy, which is what a plan shows of it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import NamedTuple

from cleancli.compiler.fluents import Values
from cleancli.compiler.semantics import exact_value, idle_earliness, standing, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Branch, Plan
from cleancli.planning.preference import preferred

Choose = Callable[[int, GroundState], int | None]
"""What a policy does at a step in a state: an action's index, or None to stop."""


class Course(NamedTuple):
    """The `actions` of a policy where each has the result that is `followed`, and the `states` that these
    results are. A sequence, which is carried out whatever its results are, has no states."""

    actions: tuple[int, ...] = ()
    states: tuple[GroundState, ...] = ()


def likeliest_course(task: Task, choose: Choose) -> Course:
    """The course of a policy up to where it stops, or the horizon."""
    actions, states = list[int](), list[GroundState]()
    state = task.initial

    def repeats() -> bool:
        return len(actions) < task.horizon and choose(len(actions), state) == actions[-1]

    while len(actions) < task.horizon:
        action = choose(len(actions), state)
        if action is None:
            break
        actions.append(action)
        state = followed(task, state, action, repeats)
        states.append(state)
    return Course(tuple(actions), tuple(states))


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


def remembering(prepared: Prepared, course: Course) -> Course:
    """The course of a policy of the forgetful task in states of which nothing is forgotten: of those that are
    one to the policy, the likeliest."""
    state, states = prepared.task.initial, list[GroundState]()
    for action, known in zip(*course, strict=True):
        results = successors(prepared.task, state, action)
        state = _likeliest([result for result in results if prepared.forget(result[1]) == known])
        states.append(state)
    return Course(course.actions, tuple(states))


CourseFrom = Callable[[int, GroundState], Course | None]
"""The likeliest course of a policy after so many steps in a state; None where the policy does not say."""


def branches(task: Task, course: Course, course_from: CourseFrom, most: int) -> tuple[Branch, ...]:
    """What a policy does after other results than those that its likeliest course follows: at most so many of
    them, those that are most likely to come."""
    found: list[tuple[float, int, GroundState, GroundState]] = []
    state, likelihood = task.initial, 1.0
    for step, (action, expected) in enumerate(zip(*course, strict=True) if most else (), start=1):
        likely = 0.0
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
            actions = tuple(task.actions[action] for action in way.actions)
            told.append(Branch(step, probability, _effects(before, after), actions))
    return tuple(sorted(told, key=lambda branch: branch.step))


def _effects(before: GroundState, after: GroundState) -> tuple[tuple[int, int], ...]:
    """The variables that have another value after than before, and their values."""
    return tuple((variable, value) for variable, value in enumerate(after) if value != before[variable])


def results(task: Task, course: Course) -> tuple[Values, ...]:
    """What each action of a policy's course sets where it has the result that is followed."""
    told = []
    for before, after in itertools.pairwise((task.initial, *course.states)):
        set_by_it = [(task.variables[variable], value) for variable, value in _effects(before, after)]
        told.append({(each.symbol, each.objects): each.values[value] for each, value in set_by_it})
    return tuple(told)


def beats_nothing(task: Task, value: float, earliness: float | None = None) -> bool:
    """Whether a plan of this value is preferred to stopping at once; without its earliness, only by value."""
    stopping = standing(task, task.initial) * idle_earliness(task.horizon)
    return preferred(value, stopping if earliness is None else earliness, exact_value(task, ()), stopping)


def course_plan(
    planner: str,
    task: Task,
    course: Course,
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
        actions=tuple(task.actions[action] for action in course.actions),
        value=value if course.actions else exact_value(task, ()),
        measure=measure,
        samples=samples,
        horizon=task.horizon,
        coverage=None,
        seconds=dict(zip(("lower", "compile", "search"), seconds, strict=True)),
        branches=branches if course.actions else (),
        results=results(task, course),
    )
