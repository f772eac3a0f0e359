"""What is told of a problem's goal: how likely it is reached and, where it was not, a longer horizon or that
no action can lead to it."""

from __future__ import annotations

from collections.abc import Iterator

from cleancli.compiler.ground import ground
from cleancli.compiler.short_horizon import longer_horizon, out_of_reach
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Problem
from cleancli.planning.evaluation.goal_chance import GoalChance, goal_chance
from cleancli.planning.policy import Policy
from cleancli.planning.reductions.subproblem import fewer
from cleancli.planning.request import PlanningRequest

HOPELESS = "the goal is out of reach, whatever is done: it holds in no state that actions may lead to"
"""Where all states are known that actions may lead to."""

_DEAD_END = (
    "the goal can no longer be reached, whatever is done: it holds in no state that actions may still lead to"
)
"""Where that is so of the state that was reached, and was not of the first one."""

_TOO_FEW = (
    "the problem states no horizon, and {within} may be too few: write for example `horizon = {longer}`"
)
"""Beside what the usual horizon may have cut short."""


def is_hopeless(world: Domain, problem: Problem) -> bool:
    """Whether it is certain that no actions by the rules of the world lead to the goal, if there is one. Of a
    problem that is too large to be grounded nothing is known, though a run of it needs no grounding."""
    if not problem.goal:
        return False
    try:
        return out_of_reach(ground(world, problem), problem)
    except Refused:
        return False


def first_and_longer(domain: Domain, problem: Problem, counted: int) -> tuple[int, int]:
    """The horizon of the first plan, for so many counted areas, and a longer one to try. Raises Refused for
    what no plan is made of either."""
    task = ground(domain, fewer(domain, problem, counted).problem)
    return task.horizon, longer_horizon(task)


def too_few(steps: int, longer: int) -> str:
    """What helps where the usual horizon, of so many steps, may be too short for a problem's goal: a longer
    one."""
    return _TOO_FEW.format(within=plural(steps, "action"), longer=longer)


def unreached_lines(
    hopeless: bool, first_and_longer: tuple[int, int] | None, dead_end: bool = False
) -> Iterator[str]:
    """What is told of a goal that was not reached: that it is out of reach, or became so in a `dead_end`, or
    else the horizon of the first plan and a longer one."""
    if hopeless:
        yield HOPELESS
    elif dead_end:
        yield _DEAD_END
    elif first_and_longer is not None:
        yield too_few(*first_and_longer)


def chance_line(chance: GoalChance, horizon: int | None) -> str:
    """How likely the goal is reached within a horizon."""
    how = f" (± {chance.error:z.2g}, {chance.runs} drawn runs)" if chance.runs else ""
    digits = 3 if chance.runs else 6
    within = plural(horizon or 0, "action")
    return f"reaches the goal with probability {chance.probability:z.{digits}g}{how} within {within}"


def chance_of(job: PlanningRequest, policy: Policy) -> GoalChance | None:
    """How likely a policy reaches the goal; None where the problem has none."""
    if not job.problem.goal or job.options.compat:  # there, rules may overlap
        return None
    return goal_chance(job.task, policy, job.options.seed)
