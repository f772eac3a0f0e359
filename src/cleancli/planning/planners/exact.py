"""The optimal policy (finite-horizon value iteration; Bellman 1957), over all states that can be reached."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cleancli.array_types import Floats, Ints
from cleancli.compiler.task import GroundState
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan, TooManyStatesError, option
from cleancli.planning.planners import plain_graph, rational, reaching
from cleancli.planning.policy import Course, Place, Policy
from cleancli.planning.trajectory import Choose, course_plan, remembering, stepwise

_KEPT = "optimum"
"""What the last solution is called among those of a task."""


@dataclass(frozen=True, slots=True)
class ExactOptions:
    """Problems of more than so many `states` are refused; the `arithmetic` is that of machine numbers or of
    fractions. Without a horizon, where values tend to what they are, what they lack is at most `error`."""

    states: int = option(100_000, 1, 10_000_000)
    arithmetic: str = option("float", "float", "rational")
    error: float = option(1e-10, 1e-13, 0.1)


def exact(prepared: Prepared, options: Options, own: ExactOptions) -> Plan:
    """What acting best on what is seen is worth, and its likeliest course.

    Raises `TooManyStatesError` where more than `own.states` states can be reached within the horizon.
    """
    if prepared.task.reaching is not None:
        error = None if own.arithmetic == "rational" else own.error
        return reaching.plan("exact", prepared, own.states, error)
    times = [time.perf_counter()]
    known = prepared.forgetful
    if own.arithmetic == "rational":
        times += [time.perf_counter()] * 2
        fraction, choose = rational.optimum(known.task, own.states)
        policy = _policy(prepared, choose)
        course = policy.course(policy.start)
        times.append(time.perf_counter())
        return course_plan("exact", prepared.task, course, float(fraction), times=times, policy=policy)
    if at_hand(prepared, own.states) is not None:
        times *= 3
    else:
        _ = known.process
        times.append(time.perf_counter())
        load(known)
        times.append(time.perf_counter())
    solution = optimum(prepared, own.states)
    value, policy = worth(prepared, solution)
    course = policy.course(policy.start)
    times.append(time.perf_counter())
    return course_plan("exact", prepared.task, course, value, times=times, policy=policy)


@dataclass(frozen=True, slots=True)
class Solution:
    """The best policy from a state on, for so many `steps` at most and all states that can be reached."""

    enumeration: Any  # kernels.state_graph.Enumeration (numba is loaded by whoever plans), or a PlainGraph
    within: Ints  # (steps + 1,) how many states are found within so many steps; shorter where no more are
    values: Floats  # (steps + 1, N) what a state is worth, by step
    best: Ints  # (steps, N) -1 to stop
    steps: int

    def place(self, state: GroundState, left: int) -> tuple[int, int] | None:
        """The step and number of a state with so many steps left; None where they were not met."""
        step = self.steps - left
        number = self.enumeration.index(state)
        known = step >= 0 and 0 <= number < self.within[min(step, len(self.within) - 1)]
        return (step, number) if known else None


def optimum(prepared: Prepared, limit: int) -> Solution:
    """The solution from the present state on, which may have been kept.

    Raises `TooManyStatesError` where more than `limit` states can be reached within the horizon.
    """
    solution = at_hand(prepared, limit)
    if solution is None:
        known = prepared.forgetful
        enumeration = kernels.state_graph.Enumeration(known.process, known.task.initial, limit)
        if not enumeration.reach(max(prepared.task.horizon, 0)):
            raise TooManyStatesError(enumeration.number, limit)
        solution = solved(prepared, enumeration)
    return solution


def at_hand(prepared: Prepared, states: int, transitions: float = math.inf) -> Solution | None:
    """What is known of the forgetful task without compiled code: the last solution (`kept`), or that of a
    small task, where no such code has been loaded."""
    solution = kept(prepared, states, transitions)
    if solution is not None or kernels.are_loaded() or not plain_graph.may_be_small(prepared.task):
        return solution
    task = prepared.forgetful.task
    graph = plain_graph.small_graph(task)
    if graph is None or graph.number > states or graph.transitions > transitions:
        return None
    steps = max(task.horizon, 0)
    values, best = np.zeros((steps + 1, graph.number)), np.full((steps, graph.number), -1, np.int32)
    for step, (valued, actions) in enumerate(plain_graph.small_policy(graph, task)):
        values[step, : len(valued)] = [value for value, _ in valued]
        best[step, : len(actions)] = actions
    return _keep(prepared, Solution(graph, np.array(graph.within, np.int32), values, best, steps))


def kept(prepared: Prepared, states: int, transitions: float) -> Solution | None:
    """The last solution of a forgetful task, if it is of no more states and transitions than these and has
    met the present state with as many steps left."""
    known: Solution | None = prepared.solutions.get(_KEPT)
    if known is None or known.enumeration.number > states or known.enumeration.transitions > transitions:
        return None
    task = prepared.forgetful.task
    return None if known.place(task.initial, max(task.horizon, 0)) is None else known


def solved(prepared: Prepared, enumeration: Any) -> Solution:
    """The solution of all that was enumerated of the forgetful task, kept for the states that come of the
    present one. Where no more states can be reached in however many steps, it is for all of them at each
    step, as the next plan asks for it whose horizon is the same again."""
    task, horizon = prepared.forgetful.task, max(prepared.task.horizon, 0)
    graph = enumeration.graph()
    if not enumeration.frontier:
        graph = graph._replace(within=graph.within[-1:])
    induction, process = kernels.backward_induction, prepared.forgetful.process
    values, best = induction.backward(graph, process, task.discount, horizon)
    return _keep(prepared, Solution(enumeration, graph.within, values, best, horizon))


def _keep(prepared: Prepared, solution: Solution) -> Solution:
    prepared.solutions[_KEPT] = solution
    return solution


def worth(prepared: Prepared, solution: Solution) -> tuple[float, Policy]:
    """The optimal value of the present state, and the policy."""
    task = prepared.forgetful.task
    first, number = _met(solution, task.initial, max(task.horizon, 0))

    def choose(step: int, state: GroundState) -> int | None:
        action = solution.best[_met(solution, state, solution.steps - first - step)]
        return int(action) if action >= 0 else None

    return float(solution.values[first, number]), _policy(prepared, choose)


def _policy(prepared: Prepared, choose: Choose) -> Policy:
    """The policy in states with nothing forgotten, by what is chosen in those of the forgetful task."""
    known = stepwise(prepared.forgetful.task, choose)

    def course(place: Place) -> Course:
        there = prepared.at(place.state)
        return remembering(there, known.course(place._replace(state=there.forgetful.task.initial)))

    whole = stepwise(prepared.task, lambda step, state: choose(step, prepared.forget(state)))
    return replace(whole, course=course)


def _met(solution: Solution, state: GroundState, left: int) -> tuple[int, int]:
    place = solution.place(state, left)
    assert place is not None
    return place


def load(prepared: Prepared) -> None:
    """Makes numba load or compile what `optimum` runs."""
    loops, process = kernels.state_graph, prepared.process
    graph = loops.reachable(process, prepared.task.initial, loops.EDGE_LIMIT, 1)
    if graph is not None:
        kernels.backward_induction.backward(graph, process, 1.0, 1)
