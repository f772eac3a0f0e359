"""What is forgotten makes no difference: whatever is done, the smaller task pays the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cleancli.compiler.semantics import exact_value, successors
from cleancli.compiler.task import GroundCondition, Task
from cleancli.planning.compiled_task import prepare
from support import from_text, small_tasks

GUARD, GUARDED, LENGTH = 0, 4, 4


def partly_guarded(seed: int) -> Task:
    """A random task where only what asks for variable 4 also asks variable 0 for another value than its last
    one; any other rule may set variable 0 again."""
    task = small_tasks.weighted_task(seed)
    open_values = frozenset(range(len(task.variables[GUARD].values) - 1))

    def guarded(condition: GroundCondition) -> GroundCondition:
        literals = dict(condition)
        if GUARDED in literals:
            literals[GUARD] = literals.get(GUARD, open_values) & open_values
        return tuple(sorted(literals.items()))

    rules = [replace(rule, condition=guarded(rule.condition)) for rule in task.rules]
    rewards = [replace(reward, condition=guarded(reward.condition)) for reward in task.rewards]
    return replace(
        task,
        rules=tuple(rule for rule in rules if all(values for _, values in rule.condition)),
        rewards=tuple(reward for reward in rewards if all(values for _, values in reward.condition)),
        horizon=LENGTH,
    )


@pytest.mark.parametrize("seed", range(36))
def test_every_sequence_pays_the_same_though_guards_are_undone(seed: int) -> None:
    task, rng = partly_guarded(seed), np.random.default_rng(seed)
    for _ in range(6):
        state = tuple(int(rng.integers(len(variable.values))) for variable in task.variables)
        here = replace(task, initial=state)
        small = prepare(here).forgetful.task
        for actions in rng.integers(len(task.actions), size=(4, LENGTH)).tolist():
            assert exact_value(small, actions) == pytest.approx(exact_value(here, actions))


@pytest.mark.parametrize("seed", range(36))
def test_what_is_forgotten_does_not_hang_on_how_a_state_was_reached(seed: int) -> None:
    """Each result of an action in the smaller task is what is kept of the result in the whole one."""
    task = partly_guarded(seed)
    prepared = prepare(task)
    small = prepared.forgetful.task
    states = [task.initial]
    for state in states:
        known = prepared.forget(state)
        for action in range(len(task.actions)):
            results = successors(task, state, action)
            kept: dict[tuple[int, ...], float] = {}
            for probability, after in results:
                kept[prepared.forget(after)] = kept.get(prepared.forget(after), 0.0) + probability
            assert {s: p for p, s in successors(small, known, action)} == pytest.approx(kept)
            new = [after for probability, after in results if probability and after not in states]
            states += new[: max(40 - len(states), 0)]


def test_whether_a_clean_area_is_scattered_is_forgotten() -> None:
    """The test above would pass if nothing were ever forgotten."""
    task = from_text.task(small_tasks.SECTION_4, small_tasks.TWO_SCATTERED)
    names = [(variable.symbol, *variable.objects) for variable in task.variables]

    def kept(*true: tuple[str, str]) -> tuple[int, ...]:
        state = tuple(int(name in true) for name in names)
        return prepare(replace(task, initial=state)).forgetful.task.initial

    assert kept(("dirt", "a")) == kept(("dirt", "a"), ("scattered", "b"))
    assert kept(("dirt", "a")) != kept(("dirt", "a"), ("scattered", "a"))


STAGES = """domain stages {
  types { pot }
  predicates { glazed(?p - pot) }
  functions { stage(?p - pot): raw < dry < fired < broken }
  derived { done := count ?p - pot: stage(?p) = fired, glazed(?p) }
  actions { glaze(?p - pot)  dry(?p - pot)  fire(?p - pot)  drop(?p - pot) }
  rule glazed: glaze(?p) { when stage(?p) = dry then 1: glazed(?p) }
  rule dried: dry(?p) { when stage(?p) = raw then 1: stage(?p) := dry }
  rule fired: fire(?p) { when stage(?p) = dry then 1: stage(?p) := fired }
  rule dropped: drop(?p) { when stage(?p) < broken then 1: stage(?p) := broken }
  reward { done }
}"""


def test_what_matters_again_after_several_steps_is_kept() -> None:
    """A glaze pays on a fired pot alone, which a raw one becomes in two steps, and a broken one never."""
    text = "objects { p - pot } init { stage(p) = raw } horizon = 4"
    task = from_text.task(STAGES, text)
    number = {variable.symbol: index for index, variable in enumerate(task.variables)}
    glazed, stage = number["glazed"], number["stage"]
    stages = list(task.variables[stage].values)

    def kept(value: str) -> bool:
        states = []
        for glaze in (0, 1):
            state = list(task.initial)
            state[stage], state[glazed] = stages.index(value), glaze
            states.append(prepare(replace(task, initial=tuple(state))).forgetful.task.initial)
        return states[0] != states[1]

    assert [value for value in stages if kept(str(value))] == ["raw", "dry", "fired"]
