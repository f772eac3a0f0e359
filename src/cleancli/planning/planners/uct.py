"""UCT (Kocsis and Szepesvári 2006): episodes whose actions are chosen by upper bounds of their returns."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan, option
from cleancli.planning.trajectory import beats_nothing, course_plan, likeliest_course

ROUND = 100
"""Episodes between two looks at the clock. Chosen."""


@dataclass(frozen=True, slots=True)
class UctOptions:
    """`exploration`: how much an action that was tried seldom is favoured."""

    exploration: float = option(0.3, 0, math.inf)


def uct(prepared: Prepared, options: Options, own: UctOptions) -> Plan:
    """What `samples` episodes say about acting on what is seen, and the course of what they took most often.

    With a `time_limit`, as many episodes as fit into it.
    """
    times = [time.perf_counter()]
    task = prepared.task
    _ = prepared.process  # is made when first asked for
    times.append(time.perf_counter())
    search = kernels.uct_tree.Search(prepared, own.exploration, options.seed)
    search.run(1)  # makes numba load or compile what it will run
    times.append(time.perf_counter())
    end = None if options.time_limit is None else times[-1] + options.time_limit
    while search.played < options.samples and (end is None or time.perf_counter() < end):
        search.run(min(search.played + ROUND, options.samples))
    value = search.value()
    course = likeliest_course(task, search.choose) if beats_nothing(task, value) else ()
    times.append(time.perf_counter())
    return course_plan("uct", task, course, value, times=times, samples=search.played)
