"""Determinization (FF-Replan; Yoon, Fern and Givan 2007): plan as if results were certain, or chosen."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from cleancli.compiler.lowering.state_tables import lower_process
from cleancli.compiler.task import Task
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.evaluation.value import earliness, sampled
from cleancli.planning.plan import Options, Plan, option
from cleancli.planning.planners import beam
from cleancli.planning.policy import Course
from cleancli.planning.reductions.determinization import all_outcomes, likeliest_outcomes
from cleancli.planning.trajectory import beats_nothing, course_plan

RUNS = 10_000
"""Runs of the plan in the true process, for its value. Chosen."""


@dataclass(frozen=True, slots=True)
class DeterminizedOptions:
    """So many states are followed in each step (`width`)."""

    width: int = option(2_000, 1, 10_000_000)


def likeliest(prepared: Prepared, options: Options, own: DeterminizedOptions) -> Plan:
    """The best sequence if each action had its likeliest outcome, and what it is truly worth (sampled)."""
    return _determinized("likeliest", likeliest_outcomes, prepared, options, own)


def optimistic(prepared: Prepared, options: Options, own: DeterminizedOptions) -> Plan:
    """The best sequence if outcomes could be chosen, and what it is truly worth (sampled)."""
    return _determinized("all-outcomes", all_outcomes, prepared, options, own)


def _determinized(
    name: str,
    determinize: Callable[[Task], tuple[Task, tuple[int, ...]]],
    prepared: Prepared,
    options: Options,
    own: DeterminizedOptions,
) -> Plan:
    times = [time.perf_counter()]
    task = prepared.task
    certain, origins = determinize(task)
    process = lower_process(certain)
    _ = prepared.process  # is made when first asked for
    times.append(time.perf_counter())
    horizon = max(task.horizon, 0)
    # Makes numba load or compile what it will run.
    beam.best_sequence(process, task.initial, task.discount, steps=1, width=1)
    sampled(prepared, (), options.seed, 1)
    times.append(time.perf_counter())
    sequence = beam.best_sequence(process, task.initial, task.discount, steps=horizon, width=own.width)
    course = Course(tuple(origins[action] for action in sequence))
    value = sampled(prepared, course.actions, options.seed, RUNS).value
    if not beats_nothing(task, value, earliness(prepared, course.actions, options.seed)):
        course = Course()
    times.append(time.perf_counter())
    return course_plan(name, task, course, value, times=times, measure="sampled", samples=RUNS)
