"""Plans for a problem, or for what one look at a scene shows; and what a given sequence is worth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cleancli.api.asked import Asked, named
from cleancli.api.checks import check_one_of
from cleancli.api.expected import Expected, expected_of
from cleancli.api.inputs import GivenDomain, GivenProblem, LoadedProblem, load_problem
from cleancli.api.plain import fields_of
from cleancli.api.seen import seen, timed
from cleancli.api.tables import TextTable, shown
from cleancli.compiler.semantics import reaches_goal
from cleancli.compiler.short_horizon import goal_distance, longer_horizon
from cleancli.compiler.task import Objective, literal_text
from cleancli.language.calls import Call, read_actions
from cleancli.language.diagnostics.plural import plural
from cleancli.language.load import located_in
from cleancli.planning.choice import planner_named
from cleancli.planning.evaluation.forecast import Forecast, forecast
from cleancli.planning.evaluation.goal_chance import GoalChance, goal_chance
from cleancli.planning.evaluation.value import Evaluation, Sampled
from cleancli.planning.evaluation.value import evaluate as values_of
from cleancli.planning.plan import Branch, Plan, Reached
from cleancli.planning.planners.prada import PradaOptions
from cleancli.planning.policy import Policy, sequence
from cleancli.planning.refusal import planning_refused
from cleancli.planning.registry import PLANNERS
from cleancli.planning.request import PlanningRequest, numbered, requested, why_nothing
from cleancli.planning.trajectory import branches

_NOTHING = {
    "goal": "nothing worth doing: the goal holds already",
    "horizon": "nothing to do: the horizon is 0, so a plan has no steps",
    "no rule": "nothing to do: no rule of any action covers this state;"
    " `cleancli explain` says of an action what its rules lack",
    "out of reach": "nothing to do: the goal is out of reach, whatever is done",
    "margin": "nothing worth doing: no plan found within {within} is worth more than that{more}",
}

_WITH_MARGIN = ("prada", "aprada")
"""Planners that ask a plan to be worth so much more than nothing (`--option margin`)."""

_TOO_FEW = (
    "the problem states no horizon, and {within} may be too few: write for example `horizon = {longer}`"
)
"""Beside what the usual horizon may have cut short."""

_SHORT = (
    "the problem states no horizon, and {within} the goal with probability {chance:.2g}:"
    " write for example `horizon = {longer}`"
)
"""Beside a plan that the usual horizon is too short for."""

HOPELESS = "the goal is out of reach, whatever is done: it holds in no state that actions may lead to"
"""Where all states are known that actions may lead to."""

_ASTRAY = "this course does not reach the goal; `--explain` says what else may happen, and what is done then"
"""Below the likeliest course of a policy that comes to the goal on other ways alone."""

LIKELY = 0.5
"""A plan that would use more steps and reaches the goal less often than this is told as short. Chosen."""

_BESIDE = ("objects", "margin", "counted", "longer_horizon", "hopeless", "astray")
"""What only the text of a plan tells."""


BRANCHES = 5
"""Branches of a policy that a plan tells, the likeliest. Chosen."""


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
        return f"if {self.step}. {action} {result} ({self.probability:.3f}): {rest}"


@dataclass(frozen=True, slots=True)
class PlanResult:
    """A plan, as docs/python.md lists it. `horizon` is None and `reached` is not where the problem's horizon
    is unlimited; `explained` is None unless that was asked for. `goal_chance`: of the policy, or the
    sequence; None where the problem has no goal. `longer_horizon`: one to try, where the problem states none
    and the usual one seems too short. `hopeless`: no action can lead to the goal, which a search of bounded
    work has shown. `astray`: the likeliest course of the policy, which is the plan, does not reach it."""

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
    longer_horizon: int | None
    hopeless: bool
    astray: bool

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli plan --json` prints."""
        return _dictionary(self, _BESIDE if self.reached is not None else (*_BESIDE, "reached"))

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
            more = f" (for prada and aprada, {self.margin:g} more)" if self.planner in _WITH_MARGIN else ""
            yield _NOTHING[self.empty_because].format(more=more, within=within)
            if self.longer_horizon is not None:
                yield too_few(steps, self.longer_horizon)
        elif self.goal_reached:
            yield "the goal holds already; this is worth doing all the same:"

    def ending(self) -> Iterator[str]:
        """What stands below the steps: branches, where steps are explained, what was not planned for, and the
        value."""
        if self.explained is not None and self.plan and self.measure in ("policy", "hoped"):
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
            yield _ASTRAY
        if self.goal_chance is not None and self.plan and not self.goal_reached:
            if self.longer_horizon is not None:
                number, chance = len(self.plan), self.goal_chance.probability
                within = "this action reaches" if number == 1 else f"these {number} actions reach"
                yield _SHORT.format(within=within, chance=chance, longer=self.longer_horizon)
            yield chance_line(self.goal_chance, self.horizon)
        sampled = f", {plural(self.samples, 'sample')}" if self.samples else ""
        coverage = "" if self.coverage is None else f", coverage {self.coverage:.3g}"
        yield (
            f"value {self.value:.4f} ({self.measure}) by {self.planner}{sampled},"
            f" horizon {self.horizon}, {plural(self.objects, 'object')}{coverage}"
        )


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
        return _dictionary(self)

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
        rows = [("factored", f"{self.factored:.4f}", by_belief)]
        if self.exact is not None:
            rows.append(("exact", f"{self.exact:.4f}", "from the distribution over states"))
        elif self.sampled is not None:
            rows.append(("exact", "-", "too many states may occur"))
        if self.sampled is not None:
            error = f"± {self.sampled.error:.4f} (standard error), {plural(self.sampled.runs, 'run')}"
            rows.append(("sampled", f"{self.sampled.value:.4f}", error))
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


