"""What is told where a goal was not reached: a longer horizon, or that no action can lead to it."""

from __future__ import annotations

from cleancli.compiler.ground import ground
from cleancli.compiler.short_horizon import goal_distance, longer_horizon
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Problem
from cleancli.planning.reductions.subproblem import fewer


def is_hopeless(world: Domain, problem: Problem) -> bool:
    """Whether it is certain that no actions by the rules of the world lead to the goal. Of a problem that is
    too large to be grounded nothing is known, though a run of it needs no grounding."""
    try:
        return goal_distance(ground(world, problem)).least is None
    except Refused:
        return False


def first_and_longer(domain: Domain, problem: Problem, counted: int) -> tuple[int, int]:
    """The horizon of the first plan, for so many counted areas, and a longer one to try. Raises Refused for
    what no plan is made of either."""
    task = ground(domain, fewer(domain, problem, counted).problem)
    return task.horizon, longer_horizon(task)
