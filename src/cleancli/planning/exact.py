"""The optimal policy (finite-horizon value iteration; Bellman 1957), over all states that can be reached."""

from __future__ import annotations

import time
from types import ModuleType

import numpy as np

from cleancli.compiler.task import Assignment
from cleancli.planning.course import Choose, course_plan, likeliest_course
from cleancli.planning.plan import Options, Plan, TooManyStatesError
from cleancli.planning.prepared import Prepared
from cleancli.planning.rational import optimum


def exact(prepared: Prepared, options: Options) -> Plan:
    """What acting best on what is seen is worth, and its likeliest course.

    Raises `TooManyStatesError` where more than `options.states` states can be reached within the horizon.
    """
    task = prepared.task
    times = [time.perf_counter()]
    if options.arithmetic == "rational":
        times *= 3
        fraction, choose = optimum(task, options.states)
        value = float(fraction)
    else:
        process = prepared.process
        times.append(time.perf_counter())
        module = _reachable()
        # Makes numba load or compile what it will run.
        module.backward(module.reachable(process, task.initial, module.EDGE_LIMIT, 1), process, 1.0, 1)
        times.append(time.perf_counter())
        value, choose = _optimum(prepared, options.states)
    course = likeliest_course(task, choose)
    return course_plan("exact", task, course, value, times=[*times, time.perf_counter()])


def _optimum(prepared: Prepared, limit: int) -> tuple[float, Choose]:
    """The optimal value of the initial state, and the policy."""
    module, task, process = _reachable(), prepared.task, prepared.process
    horizon = max(task.horizon, 0)
    enumeration = module.Enumeration(process, task.initial, limit)
    if not enumeration.reach(horizon):
        raise TooManyStatesError(enumeration.number, limit)
    graph = enumeration.graph()
    values, best = module.backward(graph, process, task.discount, horizon)

    def choose(step: int, state: Assignment) -> int | None:
        action = best[step, np.flatnonzero((graph.states == state).all(axis=1))[0]]
        return int(action) if action >= 0 else None

    return float(values[0, 0]), choose


def _reachable() -> ModuleType:
    """The one place that loads numba, which takes longer than most plans."""
    from cleancli.planning import reachable

    return reachable
