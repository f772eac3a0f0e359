"""UCT against the optimum that it tends to, and its promises."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import domains
import pytest

from cleancli.compiler.task import Task
from cleancli.planning.plan import Options, Plan
from cleancli.planning.prepared import prepare
from cleancli.planning.table import PLANNERS


def plan(name: str, task: Task, **options: Any) -> Plan:
    return PLANNERS[name](prepare(task), Options(**options))


@pytest.mark.parametrize("seed", range(6))
def test_episodes_tend_to_the_optimum(seed: int) -> None:
    task = replace(domains.costly_task(seed), horizon=3)
    best = plan("exact", task, margin=0.0)
    errors = [abs(plan("uct", task, samples=n, margin=0.0).value - best.value) for n in (30, 300_000)]
    print(errors, best.value)
