"""What planners work on: a problem grounded for them, and what there is to say about its initial state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import covering_rule, reaches_goal
from cleancli.compiler.task import Task
from cleancli.language.calls import Call
from cleancli.language.model import Domain, Problem
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.objective import aimed
from cleancli.planning.plan import Options
from cleancli.planning.planner import Planner
from cleancli.planning.reductions.subproblem import Fewer, fewer


@dataclass(frozen=True, slots=True)
class PlanningRequest:
    """A problem, ready for these planners with these options (no planner where a given sequence is valued);
    `ignored` are objects that it had too many of (§4.2.1), `left_out` the areas beyond its scene's cap."""

    domain: Domain
    problem: Problem
    prepared: Prepared
    planners: tuple[Planner[Any], ...]
    options: Options
    ignored: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    @property
    def task(self) -> Task:
        """The grounded problem."""
        return self.prepared.task


def requested(
    domain: Domain,
    problem: Problem,
    planners: tuple[Planner[Any], ...],
    options: Options,
    *,
    objective: str | None = None,
    calls: Sequence[Call] | None = None,
    left_out: tuple[str, ...] = (),
) -> PlanningRequest:
    """The task for planners, made smaller where that is needed (§4.2.1), but not where actions are called by
    name or libPRADA is followed. Raises Refused, and NoDurationError where time is to discount."""
    smaller = Fewer(problem)
    if calls is None and not options.compat:
        smaller = fewer(domain, problem, options.counted)
    task = ground(domain, smaller.problem, compat=options.compat, named=calls or ())
    prepared = prepare(aimed(task, objective))
    return PlanningRequest(domain, smaller.problem, prepared, planners, options, smaller.ignored, left_out)


def numbered(task: Task, calls: Sequence[Call]) -> list[int]:
    """The indices of actions in the task, which has them all."""
    number = {(action.name, action.objects): index for index, action in enumerate(task.actions)}
    return [number[call] for call in calls]


def why_nothing(task: Task) -> str:
    """Why an empty plan is, for programs: "goal", "horizon", "no rule", "margin" or "out of reach"."""
    if reaches_goal(task, task.initial):
        return "goal"
    if task.steps is not None and task.steps <= 0:
        return "horizon"
    if all(covering_rule(task, task.initial, action) is None for action in range(len(task.actions))):
        return "no rule"
    return "margin" if task.reaching is None else "out of reach"
