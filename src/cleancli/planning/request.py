"""What `cleancli plan` works on, and what there is to say about its initial state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cleancli.compiler.semantics import covering_rule, reaches_goal
from cleancli.compiler.task import Task
from cleancli.language.calls import Call
from cleancli.language.model import Domain, Problem
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options


@dataclass(frozen=True, slots=True)
class PlanningRequest:
    """A problem, ready for planners that are asked with these options; `ignored` are objects that it had too
    many of (§4.2.1), `left_out` the areas beyond its scene's cap."""

    domain: Domain
    problem: Problem
    prepared: Prepared
    options: Options
    ignored: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    @property
    def task(self) -> Task:
        """The grounded problem."""
        return self.prepared.task


def numbered(task: Task, calls: Sequence[Call]) -> list[int]:
    """The indices of actions in the task, which has them all."""
    number = {(action.name, action.objects): index for index, action in enumerate(task.actions)}
    return [number[call] for call in calls]


def why_nothing(task: Task) -> str:
    """Why an empty plan is: a word for programs ("goal", "horizon", "no rule" or "margin")."""
    if reaches_goal(task, task.initial):
        return "goal"
    if task.horizon <= 0:
        return "horizon"
    if all(covering_rule(task, task.initial, action) is None for action in range(len(task.actions))):
        return "no rule"
    return "margin"