def plan(
    domain: GivenDomain,
    problem: GivenProblem,
    *,
    planner: str | None = None,
    samples: int | None = None,
    seed: int | None = None,
    time_limit: float | None = None,
    threads: int | None = None,
    objective: str | None = None,
    options: Mapping[str, object] | None = None,
    explain: bool = False,
) -> PlanResult:
    """The best plan found. `options` of planners by name (docs/commands.md lists them); with `explain` also
    what is expected of each step.

    Raises Refused for mistakes in the texts and for what cannot be planned, ValueError for options that make
    no sense.
    """
    check_one_of("planner", planner, tuple(PLANNERS))
    asked = Asked(samples, seed, time_limit, threads, objective, named(options))
    given, seconds = load_problem(problem, domain), dict[str, float]()
    job, _ = _request(given, asked, seconds, planner=planner)
    with located_in(*given.sources), planning_refused(given.sources):
        found = job.planners[0](job.prepared, job.options)
        seconds |= found.seconds
        actions = numbered(job.task, [(action.name, action.objects) for action in found.actions])
        return plan_result(job, found, _forecast(job, actions, explain, seconds), seconds)


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
    job, calls = _request(given, asked, seconds, actions=text)
    with located_in(*given.sources), planning_refused(given.sources):
        indices = numbered(job.task, calls)
        with timed(seconds, "evaluate"):
            found = values_of(job.prepared, indices, job.options)
        counted = indices[: max(job.task.horizon, 0)]
        return evaluation_result(job, indices, found, _forecast(job, counted, explain, seconds), seconds)


def plan_result(
    job: PlanningRequest, found: Plan, expected: Forecast | None, seconds: Mapping[str, float]
) -> PlanResult:
    """The plan with all that there is to say about it."""
    chance = _goal_chance(job, found)
    hopeless = _is_hopeless(job, chance)
    short = not hopeless and _seems_short(job, found, chance)
    return PlanResult(
        problem=job.problem.name,
        planner=found.planner,
        plan=tuple(map(str, found.actions)),
        value=found.value,
        measure=found.measure,
        samples=found.samples,
        horizon=found.horizon,
        coverage=found.coverage,
        goal_reached=reaches_goal(job.task, job.task.initial),
        goal_chance=chance,
        empty_because=None if found.actions else why_nothing(job.task),
        ignored=job.ignored,
        left_out=job.left_out,
        seconds=dict(seconds),
        reached=found.reached,
        branches=_branches(job, found.policy),
        explained=None if expected is None else expected_of(job, expected),
        objects=len(job.problem.objects),
        margin=_margin(job),
        counted=job.options.counted,
        longer_horizon=longer_horizon(job.task) if short else None,
        hopeless=hopeless,
        astray=_is_astray(job, found.policy),
    )


def too_few(steps: int, longer: int) -> str:
    """What helps where the usual horizon, of so many steps, may be too short for a problem's goal: a longer
    one."""
    return _TOO_FEW.format(within=plural(steps, "action"), longer=longer)


def chance_line(chance: GoalChance, horizon: int | None) -> str:
    """How likely the goal is reached within a horizon."""
    how = f" (± {chance.error:.2g}, {chance.runs} drawn runs)" if chance.runs else ""
    digits = 3 if chance.runs else 6
    within = plural(horizon or 0, "action")
    return f"reaches the goal with probability {chance.probability:.{digits}g}{how} within {within}"


