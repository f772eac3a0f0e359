"""Sparse sampling against the optimum that it tends to."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from cleancli.compiler.task import Task
from cleancli.planning.plan import Plan
from support import small_tasks
from support.planned import planned


def plan(name: str, task: Task, **options: Any) -> Plan:
    return planned(name, task, **options)


@pytest.mark.parametrize("seed", range(6))
def test_many_results_and_the_whole_horizon_tend_to_the_optimum(seed: int) -> None:
    task = replace(small_tasks.costly_task(seed), horizon=2)
    best = plan("exact", task)
    sampled = plan("sst", task, branching=20_000, depth=9)
    assert sampled.value == pytest.approx(best.value, abs=0.05)
    assert sampled.actions[:1] == best.actions[:1]
