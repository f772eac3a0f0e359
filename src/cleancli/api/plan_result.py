"""A plan as it is told: its steps, what a policy does off their course, and what they are worth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cleancli.api.expected import Expected
from cleancli.api.goals import HOPELESS, chance_line, too_few
from cleancli.api.plain import fields_of
from cleancli.api.tables import TextTable, shown
from cleancli.compiler.task import Objective
from cleancli.language.diagnostics.plural import plural
from cleancli.planning.evaluation.goal_chance import GoalChance
from cleancli.planning.plan import Reached

_NOTHING = {
    "goal": "nothing worth doing: the goal holds already",
    "horizon": "nothing to do: the horizon is 0, so a plan has no steps",
    "no rule": "nothing to do: no rule of any action covers this state;"
    " `cleancli explain` says of an action what its rules lack",
    "out of reach": "nothing to do: the goal is out of reach, whatever is done",
    "margin": "nothing worth doing: no plan within {within} was found that is worth{more} more than doing"
    " nothing",
}

_WITH_MARGIN = ("prada", "aprada")
"""Planners that ask a plan to be worth so much more than nothing (`--option margin`)."""

_SHORT = (
    "the problem states no horizon, and {within} the goal with probability {chance:z.2g}:"
    " write for example `horizon = {longer}`"
)
"""Beside a plan that the usual horizon is too short for."""

_ASTRAY = "this course does not reach the goal"
"""Below the likeliest course of a policy that reaches the goal on other ways alone."""

_HOW_ELSE = "; `--explain` says what else may happen, and what is done then"
"""After that, where it has not been told."""

_GUESSED = (
    "the horizon of {within} is a guess, because PPDDL has none: `cleancli convert` makes .nid files, which"
    " can state another"
)

_OF_A_POLICY = (
    "steps: of the sequence, each done once; branches: of the policy, which tries again what changed nothing"
)

_TAKES = {
    Objective.PROBABILITY: "actions",
    Objective.COST: "cost",
    Objective.TIME: "seconds",
}
"""What a policy without a horizon is to take little of."""

_BESIDE = ("objects", "margin", "counted", "guessed_horizon", "longer_horizon", "hopeless", "astray")
"""What only the text of a plan tells."""


@dataclass(frozen=True, slots=True)
class PlanBranch:
    """What a policy does where a run of it leaves its likeliest course: after `step` actions of the course,
    with this `probability`, where the last of them has had these `effects`, if any. `late`: those that the
    course follows, when so many tries have been made that the policy does otherwise."""

    step: int
    probability: float
    effects: tuple[str, ...]
    plan: tuple[str, ...]
    late: bool

    def told(self, action: str) -> str:
        """In words; the action is that of the step."""
        result = f"comes to {', '.join(self.effects)}" if self.effects else "changes nothing"
        result += " late" if self.late else ""
        rest = " ".join(self.plan) or "nothing more"
        return f"if {self.step}. {action} {result} ({self.probability:z.3f}): {rest}"


@dataclass(frozen=True, slots=True)
class PlanResult:
    """A plan, as docs/python.md lists it. `horizon` is None and `reached` is not where the problem's horizon
    is unlimited; `explained` is None unless that was asked for. `goal_chance`: of the policy, or the
    sequence; None where the problem has no goal. `guessed_horizon`: no text states it. `longer_horizon`: one
    to try, where the problem states none and the usual one seems too short. `hopeless`: no action can lead to
    the goal, which a search of bounded work has shown. `astray`: the likeliest course of the policy, which is
    the plan, does not reach it, and other ways do."""

    problem: str
    planner: str
    plan: tuple[str, ...]
    value: float
    measure: str
    samples: int
    horizon: int | None
    coverage: float | None
    goal_reached: bool
    goal_chance: GoalChance | None
    empty_because: str | None
    ignored: tuple[str, ...]
    left_out: tuple[str, ...]
    seconds: Mapping[str, float]
    reached: Reached | None
    branches: tuple[PlanBranch, ...]
    explained: Expected | None
    objects: int
    margin: float
    counted: int
    guessed_horizon: bool
    longer_horizon: int | None
    hopeless: bool
    astray: bool

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli plan --json` prints."""
        unreached = () if self.reached is not None else ("reached",)
        unexplained = () if self.explained is not None else ("explained",)
        return fields_of(self, (*_BESIDE, *unreached, *unexplained))

    def __str__(self) -> str:
        steps = [f"{number:3}. {action}" for number, action in enumerate(self.plan, start=1)]
        if self.explained is not None and self.plan:
            steps = [str(self.explained.table()), self.explained.source]
        return "\n".join((*self.beginning(), *steps, *self.ending()))

    def _repr_html_(self) -> str:
        rows = tuple((str(number), action) for number, action in enumerate(self.plan, start=1))
        table = TextTable(("step", "action"), rows, (1,))
        if self.explained is not None:
            table = self.explained.table()
        told = "".join(f"<p>{shown(line)}</p>" for line in (*self.beginning(), *self.ending()))
        return f"<div>{table.html() if self.plan else ''}{told}</div>"

    def beginning(self) -> Iterator[str]:
        """What stands above the steps: why there are none, or that the goal holds."""
        if self.empty_because is not None:
            steps = self.horizon or 0
            within = plural(steps, "action")
            more = f" over {self.margin:g}" if self.planner in _WITH_MARGIN else ""
            yield _NOTHING[self.empty_because].format(more=more, within=within)
            if self.longer_horizon is not None:
                yield too_few(steps, self.longer_horizon)
        elif self.goal_reached:
            yield "the goal holds already; this is worth doing all the same:"

    def ending(self) -> Iterator[str]:
        """What stands below the steps: branches, where steps are explained, what was not planned for, and the
        value."""
        if self.explained is not None and self.plan and self.measure in ("policy", "estimated", "hoped"):
            yield _OF_A_POLICY
        if self.explained is not None and self.branches:
            yield from (branch.told(self.plan[branch.step - 1]) for branch in self.branches)
        yield from not_planned_for(self.left_out, self.ignored, self.counted)
        if self.reached is not None:
            yield from reached_lines(self.reached, self.planner)
            return
        if self.hopeless:
            yield HOPELESS
        elif self.astray:
            yield _ASTRAY if self.explained is not None else _ASTRAY + _HOW_ELSE
        if self.goal_chance is not None and self.plan and not self.goal_reached:
            if self.longer_horizon is not None:
                number, chance = len(self.plan), self.goal_chance.probability
                within = "this action reaches" if number == 1 else f"these {number} actions reach"
                yield _SHORT.format(within=within, chance=chance, longer=self.longer_horizon)
            yield chance_line(self.goal_chance, self.horizon)
        if self.guessed_horizon:
            yield _GUESSED.format(within=plural(self.horizon or 0, "action"))
        sampled = f", {plural(self.samples, 'sample')}" if self.samples else ""
        coverage = "" if self.coverage is None else f", coverage {self.coverage:z.3g}"
        yield (
            f"value {self.value:z.4f} ({self.measure}) by {self.planner}{sampled},"
            f" horizon {self.horizon}, {plural(self.objects, 'object')}{coverage}"
        )


def reached_lines(reached: Reached, planner: str) -> Iterator[str]:
    """What a policy without a horizon is worth, and how wrong that may be."""
    yield (
        f"reaches the goal with probability {reached.probability:.10g} (± {reached.probability_error:z.1g}),"
        f" expected {_TAKES[reached.objective]} {reached.cost:.10g} (± {reached.cost_error:z.1g})"
    )
    yield f"the policy of {planner}, horizon unlimited, {plural(reached.states, 'state')}"


def not_planned_for(left_out: Sequence[str], ignored: Sequence[str], counted: int) -> Iterator[str]:
    """Says which objects are in no plan, and why."""
    if left_out:
        yield f"planned without {', '.join(left_out)}: beyond `most` of the scene's `symbols` (§4.2.1)"
    if ignored:
        yield (
            f"planned without {', '.join(ignored)}: more than {counted} are too many to plan for at once"
            f" (§4.2.1; `--option counted={counted + len(ignored)}` takes all)"
        )
