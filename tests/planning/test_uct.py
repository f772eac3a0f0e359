"""UCT against the optimum that it tends to, and its promises."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from cleancli.compiler.task import Task
from cleancli.planning.plan import Plan
from support import from_text, small_tasks
from support.planned import planned


def plan(name: str, task: Task, **options: Any) -> Plan:
    return planned(name, task, **options)


@pytest.mark.parametrize("seed", [0, 2, 4, 5])
def test_descents_tend_to_the_optimum(seed: int) -> None:
    task = replace(small_tasks.costly_task(seed), horizon=3)
    if seed == 4:
        task = small_tasks.timed(task)
    best = plan("exact", task)
    assert best.value > 0.1
    many = plan("uct", task, samples=100_000)
    assert many.value == pytest.approx(best.value)
    assert many.actions[0] == best.actions[0]
    assert many.samples < 100_000, "a tree whose value is known grows no more"


def test_the_example_of_section_4_is_seen_through() -> None:
    task = from_text.task(small_tasks.SECTION_4, small_tasks.TWO_SCATTERED)
    found = plan("uct", task, samples=100_000)
    assert found.value == pytest.approx(plan("exact", task).value)
    assert found.actions[0].name == "join"
    assert found.measure == "policy"


def test_same_seed_same_plan_however_the_tree_grows() -> None:
    task = replace(small_tasks.random_task(0), horizon=8)
    one, other = (plan("uct", task, samples=300, seed=5) for _ in range(2))
    assert (one.actions, one.value, one.samples) == (other.actions, other.value, 300)
    assert len({plan("uct", task, samples=20, seed=seed).value for seed in range(8)}) > 1


def test_the_time_limit_ends_the_search() -> None:
    task = replace(small_tasks.random_task(0), horizon=30)
    cut = plan("uct", task, samples=10**9, time_limit=0.05)
    assert 0 < cut.samples < 10**9
    assert cut.seconds["search"] < 1.0
