"""Who acts in closed loop: it is shown all facts of a state and says what to do."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Protocol

from cleancli.compiler.ground import ground
from cleancli.compiler.task import GroundState
from cleancli.language.model import Domain, Object, Problem, State
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.objective import aimed
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planner import Plans
from cleancli.planning.reductions.subproblem import fewer
from cleancli.simulation.symbolic_world import assignment_of, unchanging_facts


class Acting(Protocol):
    """Whoever says what to do in the symbolic world."""

    def plan(self, facts: State, options: Options, horizon: int | None = None) -> tuple[Plan, float]:
        """What to do from these facts on, and how many seconds it took to say."""


@dataclass(frozen=True, slots=True)
class _View:
    """The rules grounded for all states that differ in what they can change; `rest` are the facts that they
    can't, `objects` those that are planned for."""

    prepared: Prepared
    rest: State
    objects: tuple[Object, ...]

    def assignment(self, problem: Problem) -> GroundState | None:
        """The problem's state; None where it is not one of the view's."""
        if problem.objects != self.objects:
            return None
        if unchanging_facts(self.prepared.task, problem.state) != self.rest:
            return None
        return assignment_of(self.prepared.task, problem.state)


class Agent:
    """A planner with rules of its own that sees all. Grounds them again only where other rules have changed
    what these can't."""

    def __init__(
        self, planner: Plans, domain: Domain, problem: Problem, objective: str | None = None
    ) -> None:
        self._planner = planner
        self._domain, self._problem, self._objective = domain, problem, objective
        self._views: list[_View] = []

    def plan(self, facts: State, options: Options, horizon: int | None = None) -> tuple[Plan, float]:
        """What to do from these facts on, and how long it took to say; what numba took to load is left out.

        The horizon is the one of these facts unless one is given. Raises `Refused` (E6xx),
        `NoDurationError`, and what the planner raises.
        """
        started = time.perf_counter()
        plan = self._planner(self.prepared(facts, options.counted, horizon), options)
        return plan, time.perf_counter() - started - plan.seconds.get("compile", 0.0)

    def prepared(self, facts: State, counted: int, horizon: int | None = None) -> Prepared:
        """The planner's task from these facts on, for at most so many of what the reward counts."""
        problem = fewer(self._domain, replace(self._problem, state=facts), counted).problem
        for view in self._views:
            assignment = view.assignment(problem)
            if assignment is not None:
                return view.prepared.at(assignment, horizon)
        task = ground(self._domain, problem)
        task = aimed(task, self._objective)
        self._views.append(_View(prepare(task), unchanging_facts(task, problem.state), problem.objects))
        return self._views[-1].prepared.at(task.initial, horizon)
