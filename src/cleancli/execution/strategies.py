"""The table of strategies (§6): what to do next, from what is believed. None has a memory of its own.

Strategies share perception, skills and clock; they differ in nothing but the moves they choose.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Objective, lasting, without
from cleancli.execution.baselines import gather_all, nearest_first, wipe_all
from cleancli.execution.episode_state import Move
from cleancli.execution.setup import Decision, DecisionContext, EpisodeOptions, within
from cleancli.learning.exploration.narrowed import narrowed
from cleancli.learning.exploration.seeking import next_try
from cleancli.learning.exploration.worth import Try, least_worth
from cleancli.planning.compiled_task import prepare
from cleancli.planning.objective import aimed
from cleancli.planning.plan import Options
from cleancli.planning.reductions.subproblem import fewer
from cleancli.planning.registry import DEFAULT, PLANNERS

UNASKED = 3
"""Examples by which a rule must be known before a teacher is asked, where one can be; chosen by trying
(benchmarks/demonstrations.py)."""


@dataclass(frozen=True, slots=True)
class Strategy:
    """`decide` says what to do; `needs_places`: it thinks of where things are, so that the symbolic world
    has nothing for it. `planner` is the one it plans with where none is asked for; None: it does not plan.
    `learns_rules`: it goes by what whole rules rest on."""

    decide: Callable[[DecisionContext, EpisodeOptions], Decision]
    needs_places: bool = False
    planner: str | None = None
    learns_rules: bool = False


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


def _explore(now: DecisionContext, options: EpisodeOptions) -> Decision:
    """Try what is not known, or go where it can be tried; towards the goal where all on the way is known.
    Where a teacher can be asked it is the other way round."""
    if options.is_taught:
        return _learn_of_teacher(now, options)
    chosen = _next_try(now, options, options.known)
    return _plan(now, options, DEFAULT, 1) if chosen is None else _carry_out(chosen)


def _learn_of_teacher(now: DecisionContext, options: EpisodeOptions) -> Decision:
    """Towards the goal by narrowed rules, or else try what has changed something before, where that is likely
    to show more than it costs to ask; no move where it is not."""
    assert now.explored is not None, "a teacher is asked where whole rules are learned"
    seen = now.explored.actions
    now = replace(now, domain=within(now.domain, narrowed(now.explored)))
    planned = _plan(now, options, DEFAULT, 1)
    if planned.moves:
        return planned
    known = min(options.known, UNASKED)
    useful = tuple(a for a in now.domain.actions if a.name in seen and seen[a.name].changed.any())
    chosen = _next_try(replace(now, domain=replace(now.domain, actions=useful)), options, known)
    return planned if chosen is None or chosen.worth < least_worth(known) else _carry_out(chosen)


def _next_try(now: DecisionContext, options: EpisodeOptions, known: int) -> Try | None:
    """What to try of that which is known by fewer examples, or how to go where that can be tried."""
    assert now.explored is not None, "asking for it asks for learning whole rules"
    feasible = replace(now.explored, domain=now.domain)
    planner, asked = PLANNERS[options.planner or DEFAULT], Options(options.samples, now.seed)
    return next_try(feasible, now.problem, known, planner, asked, now.excluded)


def _carry_out(chosen: Try) -> Decision:
    return Decision((Move(chosen.action, chosen.objects),))


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
        "explore": Strategy(_explore, planner=DEFAULT, learns_rules=True),
        "reactive": Strategy(nearest_first, needs_places=True),
        "wipe": Strategy(wipe_all, needs_places=True),
        "tsp": Strategy(gather_all, needs_places=True),
    }
)
