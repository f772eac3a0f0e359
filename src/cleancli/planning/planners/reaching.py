"""Plans without a horizon: the policy that reaches the goal with the greatest probability, at the least cost.

All states are enumerated, up to those in which the goal holds, which end the episode, and solved by
planning/kernels/goal_policy.py. The policy is for every state that can be reached, so that it is worked out
once for all plans of an episode.
"""

from __future__ import annotations

import heapq
import itertools
import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.compiler.task import GroundState, Reaching, Task
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Plan, PlanningRefused, Reached, TooManyStatesError
from cleancli.planning.planners import rational_reaching
from cleancli.planning.policy import Course, Place, Policy
from cleancli.planning.trajectory import remembering, results

SHARES = (1e-2, 1e-4)
"""Of the error that is asked for, what each component of states may leave open, in a first try and in a
second: it adds up over components that lead to each other. Chosen."""

ROUNDING = 1e-15
"""The share of a value that adding up floats may lose. Chosen: some units in their last place."""

_HELP = "raise it by `--planner exact --option states=...`, or give the problem a horizon"


@dataclass(frozen=True, slots=True)
class Solution:
    """The policy for all states that can be reached from the first, and what it is worth in each."""

    enumeration: Any  # kernels.state_graph.Enumeration: numba is loaded by whoever plans
    graph: Any  # kernels.state_graph.Graph
    goal: Bools  # (N,)
    policy: Any  # kernels.goal_policy.GoalPolicy


def plan(planner: str, prepared: Prepared, limit: int, error: float | None) -> Plan:
    """The likeliest way to the goal by the best policy, and what that is worth; empty where the goal holds,
    and where it is out of reach. Without an `error` it is worked out in fractions.

    Raises `TooManyStatesError` where more than `limit` states can be reached, and `PlanningRefused` where
    the values cannot be told with so small an error.
    """
    times = [time.perf_counter()]
    known = prepared.forgetful
    task, _ = known.task, known.process
    times.append(time.perf_counter())
    solution, start = _kept(known, error)
    if solution is None:
        kernels.goal_policy.load()
        kernels.state_graph.reachable(known.process, task.initial, limit, 1)
    times.append(time.perf_counter())
    if solution is None:
        solution, start = solved(known, limit, error), 0
        known.solutions[reaching_of(task), error] = solution
    way = remembering(prepared, likeliest_way(solution, start))
    times.append(time.perf_counter())
    reached = _reached(task, solution, start)
    seconds = (end - begin for begin, end in itertools.pairwise(times))
    return Plan(
        planner=planner,
        actions=tuple(task.actions[action] for action in way.actions),
        value=reached.probability,
        measure="policy",
        samples=0,
        horizon=None,
        coverage=None,
        seconds=dict(zip(("lower", "compile", "search"), seconds, strict=True)),
        reached=reached,
        policy=_policy(prepared, solution) if way.actions else None,
        results=results(prepared.task, way),
    )


def _policy(prepared: Prepared, solution: Solution) -> Policy:
    """The policy in states of which nothing is forgotten, and the likeliest way that it may take from one."""
    graph, choice = solution.graph, solution.policy.choice

    def number(state: GroundState) -> int:
        return int(solution.enumeration.index(prepared.forget(state)))

    def at(state: GroundState) -> Place:
        chosen = choice[number(state)]
        return Place(state, int(graph.choice_action[chosen]) if chosen >= 0 else -1, 0)

    def course(place: Place) -> Course:
        return remembering(prepared.at(place.state), likeliest_way(solution, number(place.state)))

    return Policy(at(prepared.task.initial), lambda _, state: at(state), course)


def _kept(prepared: Prepared, error: float | None) -> tuple[Solution | None, int]:
    """An earlier solution and the number of the present state in it; None where it has not met the state."""
    known: Solution | None = prepared.solutions.get((reaching_of(prepared.task), error))
    start = -1 if known is None else known.enumeration.index(prepared.task.initial)
    return (None, start) if start < 0 else (known, start)


def enumerated(prepared: Prepared, limit: int) -> tuple[Any, Any, Bools]:
    """All states from the present one on: their enumeration and graph, of kernels.state_graph, and in which
    the goal holds. Raises `TooManyStatesError`."""
    task = prepared.task
    enumeration = kernels.state_graph.Enumeration(prepared.process, task.initial, limit, ends=True)
    if not enumeration.exhaust():
        raise TooManyStatesError(enumeration.number, limit, _HELP)
    goal = enumeration.goals()
    if () in task.goal:
        goal[:] = True
    return enumeration, enumeration.graph(), goal


