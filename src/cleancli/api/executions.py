"""Cleans a simulated table, or carries a problem out in the symbolic world, and keeps a record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from cleancli.api.checks import DISCOUNTING, check_between, check_one_of, check_seconds
from cleancli.api.inputs import GivenDomain, GivenProblem, load_domain, load_problem
from cleancli.api.learned import check_writable
from cleancli.api.lessons import Counting, is_own_file
from cleancli.api.run_inputs import inputs_of
from cleancli.api.run_result import RunResult
from cleancli.api.runs import OpenedRun, carry_out
from cleancli.api.series import Series, SeriesResult, carried_out
from cleancli.api.series_resuming import resumed
from cleancli.execution.events import Event
from cleancli.execution.setup import MOST, EpisodeOptions, Job, or_usual
from cleancli.execution.strategies import STRATEGIES
from cleancli.learning.optimism import OPTIMISM
from cleancli.planning.plan import BadOption
from cleancli.planning.registry import PLANNERS
from cleancli.recording.series import MOST_EPISODES, is_series, to_go_on_from
from cleancli.report.page import write_page
from cleancli.world.robot import Robot

Follow = Callable[[Event], object]
"""Told every event as it happens."""


def _unfollowed(_: Event) -> None:
    """Tell nobody."""


def execute(
    domain: GivenDomain,
    problem: GivenProblem,
    *,
    seed: int | None = None,
    strategy: str | None = None,
    planner: str | None = None,
    samples: int = 10_000,
    objective: str | None = None,
    job: str | None = None,
    known: int | None = None,
    optimism: str = "prior",
    world: GivenDomain | None = None,
    robot: Robot | None = None,
    learn: bool = False,
    structure: bool = False,
    teacher: GivenDomain | None = None,
    estimator: str | None = None,
    m: float | None = None,
    match: str | None = None,
    forgetting: float | None = None,
    max_actions: int = 60,
    max_seconds: float | None = None,
    runs: str | Path = "runs",
    video: bool = True,
    on_event: Follow = _unfollowed,
) -> RunResult:
    """Carry a problem out: look, decide, act, until nothing is left to do. A scene is carried out on a
    simulated table, or by a `robot` of yours (docs/your_own_robot.md), any other problem in the symbolic
    world, by the rules of `world` or else of the domain. Leaves a folder in `runs`. Where it is to `learn`,
    plans go by what was learned so far (§5); how, where it is not said, the domain's `learned` block says, or
    is as usual. With `structure`, whole rules are learned, and not their probabilities alone (§7.1). The
    strategy explore asks a `teacher`, a domain whose rules it does not see, where no plan reaches the goal.

    Ctrl-C ends it in good order with a KeyboardInterrupt that says how to go on. Raises Refused for mistakes
    in the texts and for what cannot be planned, ValueError for options that make no sense, OSError where the
    record cannot be written.
    """
    done = execute_series(
        domain,
        problem,
        episodes=1,
        seed=seed,
        strategy=strategy,
        planner=planner,
        samples=samples,
        objective=objective,
        job=job,
        known=known,
        optimism=optimism,
        world=world,
        robot=robot,
        learn=learn,
        structure=structure,
        teacher=teacher,
        estimator=estimator,
        m=m,
        match=match,
        forgetting=forgetting,
        max_actions=max_actions,
        max_seconds=max_seconds,
        runs=runs,
        video=video,
        on_event=on_event,
    )
    return done.runs[0]


def execute_series(
    domain: GivenDomain,
    problem: GivenProblem,
    *,
    episodes: int,
    seed: int | None = None,
    strategy: str | None = None,
    planner: str | None = None,
    samples: int = 10_000,
    objective: str | None = None,
    job: str | None = None,
    known: int | None = None,
    optimism: str = "prior",
    world: GivenDomain | None = None,
    robot: Robot | None = None,
    learn: bool = False,
    structure: bool = False,
    teacher: GivenDomain | None = None,
    estimator: str | None = None,
    m: float | None = None,
    match: str | None = None,
    forgetting: float | None = None,
    write: bool = False,
    max_actions: int = 60,
    max_seconds: float | None = None,
    runs: str | Path = "runs",
    video: bool = True,
    on_event: Follow = _unfollowed,
) -> SeriesResult:
    """Carry a problem out so often, each time with the next seed, as `execute` does; what was learned goes on
    from one episode to the next (§6.3), and with `write` into the domain's file after each.

    Raises what `execute` does, and where it is to `write` what `LearningResult.write` does.
    """
    _check_named(strategy, planner, objective, job, optimism)
    check_between(0, MOST, seed=seed, known=known, max_actions=max_actions)
    check_between(1, MOST, samples=samples)
    check_between(1, MOST_EPISODES, episodes=episodes)
    check_seconds("max_seconds", max_seconds, none_of_it=True, most=MOST)
    counting = Counting(estimator, m, match, forgetting)
    if write and not learn:
        raise BadOption("`write` writes what `learn` has learned: ask for both")
    given, is_writable = load_problem(problem, domain), is_own_file(domain)
    if write:
        check_writable(given.domain.sources[0], is_writable)
    method = counting.method(given.domain.model) if learn else None
    chosen, seconds = or_usual(given.is_scene, strategy, max_seconds)
    asked = EpisodeOptions(chosen, planner, samples, max_actions, seconds, learning=method)
    asked = replace(asked, optimism=optimism, structure=structure)
    acting, shown_by = (None if each is None else load_domain(each) for each in (world, teacher))
    inputs = inputs_of(
        given,
        asked,
        seed=seed,
        objective=objective,
        job=job,
        known=known,
        world=acting,
        robot=robot,
        teacher=shown_by,
    )
    series = Series(given, inputs, episodes, Path(runs), video, is_writable, write)
    *_, done = carried_out(series, lambda run: _followed(run, on_event))
    return done


def _check_named(
    strategy: str | None, planner: str | None, objective: str | None, job: str | None, optimism: str
) -> None:
    check_one_of("strategy", strategy, tuple(STRATEGIES))
    check_one_of("planner", planner, tuple(PLANNERS))
    check_one_of("objective", objective, DISCOUNTING)
    check_one_of("job", job, [each.value for each in Job])
    check_one_of("optimism", optimism, OPTIMISM)


def resume(folder: str | Path, *, on_event: Follow = _unfollowed) -> RunResult:
    """Go on with a run that was cut short, as it began. Raises as `execute` does, ValueError also where the
    run has ended, another process works on it, or it is one of a series."""
    if is_series(to_go_on_from(Path(folder))):
        raise BadOption(f"{folder} is of a series: go on with `resume_series`")
    return resume_series(folder, on_event=on_event).runs[0]


def resume_series(folder: str | Path, *, on_event: Follow = _unfollowed) -> SeriesResult:
    """Go on with a series that was cut short, as it began: the episode under way, and those that are left.
    Raises as `execute_series` does, ValueError also where it has ended or another process works on it."""
    *_, done = resumed(Path(folder), lambda _: None, lambda run: _followed(run, on_event))
    return done


def _followed(run: OpenedRun, on_event: Follow) -> RunResult:
    result = carry_out(run, on_event)
    write_page(run.folder)
    return result
