"""UCT (Kocsis and Szepesvári 2006) with Bellman's equation on the way back (Keller and Helmert 2013)."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan, option
from cleancli.planning.policy import Course
from cleancli.planning.trajectory import beats_nothing, course_plan

ROUND = 100
"""Descents between two looks at the clock. Chosen."""

GREEDY_RUNS = 1
"""Runs of the greedy policy that value a new node. Chosen."""


@dataclass(frozen=True, slots=True)
class UctOptions:
    """`exploration`: how much an action that was tried seldom is favoured."""

    exploration: float = option(0.3, 0, math.inf)


def uct(prepared: Prepared, options: Options, own: UctOptions) -> Plan:
    """What `samples` descents say about acting on what is seen, and its likeliest course.

    With a `time_limit`, as many descents as fit into it; fewer, too, where the value is known before.
    """
    times = [time.perf_counter()]
    task = prepared.task
    _ = prepared.process  # is made when first asked for
    times.append(time.perf_counter())
    search = kernels.tree_search.Search(
        prepared, (), exploration=own.exploration, seed=options.seed, greedy=GREEDY_RUNS
    )
    search.run(1)  # makes numba load or compile what it will run
    times.append(time.perf_counter())
    end = None if options.time_limit is None else times[-1] + options.time_limit
    while search.played < options.samples and not search.solved:
        if end is not None and time.perf_counter() >= end:
            break
        search.run(min(ROUND, options.samples - search.played))
    value = search.value
    course = search.course() if beats_nothing(task, value) else Course()
    times.append(time.perf_counter())
    policy, played = search.policy(), search.played
    return course_plan("uct", task, course, value, times=times, samples=played, policy=policy)
