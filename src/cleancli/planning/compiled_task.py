"""A task together with its lowered arrays, made once for planning in many of its states."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from cleancli.compiler.lowering.belief_tables import Tables, lower
from cleancli.compiler.lowering.state_tables import Process, lower_process
from cleancli.compiler.task import GroundState, Task, in_state
from cleancli.planning.reductions.state_abstraction import Forget, forgetting


class _Arrays:
    """The arrays of a task, each made when first asked for; none depends on the initial state."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self.solutions: dict[Hashable, Any] = {}

    @cached_property
    def tables(self) -> Tables:
        return lower(self._task)

    @cached_property
    def process(self) -> Process:
        return lower_process(self._task)

    @cached_property
    def forgetful(self) -> tuple[_Arrays, Task, Forget]:
        task, forget = forgetting(self._task)
        return _Arrays(task), task, forget


@dataclass(frozen=True, slots=True)
class Prepared:
    """What planners take: a task, and the arrays that it shares with the same task in other states."""

    task: Task
    _arrays: _Arrays

    @property
    def tables(self) -> Tables:
        """For beliefs (PRADA)."""
        return self._arrays.tables

    @property
    def process(self) -> Process:
        """For exact states."""
        return self._arrays.process

    @property
    def forgetful(self) -> Prepared:
        """The same, with what has lost its meaning forgotten, so that fewer states can be reached."""
        arrays, task, forget = self._arrays.forgetful
        initial = forget(self.task.initial)
        return Prepared(replace(task, initial=initial, horizon=self.task.horizon), arrays)

    def forget(self, state: GroundState) -> GroundState:
        """The state of the forgetful task that stands for a state."""
        return self._arrays.forgetful[2](state)

    @property
    def solutions(self) -> dict[Hashable, Any]:
        """What a planner has worked out for all states that it met, to be kept by whatever tells it apart."""
        return self._arrays.solutions

    def at(self, assignment: GroundState, horizon: int | None = None) -> Prepared:
        """The task in another state, with the horizon that it has there unless one is given."""
        moved = in_state(self.task, assignment)
        return Prepared(moved if horizon is None else replace(moved, horizon=horizon), self._arrays)


def prepare(task: Task) -> Prepared:
    """The task for planners."""
    return Prepared(task, _Arrays(task))
