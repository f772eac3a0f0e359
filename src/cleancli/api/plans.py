"""Plans for a problem, or for what one look at a scene shows."""

from __future__ import annotations

from collections.abc import Mapping

from cleancli.api.asked import Asked, named, planning_request
from cleancli.api.checks import check_one_of
from cleancli.api.expected import expected_of, timed_forecast
from cleancli.api.goals import chance_of
from cleancli.api.inputs import GivenDomain, GivenProblem, load_problem
from cleancli.api.plan_result import PlanBranch, PlanResult
from cleancli.api.seen import seen
from cleancli.compiler.semantics import reaches_goal
from cleancli.compiler.short_horizon import longer_horizon, out_of_reach
from cleancli.compiler.task import literal_text
from cleancli.language.load import located_in
from cleancli.language.model import Horizon
from cleancli.planning.choice import planner_named
from cleancli.planning.evaluation.forecast import Forecast
from cleancli.planning.evaluation.goal_chance import GoalChance
from cleancli.planning.plan import Branch, Plan
from cleancli.planning.planners.prada import PradaOptions
from cleancli.planning.policy import Policy, sequence
from cleancli.planning.refusal import planning_refused
from cleancli.planning.registry import PLANNERS
from cleancli.planning.request import PlanningRequest, numbered, why_nothing
from cleancli.planning.trajectory import branches

LIKELY = 0.5
"""A plan that would use more steps and reaches the goal less often than this is told as short. Chosen."""


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
    looked, seed = seen(given, seed, seconds)
    planners = (planner_named(planner, looked.problem),)
    job, _ = planning_request(looked, seed, asked, planners, given.sources, seconds)
    with located_in(*given.sources), planning_refused(given.sources):
        found = job.planners[0](job.prepared, job.options)
        seconds |= found.seconds
        actions = numbered(job.task, [(action.name, action.objects) for action in found.actions])
        return plan_result(job, found, timed_forecast(job, actions, explain, seconds), seconds)


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
        guessed_horizon=isinstance(job.problem.horizon, Horizon) and job.problem.horizon.is_guess,
        longer_horizon=longer_horizon(job.task) if short else None,
        hopeless=hopeless,
        astray=_is_astray(job, found.policy, chance),
    )


def _goal_chance(job: PlanningRequest, found: Plan) -> GoalChance | None:
    """That of the plan's policy, or of its sequence."""
    if found.reached is not None:
        return GoalChance(found.reached.probability, found.reached.probability_error, None)
    actions = tuple(numbered(job.task, [action.key for action in found.actions]))
    return chance_of(job, found.policy or sequence(job.task.initial, actions))


def _is_hopeless(job: PlanningRequest, chance: GoalChance | None) -> bool:
    """Whether it is known that the goal is never reached; of a problem made smaller that would not be known
    of the whole."""
    if chance is None or chance.probability or job.ignored or job.left_out:
        return False
    return out_of_reach(job.task, job.problem)


def _is_astray(job: PlanningRequest, policy: Policy | None, chance: GoalChance | None) -> bool:
    """Whether no state on the likeliest course of a policy satisfies the goal, which it reaches on other
    ways."""
    if policy is None or chance is None or not chance.probability:
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


def _margin(job: PlanningRequest) -> float:
    """What PRADA asks of a plan, with the usual value where the planner has no such option."""
    own = job.planners[0].own
    return own.margin if isinstance(own, PradaOptions) else PradaOptions().margin


BRANCHES = 5
"""Branches of a policy that a plan tells, the likeliest. Chosen."""
