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
from cleancli.language.model import Domain
from cleancli.learning.exploration.narrowed import narrowed
from cleancli.learning.exploration.seeking import next_try
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
    Where a teacher can be asked it is the other way round: towards the goal, or else try where that is likely
    to show more than it costs to ask."""
    if options.is_taught:
        planned = _plan(replace(now, domain=_surely(now)), options, DEFAULT, 1)
        return planned if planned.moves else _try(now, options, min(options.known, UNASKED)) or planned
    return _try(now, options, options.known) or _plan(now, options, DEFAULT, 1)


def _surely(now: DecisionContext) -> Domain:
    """What the robot can do, by rules as narrow as experience asks for."""
    assert now.explored is not None, "a teacher is asked where whole rules are learned"
    return within(now.domain, narrowed(now.explored))


def _try(now: DecisionContext, options: EpisodeOptions, known: int) -> Decision | None:
    """Try what is known by fewer examples, or go where that can be tried; with a teacher no action that has
    changed nothing yet. None where there is no such try."""
    assert now.explored is not None, "asking for it asks for learning whole rules"
    domain = now.domain
    if options.is_taught:
        useful = {name for name, each in now.explored.actions.items() if each.changed.any()}
        domain = replace(domain, actions=tuple(each for each in domain.actions if each.name in useful))
    feasible = replace(now.explored, domain=domain)
    planner, asked = PLANNERS[options.planner or DEFAULT], Options(options.samples, now.seed)
    chosen = next_try(feasible, now.problem, known, planner, asked, now.excluded)
    return None if chosen is None else Decision((Move(chosen.action, chosen.objects),))


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
