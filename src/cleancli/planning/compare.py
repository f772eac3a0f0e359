"""Planners side by side on one task."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from cleancli.compiler.semantics import SupportTooLargeError
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.evaluation.value import Sampled, exact, sampled
from cleancli.planning.plan import Options, Plan, PlanningRefused
from cleancli.planning.planner import Planner


@dataclass(frozen=True, slots=True)
class Comparison:
    """A planner's plan, or why it refused; `true` is what its actions are worth as a sequence: exactly, or
    by rollouts where too many states may occur. Without a horizon it is None: a sequence has no end there."""

    planner: str
    plan: Plan | None
    true: float | Sampled | None
    refusal: str = ""


def compared(planners: Iterable[Planner[Any]], prepared: Prepared, options: Options) -> Iterator[Comparison]:
    """A row for each planner as it is done, all with the same options."""
    number = {action: index for index, action in enumerate(prepared.task.actions)}
    for planner in planners:
        try:
            plan = planner(prepared, options)
        except (PlanningRefused, SupportTooLargeError) as error:
            yield Comparison(planner.name, None, None, str(error))
            continue
        actions = [number[action] for action in plan.actions]
        if prepared.task.reaching is not None:
            yield Comparison(planner.name, plan, None)
            continue
        true: float | Sampled | None = exact(prepared, actions)
        if true is None:
            true = sampled(prepared, actions, options.seed)
        yield Comparison(planner.name, plan, true)
