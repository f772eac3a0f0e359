"""Cleans a simulated table, or carries a problem out in the symbolic world, and keeps a record."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from cleancli.api.checks import OBJECTIVES, check_between, check_one_of, check_seconds
from cleancli.api.inputs import GivenDomain, GivenProblem, load_domain, load_problem
from cleancli.api.runs import (
    OpenedRun,
    RunResult,
    carry_out,
    inputs_of,
    new_run,
    resumed_run,
)
from cleancli.execution.events import Event
from cleancli.execution.setup import MOST, EpisodeOptions, Job
from cleancli.execution.strategies import DEFAULT_STRATEGY, STRATEGIES
from cleancli.language.checking.learned import MOST_FORGETTING
from cleancli.learning.estimate import ESTIMATORS
from cleancli.learning.method import DEFAULT, KNOWN, MATCHES, Method
from cleancli.planning.registry import PLANNERS
from cleancli.report.page import write_page

Follow = Callable[[Event], object]
"""Told every event as it happens."""


def _unfollowed(_: Event) -> None:
    """Tell nobody."""


def execute(
    domain: GivenDomain,
    problem: GivenProblem,
    *,
    seed: int | None = None,
    strategy: str = DEFAULT_STRATEGY,
    planner: str | None = None,
    samples: int = 10_000,
    objective: str | None = None,
    job: str | None = None,
    known: int | None = None,
    world: GivenDomain | None = None,
    learn: bool = False,
    estimator: str = DEFAULT.estimator,
    m: float = DEFAULT.m,
    match: str = DEFAULT.match,
    forgetting: float = DEFAULT.forgetting,
    max_actions: int = 60,
    max_seconds: float = 1800,
    runs: str | Path = "runs",
    video: bool = True,
    on_event: Follow = _unfollowed,
) -> RunResult:
    """Carry a problem out: look, decide, act, until nothing is left to do. A scene is carried out on a
    simulated table, any other problem in the symbolic world, by the rules of `world` or else of the domain.
    Leaves a folder in `runs`. Where it is to `learn`, plans go by what was learned so far (§5).

    Ctrl-C ends it in good order with a KeyboardInterrupt that says how to go on. Raises Refused for mistakes
    in the texts and for what cannot be planned, ValueError for options that make no sense, OSError where the
    record cannot be written.
    """
    check_one_of("strategy", strategy, tuple(STRATEGIES))
    check_one_of("planner", planner, tuple(PLANNERS))
    check_one_of("objective", objective, OBJECTIVES)
    check_one_of("job", job, [each.value for each in Job])
    check_one_of("estimator", estimator, tuple(ESTIMATORS))
    check_one_of("match", match, MATCHES)
    check_seconds("m", m, none_of_it=True)
    check_seconds("forgetting", forgetting, none_of_it=True, most=MOST_FORGETTING)
    known = (KNOWN if learn else 0) if known is None else known
    check_between(0, MOST, seed=seed, known=known, max_actions=max_actions)
    check_between(1, MOST, samples=samples)
    check_seconds("max_seconds", max_seconds, none_of_it=True, most=MOST)
    given = load_problem(problem, domain)
    asked = EpisodeOptions(
        strategy,
        planner,
        samples,
        max_actions,
        max_seconds,
        known=known,
        learning=Method(estimator, m, match, forgetting) if learn else None,
    )
    acting = None if world is None else load_domain(world)
    inputs = inputs_of(given, asked, seed=seed, objective=objective, job=job, world=acting)
    with new_run(inputs, Path(runs), video) as run:
        return _followed(run, on_event)


def resume(folder: str | Path, *, on_event: Follow = _unfollowed) -> RunResult:
    """Go on with a run that was cut short, as it began. Raises as `execute` does, ValueError also where the
    run has ended or another process works on it."""
    with resumed_run(Path(folder), lambda _: None) as run:
        return _followed(run, on_event)


def _followed(run: OpenedRun, on_event: Follow) -> RunResult:
    result = carry_out(run, on_event)
    write_page(run.folder)
    return result
