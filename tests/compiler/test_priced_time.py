"""A reward that counts durations (docs/language.md "Costs and rewards", docs/planning.md "Rewards")."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import exact_value, reward
from cleancli.compiler.task import Task, by_time, lasting
from cleancli.execution.setup import discounts_time
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS
from support import small_tasks

TEXT = """
domain three {
  types      { area }
  constants  { a b c - area }
  predicates { dirt(?x - area) }
  derived    { left := count ?x - area: dirt(?x) }
  actions {
    one(?x - area)    [duration = 1 s, cost = 2]
    two(?x ?y - area) [duration = 20 s]
    three()           [duration = 18 s]
  }
  rule first: one(?x)    { when dirt(?x), ?x = a then 1: not dirt(?x) }
  rule pair: two(?x, ?y) { when dirt(?x), dirt(?y), ?x = b, ?y = c then 1: not dirt(?x), not dirt(?y) }
  rule all: three()      { then 1: not dirt(a), not dirt(b), not dirt(c) }
  reward { REWARD }
}
"""
PROBLEM = "problem p { domain = three  init { dirt(a) dirt(b) dirt(c) }  horizon = 3 SAID }"
PRICED = "decrease(left) - 0.02 * duration"


def domain_with(paid: str) -> Domain:
    return load_domain(Source("three.nid", TEXT.replace("REWARD", paid)))


def task_of(paid: str, said: str = "") -> Task:
    domain = domain_with(paid)
    return ground(domain, load_problem(Source("p.nid", PROBLEM.replace("SAID", said)), domain))


@pytest.mark.parametrize(
    ("paid", "said", "discount"),
    [
        ("decrease(left)", "", 0.95),
        (PRICED, "", 1.0),
        (PRICED, "discount = 0.95", 0.95),
        (f"{PRICED} + 0.02 * duration", "", 0.95),
    ],
)
def test_where_time_has_a_price_nothing_else_discounts_it_unless_said(
    paid: str, said: str, discount: float
) -> None:
    assert task_of(paid, said).discount == discount


def test_an_action_costs_its_cost_and_its_seconds() -> None:
    task = task_of("decrease(left) - 0.1 * cost - 0.02 * duration - 0.01 * duration")
    assert {action.name: action.cost for action in task.actions} == {
        "one": Fraction("0.23"),
        "two": Fraction("0.6"),
        "three": Fraction("0.54"),
    }
    assert {action.name: action.declared_cost for action in task.actions} == {"one": 2, "two": 0, "three": 0}
    order = [small_tasks.action(task, text) for text in ("one(a)", "two(b, c)")]
    assert exact_value(task, order) == pytest.approx(3 - 0.23 - 0.6)


def test_what_lasts_longer_here_costs_more_here() -> None:
    task = task_of(PRICED)
    first = small_tasks.action(task, "one(a)")
    longer = lasting(task, {task.actions[first].key: 7.5})
    cleaned = tuple(0 for _ in task.variables)
    assert reward(task, task.initial, first, cleaned) == pytest.approx(3 - 0.02)
    assert reward(longer, task.initial, first, cleaned) == pytest.approx(3 - 0.15)
    others = [(a, b) for a, b in zip(task.actions, longer.actions, strict=True) if a.name != "one"]
    assert others
    assert all(before == after for before, after in others)
    assert lasting(longer, {task.actions[first].key: 1.0}) == replace(
        task, step=lasting(task, {task.actions[first].key: 1.0}).step
    )


def test_a_price_wants_the_end_early_and_a_discount_the_first_success() -> None:
    """18 s for all three are less than 19, but then nothing is earned after one second."""
    priced, plain = task_of(PRICED), by_time(task_of("decrease(left)"))
    assert [plan(priced), plan(plain)] == [["three()"], ["one(a)", "three()"]]


def test_execute_discounts_by_time_where_time_has_no_price() -> None:
    assert discounts_time(domain_with("decrease(left)"))
    assert not discounts_time(domain_with(PRICED))


def plan(task: Task) -> list[str]:
    return [str(action) for action in PLANNERS["exact"](prepare(task), Options(100, 1)).actions]
