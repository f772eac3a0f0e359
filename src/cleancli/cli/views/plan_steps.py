"""What is expected of a plan step by step, as a table and as data."""

from __future__ import annotations

import itertools

from rich.table import Table

from cleancli.cli.views.tables import plain_table
from cleancli.compiler.task import literal_text
from cleancli.language.model import OutcomeKind
from cleancli.planning.evaluation.forecast import Forecast, ForecastStep, Result
from cleancli.planning.request import PlanningRequest

SHOWN = 3
"""Results of a step that the table shows; the others are in the data."""


def steps_table(job: PlanningRequest, expected: Forecast) -> Table:
    """A row for each likely result of each step; the first also says what is expected of the step."""
    table = plain_table("step", "covered", "by", "reward", "left", "chance", "what may happen")
    for column in (2, 6):
        table.columns[column].justify = "left"
    if expected.remaining is not None:
        table.add_row("start", "", "", "", f"{expected.remaining:.3f}", "", "")
    for number, step in enumerate(expected.steps, start=1):
        action = f"{number}. {job.task.actions[step.action]}"
        left = "" if step.remaining is None else f"{step.remaining:.3f}"
        rows = itertools.zip_longest(_covering(job, step), _likely(job, step), fillvalue=None)
        for index, (rule, result) in enumerate(rows):
            head = (action, _chance(step.covered)) if index == 0 else ("", "")
            numbers = (f"{step.reward:.3f}", left) if index == 0 else ("", "")
            table.add_row(*head, rule or "", *numbers, *(result or ("", "")))
    return table


def _covering(job: PlanningRequest, step: ForecastStep) -> list[str]:
    """The rules that may cover the step, each with its probability unless it does wherever one does."""
    rules = _rules(job, step)
    return [name if len(rules) == 1 else f"{_chance(p)} {name}" for name, p in rules] or ["no rule"]


def _likely(job: PlanningRequest, step: ForecastStep) -> list[tuple[str, str]]:
    """The likeliest results with their probability, the others together, and that no rule covers it."""
    found = [(result.probability, _text(job, result)) for result in step.results[:SHOWN]]
    found.append((sum(result.probability for result in step.results[SHOWN:]), "other"))
    found.append((1 - step.covered, "no rule covers it"))
    return [(_chance(probability), text) for probability, text in found if probability > 1e-9]


def steps_data(job: PlanningRequest, expected: Forecast) -> dict[str, object]:
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


def _rules(job: PlanningRequest, step: ForecastStep) -> list[tuple[str, float]]:
    return [(job.domain.rules[rule].name, probability) for rule, probability in step.rules]


def _text(job: PlanningRequest, result: Result) -> str:
    otherwise = "changes nothing" if result.kind is OutcomeKind.CHANGE else result.kind.value
    return ", ".join(_effects(job, result)) or otherwise


def _effects(job: PlanningRequest, result: Result) -> list[str]:
    return [literal_text(job.task.variables[variable], [value]) for variable, value in result.effects]


def _chance(probability: float) -> str:
    return f"{probability:.3f}"
