"""What callers ask planners for, whichever function they call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cleancli.api.checks import check_least, check_one_of, check_seconds
from cleancli.language.model import Problem
from cleancli.planning.choice import planner_options, with_named
from cleancli.planning.objective import OBJECTIVES
from cleancli.planning.plan import Options
from cleancli.planning.planner import Planner


@dataclass(frozen=True, slots=True)
class Asked:
    """What planners are asked for; None stands for what the problem says, or else for the usual. `named` are
    options by name, texts like `margin=0.1`. Raises BadOption for what makes no sense."""

    samples: int | None = None
    seed: int | None = None
    time_limit: float | None = None
    threads: int | None = None
    objective: str | None = None
    named: tuple[str, ...] = ()

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
        )
        return with_named(planners, options, self.named)


def named(options: Mapping[str, object] | None) -> tuple[str, ...]:
    """Options by name, as commands write them."""
    return tuple(f"{name}={value}" for name, value in (options or {}).items())
