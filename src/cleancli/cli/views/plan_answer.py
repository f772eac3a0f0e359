"""What `cleancli plan` answers, for people and as data."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence

import click

from cleancli.api.evaluations import EvaluationResult
from cleancli.api.expected import Expected
from cleancli.api.plain import plain
from cleancli.api.plan_result import PlanResult, not_planned_for
from cleancli.api.tables import TextTable
from cleancli.cli.kernels import has_compiled
from cleancli.compiler.task import horizon_text
from cleancli.planning.compare import Comparison
from cleancli.planning.evaluation.value import Sampled
from cleancli.planning.plan import Plan
from cleancli.planning.request import PlanningRequest


def echo_plan(result: PlanResult, as_data: bool) -> None:
    """The plan, with what is expected of its steps where that was asked for."""
    if as_data:
        _echo_data(result.to_dict())
        return
    if result.explained is None or not result.plan:
        click.echo(str(result))
    else:
        _echo_lines(result.beginning())
        _echo_steps(result.explained)
        _echo_lines(result.ending())
    spent = (f"{_phase(name)} {seconds:z.3f}" for name, seconds in result.seconds.items())
    click.echo("seconds: " + ", ".join(spent))


def _phase(name: str) -> str:
    """A phase in words: what was compiled once is loaded ever after."""
    return "load" if name == "compile" and not has_compiled() else name


def echo_evaluation(result: EvaluationResult, as_data: bool) -> None:
    """What a sequence is worth in each way, with what is expected of its steps where that was asked for."""
    if as_data:
        _echo_data(result.to_dict())
        return
    if result.explained is not None:
        _echo_steps(result.explained)
    _echo_table(result.table())
    _echo_lines(result.ending())


def echo_comparison(job: PlanningRequest, rows: Sequence[Comparison], as_data: bool) -> None:
    """A row for each planner."""
    if as_data:
        planners = [_row_data(row) for row in rows]
        common = {"problem": job.problem.name, "horizon": job.task.steps, **_not_planned_for(job)}
        _echo_data({**common, "planners": planners})
        return
    heads = ("planner", "first action", "actions", "own value", "which is", "true value", "seconds")
    _echo_table(TextTable(heads, tuple(map(_row, rows)), (0, 1, 4, 5)), folded=1)
    _echo_lines(not_planned_for(job.left_out, job.ignored, job.options.counted))
    click.echo(
        f"horizon {horizon_text(job.task.steps)}; true value: of doing the plan's actions, whatever happens"
    )


def _row(row: Comparison) -> tuple[str, ...]:
    plan = row.plan
    if plan is None:
        return (row.planner, f"refused: {row.refusal}", "-", "-", "-", "-", "-")
    first = str(plan.actions[0]) if plan.actions else "nothing worth doing"
    spent = plan.seconds.get("search", 0.0)
    numbers = (str(len(plan.actions)), f"{plan.value:z.4f}", plan.measure, _true(row.true), f"{spent:z.3f}")
    return (row.planner, first, *numbers)


def _true(value: float | Sampled | None) -> str:
    if isinstance(value, Sampled):
        return f"{value.value:z.4f} ± {value.error:z.4f}"
    return "-" if value is None else f"{value:z.4f}"


def _echo_steps(expected: Expected) -> None:
    _echo_table(expected.table())
    click.echo(expected.source)


def _echo_table(table: TextTable, folded: int | None = None) -> None:
    """A table; the words of the column `folded` are never cut short. What draws tables is imported here,
    because most plans need none."""
    from cleancli.cli.views.tables import print_table, table_of

    shown = table_of(table)
    if folded is not None:
        shown.columns[folded].overflow = "fold"
    print_table(shown)


def _echo_lines(lines: Iterable[str]) -> None:
    for line in lines:
        click.echo(line)


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


def _row_data(row: Comparison) -> dict[str, object]:
    if row.plan is None:
        return {"planner": row.planner, "refused": row.refusal}
    true = plain(row.true) if isinstance(row.true, Sampled) else {"value": row.true, "error": 0.0}
    return {**_plan_data(row.plan), "true": true, "seconds": dict(row.plan.seconds)}


def _echo_data(data: Mapping[str, object]) -> None:
    click.echo(json.dumps(data, indent=2))
