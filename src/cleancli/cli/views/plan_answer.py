"""What `cleancli plan` answers, for people and as data."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import click

from cleancli.cli.kernels import has_compiled
from cleancli.cli.views.plan_steps import steps_data, steps_table
from cleancli.cli.views.tables import plain_table, print_table
from cleancli.compiler.semantics import reaches_goal
from cleancli.language.diagnostics.plural import plural
from cleancli.planning.compare import Comparison
from cleancli.planning.evaluation.forecast import Forecast
from cleancli.planning.evaluation.value import Evaluation, Sampled
from cleancli.planning.plan import Plan
from cleancli.planning.request import PlanningRequest, why_nothing

_NOTHING = {
    "goal": "nothing worth doing: the goal holds already",
    "horizon": "nothing to do: the horizon is 0, so a plan has no steps",
    "no rule": "nothing to do: no rule of any action covers this state;"
    " `cleancli explain` says of an action what its rules lack",
    "margin": "nothing worth doing: no plan found is worth more than that"
    " (for prada and aprada, {margin:g} more)",
}


def echo_plan(
    job: PlanningRequest, plan: Plan, expected: Forecast | None, seconds: Mapping[str, float], as_data: bool
) -> None:
    """The plan, with what is expected of its steps where that was asked for."""
    if as_data:
        reached = reaches_goal(job.task, job.task.initial)
        extra = {
            "goal_reached": reached,
            "empty_because": None if plan.actions else why_nothing(job.task),
            **_not_planned_for(job),
            "seconds": dict(seconds),
        }
        _echo_data({"problem": job.problem.name, **_plan_data(plan), **extra, **_explained(job, expected)})
        return
    _echo_actions(job, plan, expected)
    _echo_not_planned_for(job)
    sampled = f", {plural(plan.samples, 'sample')}" if plan.samples else ""
    coverage = "" if plan.coverage is None else f", coverage {plan.coverage:.3g}"
    click.echo(
        f"value {plan.value:.4f} ({plan.measure}) by {plan.planner}{sampled},"
        f" horizon {plan.horizon}, {plural(len(job.problem.objects), 'object')}{coverage}"
    )
    click.echo("seconds: " + ", ".join(f"{_phase(name)} {spent:.3f}" for name, spent in seconds.items()))


def _phase(name: str) -> str:
    """A phase in words: what was compiled once is loaded ever after."""
    return "load" if name == "compile" and not has_compiled() else name


def _echo_not_planned_for(job: PlanningRequest) -> None:
    if job.left_out:
        names = ", ".join(job.left_out)
        click.echo(f"planned without {names}: beyond `most` of the scene's `symbols` (§4.2.1)")
    if job.ignored:
        names = ", ".join(job.ignored)
        click.echo(
            f"planned without {names}: more than {job.options.counted} are too many to plan for at once"
            f" (§4.2.1; `--option counted={job.options.counted + len(job.ignored)}` takes all)"
        )


def _echo_actions(job: PlanningRequest, plan: Plan, expected: Forecast | None) -> None:
    if not plan.actions:
        click.echo(_NOTHING[why_nothing(job.task)].format(margin=job.options.margin))
        return
    if reaches_goal(job.task, job.task.initial):
        click.echo("the goal holds already; this is worth doing all the same:")
    if expected is None:
        for number, action in enumerate(plan.actions, start=1):
            click.echo(f"{number:3}. {action}")
    else:
        _echo_steps(job, expected)


def echo_evaluation(
    job: PlanningRequest,
    actions: Sequence[int],
    found: Evaluation,
    expected: Forecast | None,
    seconds: Mapping[str, float],
    as_data: bool,
) -> None:
    """What a sequence is worth in each way, with what is expected of its steps where that was asked for, and
    which actions lie beyond the horizon and so do not count."""
    names = [str(job.task.actions[action]) for action in actions]
    beyond = names[max(job.task.horizon, 0) :]
    if as_data:
        data = {
            "problem": job.problem.name,
            "plan": names,
            "horizon": job.task.horizon,
            "beyond_horizon": beyond,
            "factored": found.factored,
            "exact": found.exact,
            "sampled": None if found.sampled is None else _sampled_data(found.sampled),
            "seconds": dict(seconds),
        }
        _echo_data({**data, **_explained(job, expected)})
        return
    if expected is not None:
        _echo_steps(job, expected)
    table = plain_table("value", "of the sequence", "how")
    table.columns[2].justify = "left"
    table.add_row(
        "factored", f"{found.factored:.4f}", "by PRADA's belief, in which variables are independent"
    )
    if found.exact is not None:
        table.add_row("exact", f"{found.exact:.4f}", "from the distribution over states")
    elif found.sampled is not None:
        table.add_row("exact", "-", "too many states may occur")
    if found.sampled is not None:
        error = f"± {found.sampled.error:.4f} (standard error), {plural(found.sampled.runs, 'run')}"
        table.add_row("sampled", f"{found.sampled.value:.4f}", error)
    print_table(table)
    click.echo(f"{plural(len(actions), 'action')}, horizon {job.task.horizon}")
    if beyond:
        one = "action lies beyond the horizon and is not counted"
        click.echo(f"{plural(len(beyond), one, 'actions lie beyond the horizon and are not counted')}:")
        click.echo(f"  {' '.join(beyond)}")


def echo_comparison(job: PlanningRequest, rows: Sequence[Comparison], as_data: bool) -> None:
    """A row for each planner."""
    if as_data:
        planners = [_row_data(row) for row in rows]
        common = {"problem": job.problem.name, "horizon": job.task.horizon, **_not_planned_for(job)}
        _echo_data({**common, "planners": planners})
        return
    table = plain_table(
        "planner", "first action", "actions", "own value", "which is", "true value", "seconds", left=2
    )
    table.columns[1].overflow = "fold"
    table.columns[4].justify = table.columns[5].justify = "left"
    for row in rows:
        if row.plan is None:
            table.add_row(row.planner, f"refused: {row.refusal}", "-", "-", "-", "-", "-")
            continue
        plan = row.plan
        first = str(plan.actions[0]) if plan.actions else "nothing worth doing"
        spent = plan.seconds.get("search", 0.0)
        numbers = (str(len(plan.actions)), f"{plan.value:.4f}", plan.measure, _true(row.true), f"{spent:.3f}")
        table.add_row(row.planner, first, *numbers)
    print_table(table)
    _echo_not_planned_for(job)
    click.echo(f"horizon {job.task.horizon}; true value: of doing the plan's actions, whatever happens")


def _true(value: float | Sampled | None) -> str:
    if isinstance(value, Sampled):
        return f"{value.value:.4f} ± {value.error:.4f}"
    return "-" if value is None else f"{value:.4f}"


def _echo_steps(job: PlanningRequest, expected: Forecast) -> None:
    print_table(steps_table(job, expected))
    source = "the exact distribution" if expected.runs is None else f"{expected.runs} drawn runs"
    click.echo(f"probabilities and expected rewards from {source}; reward is not discounted")


# ---- for programs


def _plan_data(plan: Plan) -> dict[str, object]:
    return {
        "planner": plan.planner,
        "plan": [str(action) for action in plan.actions],
        "value": plan.value,
        "measure": plan.measure,
        "samples": plan.samples,
        "horizon": plan.horizon,
        "coverage": plan.coverage,
    }


def _not_planned_for(job: PlanningRequest) -> dict[str, object]:
    return {"ignored": list(job.ignored), "left_out": list(job.left_out)}


def _explained(job: PlanningRequest, expected: Forecast | None) -> dict[str, object]:
    return {} if expected is None else {"explained": steps_data(job, expected)}


def _row_data(row: Comparison) -> dict[str, object]:
    if row.plan is None:
        return {"planner": row.planner, "refused": row.refusal}
    true = _sampled_data(row.true) if isinstance(row.true, Sampled) else {"value": row.true, "error": 0.0}
    return {**_plan_data(row.plan), "true": true, "seconds": dict(row.plan.seconds)}


def _sampled_data(found: Sampled) -> dict[str, object]:
    return {"value": found.value, "error": found.error, "runs": found.runs}


def _echo_data(data: Mapping[str, object]) -> None:
    click.echo(json.dumps(data, indent=2))
