"""What all planners on exact states have in common: the cases at the edge, and the margin."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from cleancli.compiler.semantics import exact_value
from cleancli.compiler.task import Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options, Plan
from cleancli.planning.registry import PLANNERS
from support import from_text, small_tasks

NAMES = tuple(name for name in PLANNERS if "prada" not in name)

ONE = "objects { a - area } init { %s }"
PAID = small_tasks.SECTION_4.replace("reward { decrease(dirty) }", "reward { 3 * goal - dirty }")


def plan(name: str, task: Task) -> Plan:
    return PLANNERS[name](prepare(task), Options(samples=500))


def standing_still() -> dict[str, Task]:
    """Tasks in which nothing is worth doing."""
    one = from_text.task(small_tasks.SECTION_4, ONE % "dirt(a)")
    goal = "goal { not dirt(a) } horizon = 4"
    hopeless = tuple(
        replace(
            rule,
            outcomes=tuple(
                replace(o, probability=Fraction(0 if o.effects else 1, 1)) for o in rule.outcomes[-2:]
            ),
        )
        for rule in one.rules
    )
    return {
        "no applicable action": from_text.task(small_tasks.SECTION_4, ONE % ""),
        "goal reached": from_text.task(PAID, f"{ONE % ''} {goal}"),
        "horizon 0": replace(one, horizon=0),
        "probability 0": replace(one, rules=hopeless),
        "too dear": replace(
            one, actions=tuple(replace(action, cost=Fraction(9, 10)) for action in one.actions)
        ),
    }


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("case", standing_still())
def test_nothing_is_done_where_nothing_is_worth_it(name: str, case: str) -> None:
    task = standing_still()[case]
    found = plan(name, task)
    assert found.actions == ()
    assert found.value == pytest.approx(exact_value(task, ()))
    assert found.planner == name
    assert list(found.seconds) == ["lower", "compile", "search"]


@pytest.mark.parametrize("name", NAMES)
def test_one_area_is_cleaned_with_certainty(name: str) -> None:
    text = small_tasks.SECTION_4.replace("0.8: not dirt(?a) rest: nothing", "1: not dirt(?a)")
    task = from_text.task(text, ONE % "dirt(a)")
    found = plan(name, task)
    assert [str(action) for action in found.actions] == ["clean(a)"]
    assert found.value == pytest.approx(1.0)
    assert found.horizon == task.horizon == 2


@pytest.mark.parametrize("name", NAMES)
def test_a_goal_pays_and_dirt_costs(name: str) -> None:
    task = from_text.task(PAID, f"{ONE % 'dirt(a)'} goal {{ not dirt(a) }} horizon = 4")
    found = plan(name, task)
    assert {str(action) for action in found.actions} == {"clean(a)"}
    assert found.value > exact_value(task, ()) + 1.0


@pytest.mark.parametrize("name", NAMES)
def test_same_options_same_plan(name: str) -> None:
    task = replace(small_tasks.costly_task(2), horizon=3)
    one, other = plan(name, task), plan(name, task)
    assert (one.actions, one.value) == (other.actions, other.value)
