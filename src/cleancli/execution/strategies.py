"""The table of strategies (§6): what to do next, from what is believed. None has a memory of its own.

Strategies share perception, skills and clock; they differ in nothing but the moves they choose.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Objective, lasting, without
from cleancli.execution.baselines import gather_all, nearest_first, wipe_all
from cleancli.execution.episode_state import Move
from cleancli.execution.setup import Decision, DecisionContext, EpisodeOptions
from cleancli.planning.compiled_task import prepare
from cleancli.planning.objective import aimed
from cleancli.planning.plan import Options
from cleancli.planning.reductions.subproblem import fewer
from cleancli.planning.registry import DEFAULT, PLANNERS


@dataclass(frozen=True, slots=True)
class Strategy:
    """`decide` says what to do; `needs_places`: it thinks of where things are, so that the symbolic world
    has nothing for it. `planner` is the one it plans with where none is asked for; None: it does not plan."""

    decide: Callable[[DecisionContext, EpisodeOptions], Decision]
    needs_places: bool = False
    planner: str | None = None


def _plan(now: DecisionContext, options: EpisodeOptions, planner: str, commit: int | None) -> Decision:
    """Plan, and carry out the first `commit` actions before planning again (§4.2.4); None: all of them."""
    asked = Options(options.samples, now.seed, previous=now.rest)
    problem = fewer(now.domain, now.problem, asked.counted).problem
    task = without(ground(now.domain, problem), now.excluded)
    if options.by_time or task.price:
        task = lasting(task, now.seconds(task.actions))
    if options.by_time:
        task = aimed(task, Objective.TIME.value)
    plan = PLANNERS[options.planner or planner](prepare(task), asked)
    chosen = plan.actions[:commit]
    moves = tuple(Move(action.name, action.objects) for action in chosen)
    return Decision(moves, plan.actions[len(chosen) :], plan, plan.seconds.get("compile", 0.0))


def _planning(commit: int | None, planner: str = DEFAULT) -> Strategy:
    return Strategy(lambda now, options: _plan(now, options, planner, commit), planner=planner)


STRATEGIES: Mapping[str, Strategy] = MappingProxyType(
    {
        "plan-1": _planning(1),
        "plan-2": _planning(2),
        "plan-3": _planning(3),
        "plan-all": _planning(None),
        # FF-Replan (Yoon, Fern and Givan 2007), with the determinization that knows of all outcomes.
        "determinized": _planning(2, "all-outcomes"),
        "reactive": Strategy(nearest_first, needs_places=True),
        "wipe": Strategy(wipe_all, needs_places=True),
        "tsp": Strategy(gather_all, needs_places=True),
    }
)
