"""What callers ask planners for, whichever function they call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cleancli.api.checks import check_least, check_one_of, check_seconds
from cleancli.api.timing import timed
from cleancli.execution.observed import ObservedProblem
from cleancli.language.calls import Call, read_actions
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import located_in
from cleancli.language.model import Problem
from cleancli.planning.choice import planner_options, with_named
from cleancli.planning.objective import OBJECTIVES
from cleancli.planning.plan import Options
from cleancli.planning.planner import Planner
from cleancli.planning.refusal import planning_refused
from cleancli.planning.request import PlanningRequest, requested


@dataclass(frozen=True, slots=True)
class Asked:
    """What planners are asked for; None stands for what the problem says, or else for the usual. `named` are
    options by name, texts like `margin=0.1`; `compat`: to plan as libPRADA does. Raises BadOption for what
    makes no sense."""

    samples: int | None = None
    seed: int | None = None
    time_limit: float | None = None
    threads: int | None = None
    objective: str | None = None
    named: tuple[str, ...] = ()
    compat: bool = False

    def __post_init__(self) -> None:
        check_least(1, samples=self.samples, threads=self.threads)
        check_least(0, seed=self.seed)
        check_seconds("time_limit", self.time_limit, none_of_it=False)
        check_one_of("objective", self.objective, OBJECTIVES)

    def of(
        self, problem: Problem, seed: int | None, planners: Sequence[str]
    ) -> tuple[tuple[Planner[Any], ...], Options]:
        """These planners, and what all are asked for in this problem, with this seed. Raises BadOption."""
        options = planner_options(
            problem,
            samples=self.samples,
            seed=seed,
            time_limit=self.time_limit,
            threads=self.threads,
            compat=self.compat,
        )
        return with_named(planners, options, self.named)


def named(options: Mapping[str, object] | None) -> tuple[str, ...]:
    """Options by name, as commands write them."""
    return tuple(f"{name}={value}" for name, value in (options or {}).items())


def planning_request(
    looked: ObservedProblem,
    seed: int | None,
    asked: Asked,
    planners: Sequence[str],
    sources: Sequence[Source],
    seconds: dict[str, float],
    *,
    actions: str | None = None,
) -> tuple[PlanningRequest, Sequence[Call]]:
    """The problem of these texts, ready for these planners, or for a sequence of actions to be valued, which
    is read too. Raises Refused, BadOption."""
    chosen, options = asked.of(looked.problem, seed, planners)
    calls = None if actions is None else read_actions(actions, looked.domain, looked.problem)
    with located_in(*sources), planning_refused(sources), timed(seconds, "ground"):
        job = requested(
            looked.domain,
            looked.problem,
            chosen,
            options,
            objective=asked.objective,
            calls=calls,
            left_out=looked.left_out,
        )
    return job, calls or ()
