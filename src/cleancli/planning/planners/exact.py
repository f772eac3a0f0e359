"""The optimal policy (finite-horizon value iteration; Bellman 1957), over all states that can be reached."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from cleancli.compiler.task import GroundState
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan, TooManyStatesError, option
from cleancli.planning.planners import rational, reaching
from cleancli.planning.trajectory import Choose, course_plan, likeliest_course


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
        value = float(fraction)
    else:
        _ = known.process
        times.append(time.perf_counter())
        load(known)
        times.append(time.perf_counter())
        value, choose = optimum(known, own.states)
    course = likeliest_course(known.task, choose)
    return course_plan("exact", known.task, course, value, times=[*times, time.perf_counter()])


def optimum(prepared: Prepared, limit: int) -> tuple[float, Choose]:
    """The optimal value of the present state, and the policy.

    Raises `TooManyStatesError` where more than `limit` states can be reached within the horizon.
    """
    task, process = prepared.task, prepared.process
    horizon = max(task.horizon, 0)
    enumeration = kernels.state_graph.Enumeration(process, task.initial, limit)
    if not enumeration.reach(horizon):
        raise TooManyStatesError(enumeration.number, limit)
    graph = enumeration.graph()
    values, best = kernels.state_graph.backward(graph, process, task.discount, horizon)

    def choose(step: int, state: GroundState) -> int | None:
        action = best[step, np.flatnonzero((graph.states == state).all(axis=1))[0]]
        return int(action) if action >= 0 else None

    return float(values[0, 0]), choose


def few_states(prepared: Prepared, limit: int, steps: int) -> bool:
    """Whether no more than `limit` states can be reached within so many steps."""
    steps = min(steps, max(prepared.task.horizon, 0))
    graph = kernels.state_graph.reachable(prepared.process, prepared.task.initial, limit, steps)
    return graph is not None


def load(prepared: Prepared) -> None:
    """Makes numba load or compile what `optimum` runs."""
    loops, process = kernels.state_graph, prepared.process
    graph = loops.reachable(process, prepared.task.initial, loops.EDGE_LIMIT, 1)
    if graph is not None:
        loops.backward(graph, process, 1.0, 1)
