"""The workcell whose world is the rules themselves: what comes of an action is drawn from them."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from cleancli.compiler.task import GroundAction, GroundState
from cleancli.execution.episode_state import ActionKey, Move, Situation
from cleancli.execution.events import StrokeEnded
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.workcell import LookResult, Motion, Motions
from cleancli.language.model import Problem
from cleancli.motion.path import ToolPath
from cleancli.perception.tracking import Stroke
from cleancli.simulation.episode import returns
from cleancli.simulation.symbolic_world import DrawnStep, World, do, succeeded


class SymbolicCell:
    """A `Workcell` with all facts in view. The n-th move meets the same random numbers whichever it is, so
    `assignment` and `clock`, which may be set, are all that there is to remember. What was paid is told of
    the moves since the cell was opened."""

    def __init__(self, world: World, problem: Problem, seed: int) -> None:
        self._world, self._problem = world, problem
        self._seed = derived(seed, Stream.WORLD)
        self.assignment: GroundState = world.task.initial
        self.clock = 0.0
        self._drawn: list[DrawnStep] = []

    @property
    def tool(self) -> tuple[float, float] | None:
        """None: nothing has a place here."""
        return None

    def look(self, before: Situation | None, stroke: Stroke | None, number: int, named: int) -> LookResult:
        """All facts."""
        started = time.perf_counter()
        situation = Situation((), self._problem.objects, self._world.facts(self.assignment))
        return LookResult(situation, None, named, time.perf_counter() - started)

    def problem(self, situation: Situation) -> Problem:
        """The problem with the facts that hold now."""
        return replace(self._problem, state=situation.state)

    def is_done(self, situation: Situation) -> bool:
        """Whether the goal holds, or nothing is left of the count that the reward wants decreased."""
        return bool(succeeded(self._world, self.assignment))

    def seconds(self, situation: Situation, actions: Iterable[GroundAction]) -> Mapping[ActionKey, float]:
        """None: the domain says it."""
        return {}

    def path(self, move: Move, situation: Situation, vain: int = 0) -> ToolPath | None:
        """None: nothing has a place here."""
        return None

    def carry_out(self, number: int, move: Move, path: ToolPath | None) -> Motion:
        """Draw an outcome; the clock goes on by the action's duration, if one is declared."""
        action = GroundAction(move.action, move.objects, None)
        step, self.assignment = do(
            self._world, self.assignment, action, np.random.default_rng((self._seed, number))
        )
        self._drawn.append(step)
        seconds = step.seconds or 0.0
        self.clock += seconds
        yield StrokeEnded(number, self.clock)
        return Motions(0.0, seconds)

    def withdraw(self) -> Motion:
        """Nothing is in the way here."""
        yield from ()
        return Motions(0.0, 0.0)

    def discounted_return(self, length: int) -> float:
        """What `length` steps pay if nothing more is done (`simulation.episode.returns`)."""
        waits = (0.0,) * (len(self._drawn) + 1)
        discounted, _ = returns(self._world, self._drawn, waits, self.assignment, length)
        return discounted