def _goal_chance(job: PlanningRequest, found: Plan) -> GoalChance | None:
    """That of the plan's policy, or of its sequence."""
    if found.reached is not None:
        return GoalChance(found.reached.probability, found.reached.probability_error, None)
    actions = tuple(numbered(job.task, [action.key for action in found.actions]))
    return _chance_of(job, found.policy or sequence(job.task.initial, actions))


def _chance_of(job: PlanningRequest, policy: Policy) -> GoalChance | None:
    if not job.problem.goal or job.options.compat:  # there, rules may overlap
        return None
    return goal_chance(job.task, policy, job.options.seed)


def _is_hopeless(job: PlanningRequest, chance: GoalChance | None) -> bool:
    """Whether it is known that the goal is never reached; of a problem made smaller that would not be known
    of the whole."""
    if chance is None or chance.probability or job.ignored or job.left_out:
        return False
    return goal_distance(job.task).least is None


def _is_astray(job: PlanningRequest, policy: Policy | None) -> bool:
    """Whether no state on the likeliest course of a policy satisfies the goal."""
    if policy is None or not job.problem.goal:
        return False
    course = policy.course(policy.start)
    on = (job.task.initial, *course.states)
    return bool(course.actions) and not any(reaches_goal(job.task, state) for state in on)


def _seems_short(job: PlanningRequest, found: Plan, chance: GoalChance | None) -> bool:
    """Whether the usual horizon may be why nothing is done, or why a plan seldom reaches the goal: a policy
    tries again as long as there are steps, and a sequence has no step to spare."""
    if job.problem.horizon is not None:
        return False
    if not found.actions:
        return why_nothing(job.task) == "margin"
    if chance is None or reaches_goal(job.task, job.task.initial):
        return False
    used_up = found.policy is not None or len(found.actions) == found.horizon
    return not chance.probability or (chance.probability < LIKELY and used_up)


def _branches(job: PlanningRequest, policy: Policy | None) -> tuple[PlanBranch, ...]:
    """What a policy does off its likeliest course, in words; a sequence has no branches."""
    told = () if policy is None else branches(job.task, policy, BRANCHES)
    return tuple(_branch(job, branch) for branch in told)


def _branch(job: PlanningRequest, branch: Branch) -> PlanBranch:
    effects = (literal_text(job.task.variables[variable], [value]) for variable, value in branch.effects)
    actions = tuple(map(str, branch.actions))
    return PlanBranch(branch.step, branch.probability, tuple(effects), actions, branch.late)


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
        goal_chance=_chance_of(job, sequence(job.task.initial, tuple(actions[: job.task.horizon]))),
        seconds=dict(seconds),
        explained=None if expected is None else expected_of(job, expected),
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


def reached_lines(reached: Reached, planner: str) -> Iterator[str]:
    """What a policy without a horizon is worth, and how wrong that may be."""
    yield (
        f"reaches the goal with probability {reached.probability:.10g} (± {reached.probability_error:.1g}),"
        f" expected {_TAKES[reached.objective]} {reached.cost:.10g} (± {reached.cost_error:.1g})"
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


def _request(
    given: LoadedProblem,
    asked: Asked,
    seconds: dict[str, float],
    *,
    planner: str | None = None,
    actions: str | None = None,
) -> tuple[PlanningRequest, Sequence[Call]]:
    """The problem, ready for its planner, or for a sequence of actions to be valued, which is read too."""
    looked, seed = seen(given, asked.seed, seconds)
    names = [planner_named(planner, looked.problem)] if actions is None else []
    planners, options = asked.of(looked.problem, seed, names)
    calls = None if actions is None else read_actions(actions, looked.domain, looked.problem)
    with located_in(*given.sources), planning_refused(given.sources), timed(seconds, "ground"):
        job = requested(
            looked.domain,
            looked.problem,
            planners,
            options,
            objective=asked.objective,
            calls=calls,
            left_out=looked.left_out,
        )
    return job, calls or ()


def _margin(job: PlanningRequest) -> float:
    """What PRADA asks of a plan, with the usual value where the planner has no such option."""
    own = job.planners[0].own
    return own.margin if isinstance(own, PradaOptions) else PradaOptions().margin


def _forecast(
    job: PlanningRequest, actions: Sequence[int], wanted: bool, seconds: dict[str, float]
) -> Forecast | None:
    if not wanted:
        return None
    with timed(seconds, "explain"):
        return forecast(job.prepared, actions, job.options.seed)


def _dictionary(result: PlanResult | EvaluationResult, without: Sequence[str] = ()) -> dict[str, object]:
    """All of a result; what was not asked for is not there."""
    return fields_of(result, without if result.explained is not None else (*without, "explained"))
