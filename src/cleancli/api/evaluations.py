"""What a given sequence of actions is worth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cleancli.api.asked import Asked, named, planning_request
from cleancli.api.expected import Expected, expected_of, timed_forecast
from cleancli.api.goals import chance_line, chance_of
from cleancli.api.inputs import GivenDomain, GivenProblem, load_problem
from cleancli.api.plain import fields_of
from cleancli.api.seen import seen
from cleancli.api.tables import TextTable, shown
from cleancli.api.timing import timed
from cleancli.language.diagnostics.plural import plural
from cleancli.language.load import located_in
from cleancli.planning.evaluation.forecast import Forecast
from cleancli.planning.evaluation.goal_chance import GoalChance
from cleancli.planning.evaluation.value import Evaluation, Sampled
from cleancli.planning.evaluation.value import evaluate as values_of
from cleancli.planning.policy import sequence
from cleancli.planning.refusal import planning_refused
from cleancli.planning.request import PlanningRequest, numbered


@dataclass(frozen=True, slots=True)
class EvaluationResult:
    """What a sequence is worth: by PRADA's belief, exactly (None where too many states may occur), and
    sampled; and how likely it comes to the goal, None where the problem has none. All but the first are None
    where libPRADA's reading is asked for."""

    problem: str
    plan: tuple[str, ...]
    horizon: int
    beyond_horizon: tuple[str, ...]
    factored: float
    exact: float | None
    sampled: Sampled | None
    goal_chance: GoalChance | None
    seconds: Mapping[str, float]
    explained: Expected | None

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli plan --evaluate ... --json` prints."""
        return fields_of(self, () if self.explained is not None else ("explained",))

    def __str__(self) -> str:
        steps = [] if self.explained is None else [str(self.explained.table()), self.explained.source]
        return "\n".join((*steps, str(self.table()), *self.ending()))

    def _repr_html_(self) -> str:
        steps = "" if self.explained is None else self.explained.table().html()
        told = "".join(f"<p>{shown(line)}</p>" for line in self.ending())
        return f"<div>{steps}{self.table().html()}{told}</div>"

    def table(self) -> TextTable:
        """A row for each way to value the sequence."""
        by_belief = "by PRADA's belief, in which variables are independent"
        rows = [("factored", f"{self.factored:z.4f}", by_belief)]
        if self.exact is not None:
            rows.append(("exact", f"{self.exact:z.4f}", "from the distribution over states"))
        elif self.sampled is not None:
            rows.append(("exact", "-", "too many states may occur"))
        if self.sampled is not None:
            error = f"± {self.sampled.error:z.4f} (standard error), {plural(self.sampled.runs, 'run')}"
            rows.append(("sampled", f"{self.sampled.value:z.4f}", error))
        return TextTable(("value", "of the sequence", "how"), tuple(rows), (0, 2))

    def ending(self) -> Iterator[str]:
        """What stands below the table: how long the sequence is, and what of it lies beyond the horizon."""
        if self.goal_chance is not None:
            yield chance_line(self.goal_chance, self.horizon)
        yield f"{plural(len(self.plan), 'action')}, horizon {self.horizon}"
        if self.beyond_horizon:
            one = "action lies beyond the horizon and is not counted"
            many = "actions lie beyond the horizon and are not counted"
            yield f"{plural(len(self.beyond_horizon), one, many)}:"
            yield f"  {' '.join(self.beyond_horizon)}"


def evaluate(
    domain: GivenDomain,
    problem: GivenProblem,
    actions: str | Sequence[str],
    *,
    samples: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    objective: str | None = None,
    options: Mapping[str, object] | None = None,
    explain: bool = False,
) -> EvaluationResult:
    """What a sequence of actions is worth: a text like "wipe(a) wipe(b)", or a list of such.

    Raises as `plan` does.
    """
    asked = Asked(samples, seed, None, threads, objective, named(options))
    given, seconds = load_problem(problem, domain), dict[str, float]()
    text = actions if isinstance(actions, str) else " ".join(actions)
    looked, seed = seen(given, seed, seconds)
    job, calls = planning_request(looked, seed, asked, (), given.sources, seconds, actions=text)
    with located_in(*given.sources), planning_refused(given.sources):
        indices = numbered(job.task, calls)
        with timed(seconds, "evaluate"):
            found = values_of(job.prepared, indices, job.options)
        counted = indices[: max(job.task.horizon, 0)]
        return evaluation_result(job, indices, found, timed_forecast(job, counted, explain, seconds), seconds)


def evaluation_result(
    job: PlanningRequest,
    actions: Sequence[int],
    found: Evaluation,
    expected: Forecast | None,
    seconds: Mapping[str, float],
) -> EvaluationResult:
    """What a sequence is worth, and which actions lie beyond the horizon and so do not count."""
    names = tuple(str(job.task.actions[action]) for action in actions)
    return EvaluationResult(
        problem=job.problem.name,
        plan=names,
        horizon=job.task.horizon,
        beyond_horizon=names[max(job.task.horizon, 0) :],
        factored=found.factored,
        exact=found.exact,
        sampled=found.sampled,
        goal_chance=chance_of(job, sequence(job.task.initial, tuple(actions[: job.task.horizon]))),
        seconds=dict(seconds),
        explained=None if expected is None else expected_of(job, expected),
    )
