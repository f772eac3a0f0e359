"""What is expected of a plan step by step, as a table and as data."""

from __future__ import annotations

from rich.table import Table

from cleancli.cli.plan_job import Job
from cleancli.cli.tables import plain_table
from cleancli.compiler.task import literal_text
from cleancli.language.model import OutcomeKind
from cleancli.planning.forecast import Forecast, Result, Step

SHOWN = 3
"""Results of a step that the table shows; the others are in the data."""


def steps_table(job: Job, expected: Forecast) -> Table:
    """A row a step, its likeliest results below each other."""
    table = plain_table("step", "covered", "by", "reward", "left", "what is likely to happen", left=0)
    for column in (2, 5):
        table.columns[column].justify = "left"
    table.columns[0].justify = "left"
    if expected.remaining is not None:
        table.add_row("start", "", "", "", f"{expected.remaining:.3f}", "")
    for number, step in enumerate(expected.steps, start=1):
        results = step.results[:SHOWN]
        lines = [f"{_chance(result.probability)} {_text(job, result)}" for result in results]
        other = sum(result.probability for result in step.results[SHOWN:])
        if other > 0:
            lines.append(f"{_chance(other)} other")
        if step.covered < 1 - 1e-9:
            lines.append(f"{_chance(1 - step.covered)} no rule covers it")
        rules = [name if step.covered == p else f"{_chance(p)} {name}" for name, p in _rules(job, step)] or [
            "none"
        ]
        left = "" if step.remaining is None else f"{step.remaining:.3f}"
        action = f"{number}. {job.task.actions[step.action]}"
        table.add_row(
            action, _chance(step.covered), "\n".join(rules), f"{step.reward:.3f}", left, "\n".join(lines)
        )
    return table


def steps_data(job: Job, expected: Forecast) -> dict[str, object]:
    """Everything about the steps."""
    return {
        "measure": "exact" if expected.runs is None else "sampled",
        "runs": expected.runs,
        "remaining": expected.remaining,
        "steps": [
            {
                "action": str(job.task.actions[step.action]),
                "covered": step.covered,
                "rules": [{"rule": name, "probability": p} for name, p in _rules(job, step)],
                "reward": step.reward,
                "remaining": step.remaining,
                "outcomes": [
                    {
                        "probability": result.probability,
                        "kind": result.kind.value,
                        "effects": _effects(job, result),
                    }
                    for result in step.results
                ],
            }
            for step in expected.steps
        ],
    }


def _rules(job: Job, step: Step) -> list[tuple[str, float]]:
    return [(job.domain.rules[rule].name, probability) for rule, probability in step.rules]


def _text(job: Job, result: Result) -> str:
    otherwise = "changes nothing" if result.kind is OutcomeKind.CHANGE else result.kind.value
    return ", ".join(_effects(job, result)) or otherwise


def _effects(job: Job, result: Result) -> list[str]:
    return [literal_text(job.task.variables[variable], [value]) for variable, value in result.effects]


def _chance(probability: float) -> str:
    return f"{probability:.3f}"
