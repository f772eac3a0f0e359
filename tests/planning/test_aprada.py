"""A-PRADA: what PRADA's sequence is worth without the actions that it is better off without."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cleancli.compiler.task import Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options, Plan
from cleancli.planning.registry import PLANNERS
from support import from_text, reference_prada, small_tasks

CLEAN_OR_SPLASH = """
domain d {
  types      { area }
  predicates { dirt(?a - area) wet(?a - area) }
  derived    { dirty := count ?a - area: dirt(?a) }
  actions    { clean(?a - area) [cost = 0.01] splash(?a - area) [cost = 0.3] }
  rule clean: clean(?a) { when dirt(?a) then 1: not dirt(?a) }
  rule splash: splash(?a) { when not wet(?a) then 1: wet(?a) }
  rule dry: splash(?a) { when wet(?a) then 1: not wet(?a) }
  default { 1: nothing }
  reward { decrease(dirty) - cost }
}
"""


def plans(task: Task, options: Options) -> tuple[Plan, Plan]:
    return PLANNERS["prada"](prepare(task), options), PLANNERS["aprada"](prepare(task), options)


@pytest.mark.parametrize("compat", [False, True])
def test_no_action_is_left_that_the_plan_is_better_off_without(compat: bool) -> None:
    shorter = 0
    for seed in range(12):
        task = replace(small_tasks.weighted_task(seed), horizon=7)
        before, after = plans(task, Options(4, seed, compat=compat))
        actions = [task.actions.index(action) for action in after.actions]
        value = reference_prada.value(task, actions, independent_rules=compat)
        assert after.value == pytest.approx(value, abs=1e-9)
        assert after.value >= before.value
        shorter += after.value > before.value + 1e-6
        for place in range(len(actions)):
            without = actions[:place] + actions[place + 1 :]
            assert reference_prada.value(task, without, independent_rules=compat) <= value + 1e-9
    assert shorter > 2


def test_useless_actions_of_a_few_samples_go() -> None:
    task = from_text.task(
        CLEAN_OR_SPLASH, "objects { a b - area } init { dirt(a), dirt(b) } horizon = 6 discount = 1.0"
    )
    before, after = plans(task, Options(2, 0))
    assert "splash" in {action.name for action in before.actions}
    assert {str(action) for action in after.actions} == {"clean(a)", "clean(b)"}
    assert after.value == pytest.approx(1.98)
    assert (after.planner, after.samples, after.measure) == ("aprada", before.samples, "factored")


def test_a_plan_that_only_pays_without_an_action_is_found() -> None:
    """The margin is asked of what is left."""
    text = CLEAN_OR_SPLASH.replace("cost = 0.01", "cost = 0.0").replace("cost = 0.3", "cost = 0.05")
    text = text.replace("decrease(dirty)", "0.07 * decrease(dirty)")
    task = from_text.task(text, "objects { a - area } init { dirt(a) } horizon = 3")
    found = {tuple(len(plan.actions) for plan in plans(task, Options(1, seed))) for seed in range(20)}
    assert (0, 1) in found
    assert {before for before, _ in found} == {0, 1}
