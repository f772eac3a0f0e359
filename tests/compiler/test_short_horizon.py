"""A horizon that is called too short for a goal is so, and the number of actions that it takes is right."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cleancli.compiler import short_horizon as module
from cleancli.compiler.semantics import reaches_goal, successors
from cleancli.compiler.short_horizon import ShortHorizon, short_horizon
from cleancli.compiler.task import Task
from support import from_text, small_tasks


def fewest(task: Task, most: int = 6) -> int | None:
    """How many actions the goal takes at least, by going through all states."""
    states = {task.initial}
    for steps in range(most):
        if any(reaches_goal(task, state) for state in states):
            return steps
        states |= {
            after
            for state in states
            for action in range(len(task.actions))
            for _, after in successors(task, state, action)
        }
    return None


@pytest.mark.parametrize("seed", range(30))
def test_what_is_told_is_what_all_states_say(seed: int) -> None:
    task = small_tasks.random_task(seed)
    for wanted in task.rules:
        for horizon in range(4):
            aimed = replace(task, goal=(wanted.condition,), horizon=horizon)
            least = fewest(aimed)
            told = None if least is None or least <= horizon else ShortHorizon(horizon, least)
            assert short_horizon(aimed) == told


ROW = """
domain row {
  predicates { one() two() three() }
  actions { go() }
  rule first: go() { when not one() then 0.001: one() rest: nothing }
  rule second: go() { when one(), not two() then 0.001: two() rest: nothing }
  rule third: go() { when one(), two(), not three() then 0.001: three() rest: nothing }
  reward { 1 * goal }
}
"""


def test_a_goal_that_chance_may_bring_is_not_too_far() -> None:
    assert short_horizon(from_text.task(ROW, "goal { three() } horizon = 3")) is None
    assert short_horizon(from_text.task(ROW, "goal { three() } horizon = 2")) == ShortHorizon(2, 3)
    assert short_horizon(from_text.task(ROW, "goal { three() } horizon = unlimited")) is None
    assert short_horizon(from_text.task(ROW, "init { three() } goal { three() } horizon = 1")) is None


def test_of_too_much_work_only_what_is_certain_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A state is asked for three rules."""
    monkeypatch.setattr(module, "WORK", 9)
    assert short_horizon(from_text.task(ROW, "goal { three() } horizon = 2")) == ShortHorizon(2, 3)
    monkeypatch.setattr(module, "WORK", 8)
    assert short_horizon(from_text.task(ROW, "goal { three() } horizon = 2")) == ShortHorizon(2, None)
    monkeypatch.setattr(module, "WORK", 5)
    assert short_horizon(from_text.task(ROW, "goal { three() } horizon = 2")) is None
    assert short_horizon(from_text.task(ROW, "goal { three() } horizon = 1")) == ShortHorizon(1, None)
