"""The optimal policy (finite-horizon value iteration; Bellman 1957), over all states that can be reached."""

from __future__ import annotations

import time
from types import ModuleType

import numpy as np

from cleancli.compiler.process import Process, lower_process
from cleancli.compiler.task import Assignment, Task
from cleancli.planning.course import Choose, course_plan, likeliest_course
from cleancli.planning.forget import forgetful
from cleancli.planning.plan import Options, Plan, TooManyStatesError
from cleancli.planning.prepared import Prepared
from cleancli.planning.rational import optimum


def exact(prepared: Prepared, options: Options) -> Plan:
    """What acting best on what is seen is worth, and its likeliest course.

    Raises `TooManyStatesError` where more than `options.states` states can be reached within the horizon.
    """
    times = [time.perf_counter()]
    task = forgetful(prepared.task)
    if options.arithmetic == "rational":
        times += [time.perf_counter()] * 2
        fraction, choose = optimum(task, options.states)
        value = float(fraction)
    else:
        process = lower_process(task)
        times.append(time.perf_counter())
        module = _reachable()
        # Makes numba load or compile what it will run.
        module.backward(module.reachable(process, task.initial, module.EDGE_LIMIT, 1), process, 1.0, 1)
        times.append(time.perf_counter())
        value, choose = _optimum(task, process, options.states)
    course = likeliest_course(task, choose)
    return course_plan("exact", task, course, value, times=[*times, time.perf_counter()])


def _optimum(task: Task, process: Process, limit: int) -> tuple[float, Choose]:
    """The optimal value of the initial state, and the policy."""
    module, horizon = _reachable(), max(task.horizon, 0)
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
