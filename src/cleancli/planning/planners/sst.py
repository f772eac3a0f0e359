"""Sparse sampling trees (Kearns, Mansour and Ng 2002): look a few steps ahead at a few drawn results."""

from __future__ import annotations

import time
from dataclasses import dataclass

from cleancli.compiler.task import GroundState
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan, option
from cleancli.planning.trajectory import course_plan, stepwise


@dataclass(frozen=True, slots=True)
class SstOptions:
    """So many results of each action are drawn (`branching`), so many steps deep (`depth`)."""

    branching: int = option(3, 1, 1_000)
    depth: int = option(2, 1, 100)


def sst(prepared: Prepared, options: Options, own: SstOptions) -> Plan:
    """The action that looks best from `branching` results of each, `depth` steps deep, and its course.

    Each further action of the course looks from the likeliest result, to the same depth. The value is that of
    stopping after `depth` steps.
    """
    times = [time.perf_counter()]
    task, process = prepared.task, prepared.process
    times.append(time.perf_counter())

    def look(step: int, state: GroundState, depth: int) -> tuple[float, int]:
        return kernels.sparse_sampling.look_ahead(
            process,
            state,
            task.discount,
            horizon=task.horizon - step,
            depth=depth - step,
            branching=own.branching,
            seed=options.seed,
        )

    def choose(step: int, state: GroundState) -> int | None:
        action = look(step, state, own.depth)[1]
        return action if action >= 0 else None

    look(0, task.initial, 0)  # makes numba load or compile what it will run
    times.append(time.perf_counter())
    value = look(0, task.initial, own.depth)[0]
    policy = stepwise(task, choose)
    course = policy.course(policy.start)
    times.append(time.perf_counter())
    measure = "estimated" if course.actions else "policy"  # what stopping at once is worth is known
    return course_plan("sst", task, course, value, times=times, measure=measure, policy=policy)
