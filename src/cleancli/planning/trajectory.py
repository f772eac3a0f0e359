"""The likeliest trajectory of a policy, which is what a plan shows of it."""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from cleancli.compiler.fluents import Values
from cleancli.compiler.semantics import exact_value, idle_earliness, standing, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Branch, Plan
from cleancli.planning.policy import Course, Place, Policy
from cleancli.planning.preference import preferred

Choose = Callable[[int, GroundState], int | None]
"""What a policy does at a step in a state: an action's index, or None to stop."""


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


def stepwise(task: Task, choose: Choose) -> Policy:
    """The policy that chooses by step and state, up to the horizon."""

    def at(step: int, state: GroundState) -> Place:
        action = choose(step, state) if step < task.horizon else None
        return Place(state, -1 if action is None else action, step)

    def course(place: Place) -> Course:
        ahead = replace(task, initial=place.state, horizon=task.horizon - place.step)
        return likeliest_course(ahead, lambda step, state: choose(place.step + step, state))

    return Policy(at(0, task.initial), lambda place, state: at(place.step + 1, state), course)


LEAST_LIKELY = 0.0005
"""What comes less often is not told: three decimals would show it as 0. Chosen."""

NEGLIGIBLE = 1e-9
"""Tries that are less likely are not followed. Chosen."""


def branches(task: Task, policy: Policy, most: int) -> tuple[Branch, ...]:
    """What a policy does after other results than those that its likeliest course follows: at most so many of
    them, those that are most likely to come.

    A run of the policy is on the course as long as its changes are those of the course: where nothing has
    changed and the policy does the same again, it goes on from there. The probabilities are those of leaving
    the course, and so exclude each other.
    """
    course = policy.course(policy.start)
    told: list[Branch] = []
    before, on = task.initial, {policy.start: 1.0}
    for step, expected in enumerate(course.states, start=1):
        ahead, left = _one_step(task, policy, on, expected)
        following = course.actions[step] if step < len(course.actions) else -1
        late = {place: chance for place, chance in ahead.items() if place.action != following}
        on = {place: chance for place, chance in ahead.items() if place.action == following}
        told += [_branch(task, policy, step, before, places) for places in left.values()]
        told += [_branch(task, policy, step, before, late, late=True)] if late else []
        before = expected
    likely = sorted(told, key=lambda branch: -branch.probability)[:most]
    return tuple(sorted((b for b in likely if b.probability >= LEAST_LIKELY), key=lambda branch: branch.step))


Chances = dict[Place, float]


def _one_step(
    task: Task, policy: Policy, on: Mapping[Place, float], expected: GroundState
) -> tuple[Chances, dict[GroundState, Chances]]:
    """Where the runs that are at these places, which have one state and action, come to by that action, done
    again where it has changed nothing: on the course, and off it by the state."""
    ahead: Chances = defaultdict(float)
    left: dict[GroundState, Chances] = defaultdict(lambda: defaultdict(float))
    trying, places = dict(on), [(place.step, place) for place in on]
    heapq.heapify(places)  # by their steps, so that all that comes to one is known
    while places:
        _, place = heapq.heappop(places)
        chance = trying[place]
        if chance < NEGLIGIBLE:
            continue
        results = [
            (p, policy.after(place, after)) for p, after in successors(task, place.state, place.action)
        ]
        ever = sum(p for p, after in results if after != place)  # the others are tries without an end
        for p, after in results:
            if after.state == expected:
                ahead[after] += chance * p / ever
            elif (after.state, after.action) != (place.state, place.action):
                left[after.state][after] += chance * p / ever
            elif after != place:
                if after not in trying:
                    heapq.heappush(places, (after.step, after))
                trying[after] = trying.get(after, 0.0) + chance * p
    return ahead, left


def _branch(
    task: Task,
    policy: Policy,
    step: int,
    before: GroundState,
    places: Mapping[Place, float],
    *,
    late: bool = False,
) -> Branch:
    """The branch to places that have one state; it goes on as from the likeliest of them."""
    likeliest = max(places, key=lambda place: places[place])
    actions = tuple(task.actions[action] for action in policy.course(likeliest).actions)
    return Branch(step, sum(places.values()), _effects(before, likeliest.state), actions, late)


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
    policy: Policy | None = None,
) -> Plan:
    """The plan of a planner on exact states, which is the course of a policy or a sequence; an empty one has
    the value of stopping at once.

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
        policy=policy if course.actions else None,
        results=results(task, course),
    )