def decisions(task: Task, graph: Any) -> Any:
    """The graph with what its choices cost, as kernels.goal_policy solves it."""
    reaching = reaching_of(task)
    costs = np.array([float(cost) for cost in reaching.costs])[graph.choice_action]
    if any(rule.pays for rule in task.rules):
        costs += np.array([float(reaching.by_outcome(rule)) for rule in task.rules])[graph.choice_rule]
    return kernels.decision_graph.DecisionGraph(
        graph.choice_start,
        graph.edge_start,
        graph.edge_successor,
        graph.edge_probability,
        costs,
    )


def solved(prepared: Prepared, limit: int, error: float | None) -> Solution:
    """The solution from the present state on. Raises as `plan` does."""
    enumeration, graph, goal = enumerated(prepared, limit)
    if error is None:
        task = prepared.task
        policy = rational_reaching.solve(task, reaching_of(task), enumeration, graph, goal)
        return Solution(enumeration, graph, goal, policy)
    policy, left = policy_of(decisions(prepared.task, graph), goal, error)
    if left > error:
        raise PlanningRefused(
            f"values can be told with an error of {left:.1g}, not of {error:.1g}",
            f"ask for less, `--planner exact --option error={10.0 ** math.ceil(math.log10(left)):.0e}`,"
            " or, of few states, for fractions: `--option arithmetic=rational`",
        )
    return Solution(enumeration, graph, goal, policy)


def policy_of(graph: Any, goal: Bools, error: float) -> tuple[Any, float]:
    """The policy, and how wrong its values may be; no more than the `error`, if floats can tell."""
    left = math.inf
    for share in SHARES:
        policy = kernels.goal_policy.solve(graph, goal, share * error)
        left = max(_open(policy.probability), _open(policy.cost))
        if left <= error:
            break
    return policy, left


def reaching_of(task: Task) -> Reaching:
    """What counts; the problem has no horizon."""
    assert task.reaching is not None
    return task.reaching


def _open(bounds: Floats) -> float:
    """By how much the middle between bounds may be wrong, as a share of values above 1."""
    return float(((bounds[1] - bounds[0]) / 2 / np.maximum(bounds[0], 1.0)).max())


def _reached(task: Task, solution: Solution, start: int) -> Reached:
    probability, cost = solution.policy.probability[:, start], solution.policy.cost[:, start]
    return Reached(
        reaching_of(task).objective,
        *_middle(probability),
        *_middle(cost),
        states=len(solution.goal),
    )


def _middle(bounds: Floats) -> tuple[float, float]:
    """The middle between two bounds, and how wrong it may be: also by what floats lose in adding up."""
    lower, upper = bounds.tolist()
    return (lower + upper) / 2, (upper - lower) / 2 + ROUNDING * upper


def likeliest_way(solution: Solution, start: int) -> Course:
    """The course along the likeliest way to the goal that the policy may take from a state; none where the
    goal holds or is out of reach (Dijkstra 1959)."""
    graph, choice = solution.graph, solution.policy.choice
    came: dict[int, tuple[int, int]] = {start: (-1, -1)}
    ahead = [(0.0, 0, start, -1, -1)]
    done = set[int]()
    while ahead:
        distance, steps, state, before, action = heapq.heappop(ahead)
        if state in done:
            continue
        done.add(state)
        came[state] = before, action
        if solution.goal[state]:
            return _way(solution, came, state)
        if choice[state] < 0:
            continue
        action = int(graph.choice_action[choice[state]])
        first, last = graph.edge_start[choice[state]], graph.edge_start[choice[state] + 1]
        for e in range(first, last):
            after = int(graph.edge_successor[e])
            if after not in done:
                chance = math.log(graph.edge_probability[e])
                heapq.heappush(ahead, (distance - chance, steps + 1, after, state, action))
    return Course()


def _way(solution: Solution, came: dict[int, tuple[int, int]], state: int) -> Course:
    """The way by which a state, given by number, was come to."""
    actions, states = list[int](), list[GroundState]()
    while came[state][0] >= 0:
        states.append(solution.enumeration.state(state))
        state, action = came[state]
        actions.append(action)
    return Course(tuple(reversed(actions)), tuple(reversed(states)))
