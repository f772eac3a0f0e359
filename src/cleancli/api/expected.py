"""What is expected of a plan step by step, as records, and as a table."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from cleancli.api.tables import TextTable
from cleancli.api.timing import timed
from cleancli.compiler.task import literal_text
from cleancli.language.model import OutcomeKind
from cleancli.planning.evaluation.forecast import Forecast, ForecastStep, Result, forecast
from cleancli.planning.request import PlanningRequest

SHOWN = 3
"""Results of a step that the table shows; the others are in the data."""


@dataclass(frozen=True, slots=True)
class CoveringRule:
    """A rule that may cover a step, and how likely it does."""

    rule: str
    probability: float


@dataclass(frozen=True, slots=True)
class ExpectedOutcome:
    """What a step may come to: `kind` is "change", "nothing" or "noise"."""

    probability: float
    kind: str
    effects: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ExpectedStep:
    """One step of a plan: how likely a rule covers it, what it pays (not discounted), what remains after it
    of the count that the reward wants decreased, and what may happen, likeliest first. `goal`: where the
    horizon is unlimited, so that no reward counts, the probability that the goal holds after it."""

    action: str
    covered: float
    rules: tuple[CoveringRule, ...]
    reward: float
    remaining: float | None
    outcomes: tuple[ExpectedOutcome, ...]
    goal: float | None


@dataclass(frozen=True, slots=True)
class Expected:
    """What is expected of a plan: exactly, or from so many drawn `runs`; `remaining` at the start."""

    measure: str
    runs: int | None
    remaining: float | None
    steps: tuple[ExpectedStep, ...]

    @property
    def source(self) -> str:
        """Where the numbers come from."""
        source = "the exact distribution" if self.runs is None else f"{self.runs} drawn runs"
        if self._is_for_goal:
            return f"probabilities from {source}; goal: that it holds after the step"
        return f"probabilities and expected rewards from {source}; reward is not discounted"

    @property
    def _is_for_goal(self) -> bool:
        return any(step.goal is not None for step in self.steps)

    def table(self) -> TextTable:
        """A row for each likely result of each step; the first also says what is expected of the step."""
        paid = "goal" if self._is_for_goal else "reward"
        left = () if self.remaining is None else ("left",)
        heads = ("step", "covered", "by", paid, *left, "chance", "what may happen")
        rows: list[tuple[str, ...]] = []
        if self.remaining is not None:
            rows.append(("start", "", "", "", f"{self.remaining:z.3f}", "", ""))
        for number, step in enumerate(self.steps, start=1):
            rows += _rows(number, step)
        return TextTable(heads, tuple(rows), (0, 2, len(heads) - 1))


def expected_of(job: PlanningRequest, found: Forecast) -> Expected:
    """The forecast in words."""
    measure = "exact" if found.runs is None else "sampled"
    return Expected(measure, found.runs, found.remaining, tuple(_step(job, step) for step in found.steps))


def _step(job: PlanningRequest, step: ForecastStep) -> ExpectedStep:
    rules = tuple(CoveringRule(job.domain.rules[rule].name, probability) for rule, probability in step.rules)
    outcomes = tuple(_outcome(job, result) for result in step.results)
    action = str(job.task.actions[step.action])
    goal = None if job.task.reaching is None else step.goal
    return ExpectedStep(action, step.covered, rules, step.reward, step.remaining, outcomes, goal)


def _outcome(job: PlanningRequest, result: Result) -> ExpectedOutcome:
    effects = (literal_text(job.task.variables[variable], [value]) for variable, value in result.effects)
    return ExpectedOutcome(result.probability, result.kind.value, tuple(effects))


def _rows(number: int, step: ExpectedStep) -> list[tuple[str, ...]]:
    paid = step.reward if step.goal is None else step.goal
    told = [f"{each:z.3f}" for each in (paid, step.remaining) if each is not None]
    rows: list[tuple[str, ...]] = []
    pairs = itertools.zip_longest(_covering(step), _likely(step), fillvalue=None)
    for index, (rule, result) in enumerate(pairs):
        head = (f"{number}. {step.action}", _chance(step.covered)) if index == 0 else ("", "")
        numbers = told if index == 0 else [""] * len(told)
        rows.append((*head, rule or "", *numbers, *(result or ("", ""))))
    return rows


def _covering(step: ExpectedStep) -> list[str]:
    """The rules that may cover the step, each with its probability unless it does wherever one does."""
    named = [
        each.rule if len(step.rules) == 1 else f"{_chance(each.probability)} {each.rule}"
        for each in step.rules
    ]
    return named or ["no rule"]


def _likely(step: ExpectedStep) -> list[tuple[str, str]]:
    """The likeliest results with their probability, the others together, and that no rule covers it."""
    found = [(each.probability, _text(each)) for each in step.outcomes[:SHOWN]]
    found.append((sum(each.probability for each in step.outcomes[SHOWN:]), "other"))
    found.append((1 - step.covered, "no rule covers it"))
    return [(_chance(probability), text) for probability, text in found if probability > 1e-9]


def _text(outcome: ExpectedOutcome) -> str:
    otherwise = "changes nothing" if outcome.kind == OutcomeKind.CHANGE.value else outcome.kind
    return ", ".join(outcome.effects) or otherwise


def _chance(probability: float) -> str:
    return f"{probability:z.3f}"


def timed_forecast(
    job: PlanningRequest, actions: Sequence[int], wanted: bool, seconds: dict[str, float]
) -> Forecast | None:
    """What is expected of these actions, where that is wanted."""
    if not wanted:
        return None
    with timed(seconds, "explain"):
        return forecast(job.prepared, actions, job.options.seed)
