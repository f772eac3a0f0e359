"""`cleancli plan`: the best sequence of actions found for a problem, or for a scene after one look at it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from cleancli.api.asked import Asked, planning_request
from cleancli.api.evaluations import evaluation_result
from cleancli.api.expected import timed_forecast
from cleancli.api.plans import plan_result
from cleancli.api.seen import seen
from cleancli.api.timing import timed
from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.inputs import open_given
from cleancli.cli.progress import working
from cleancli.cli.unreached import tell_unreached
from cleancli.cli.usage import usage_errors
from cleancli.cli.views.plan_answer import echo_comparison, echo_evaluation, echo_plan
from cleancli.cli.views.plan_picture import check_picture, draw_picture
from cleancli.language.calls import Call
from cleancli.language.load import located_in
from cleancli.planning.choice import planner_named, planners_named
from cleancli.planning.compare import compared
from cleancli.planning.evaluation.forecast import Forecast
from cleancli.planning.evaluation.value import evaluate
from cleancli.planning.objective import OBJECTIVES
from cleancli.planning.refusal import planning_refused
from cleancli.planning.registry import PLANNERS
from cleancli.planning.request import PlanningRequest, numbered

_DRAWING = "drawing runs (the first time compiles what draws, for up to a minute)"
_PLANNING = "planning (the first plan by this planner also compiles it, for up to a minute)"

_APART = (
    ("planner", "compare", "evaluate"),
    ("compare", "explain"),
    ("compare", "plot"),
    *(("compat", name) for name in ("compare", "explain", "plot")),
)
"""Options of which one at most makes sense. What libPRADA grounds has rules that overlap, so its tasks have
beliefs, but no exact meaning."""


@dataclass(frozen=True, slots=True)
class _Wanted:
    """What the answer holds besides the plan, and how it is given."""

    explain: bool
    plot: Path | None
    as_data: bool


@command_of("plan")
@click.option("--planner", type=click.Choice(list(PLANNERS)), help="[default: the problem's, or prada+]")
@click.option("--compare", metavar="PLANNERS", help="Plan with each of these, like prada,prada+.")
@click.option("--evaluate", metavar="ACTIONS", help='Plan nothing; value a sequence like "a(x) b(y, z)".')
@click.option("--explain", is_flag=True, help="Say what is expected of each step, and by which rule.")
@click.option(
    "--plot",
    type=options.FILE,
    metavar="FILE",
    help="Draw what is believed after each step, as .png or .svg (needs matplotlib).",
)
@options.samples("Action sequences to draw (n in eq. 3). [default: the problem's, or 10000]")
@options.seed(usual="the problem's or the scene's, or 1")
@options.time_limit("the search")
@click.option("--threads", type=click.IntRange(min=1), help="Threads at most. [default: 2]")
@options.objective(OBJECTIVES)
@click.option(
    "--compat",
    type=click.Choice(["libprada"]),
    help="Ground and plan as libPRADA does, to compare; with prada or aprada.",
)
@options.named()
@options.as_json("Print everything as JSON.")
@usage_errors()
def command(
    domain: str,
    problem: str,
    planner: str | None,
    compare: str | None,
    evaluate: str | None,
    explain: bool,
    plot: Path | None,
    samples: int | None,
    seed: int | None,
    time_limit: float | None,
    threads: int | None,
    objective: str | None,
    compat: str | None,
    named: tuple[str, ...],
    as_data: bool,
) -> None:
    """Plan with the rules of DOMAIN for PROBLEM.

    For a scene, the simulated camera looks at the table once, and the plan is for what perception reports.
    """
    _refuse_together()
    check_picture(plot)
    names = () if compare is None else planners_named(compare)
    seconds: dict[str, float] = {}
    loaded = open_given(domain, problem, compat=compat is not None)
    sources = loaded.sources
    with working("looking at the table", quiet=not loaded.is_scene):
        looked, seed = seen(loaded, seed, seconds)
    given = looked.problem
    tell_unreached(sources, looked.domain, given)
    asked = Asked(samples, seed, time_limit, threads, objective, named, compat is not None)
    if evaluate is None:
        names = names or (planner_named(planner, given, asked.compat),)
    job, calls = planning_request(looked, seed, asked, names, sources, seconds, actions=evaluate)
    wanted = _Wanted(explain, plot, as_data)
    with located_in(*sources), planning_refused(sources):
        if evaluate is not None:
            _evaluate(job, calls, wanted, seconds)
        elif compare is not None:
            with working(_PLANNING):
                rows = list(compared(job.planners, job.prepared, job.options))
            echo_comparison(job, rows, as_data)
        else:
            _plan(job, wanted, seconds)


def _refuse_together() -> None:
    """Raises UsageError where two options are given that do not go together."""
    given = {name for name, value in click.get_current_context().params.items() if value not in (None, False)}
    for group in _APART:
        together = [f"--{name}" for name in group if name in given]
        if len(together) > 1:
            raise click.UsageError(f"{together[0]} and {together[1]} do not go together")


def _plan(job: PlanningRequest, wanted: _Wanted, seconds: dict[str, float]) -> None:
    with working(_PLANNING):
        plan = job.planners[0](job.prepared, job.options)
    seconds |= plan.seconds
    calls = [(action.name, action.objects) for action in plan.actions]
    expected = _expected(job, numbered(job.task, calls), wanted, seconds)
    echo_plan(plan_result(job, plan, expected, seconds), wanted.as_data)


def _evaluate(
    job: PlanningRequest, calls: Sequence[Call], wanted: _Wanted, seconds: dict[str, float]
) -> None:
    actions = numbered(job.task, calls)
    with (
        timed(seconds, "evaluate"),
        working(_DRAWING),
    ):
        found = evaluate(job.prepared, actions, job.options)
    expected = _expected(job, actions[: max(job.task.horizon, 0)], wanted, seconds)
    echo_evaluation(evaluation_result(job, actions, found, expected, seconds), wanted.as_data)


def _expected(
    job: PlanningRequest, actions: Sequence[int], wanted: _Wanted, seconds: dict[str, float]
) -> Forecast | None:
    """What the answer explains, if it is to; draws what the picture shows."""
    expected = timed_forecast(job, actions, wanted.explain or wanted.plot is not None, seconds)
    if expected is not None and wanted.plot is not None:
        with timed(seconds, "plot"):
            draw_picture(job, actions, expected, wanted.plot)
    return expected if wanted.explain else None
