"""The observe-plan-act loop (§4.2.3, §4.2.4) as a generator of events.

It knows the robot only through `Robot`, and the table only through what perception reports.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from cleancli.compiler.ground import ground
from cleancli.compiler.task import GroundAction
from cleancli.execution.events import (
    Acted,
    Ended,
    Event,
    Looked,
    Moved,
    Planned,
    Situation,
    Started,
    StrokeEnded,
)
from cleancli.execution.seeds import Purpose, derived
from cleancli.language.model import Domain, Fact, Object, Problem, State
from cleancli.learning.experience import Transition
from cleancli.motion.actions import can_execute, stroke, tool_path
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area
from cleancli.perception.perceive import perceive
from cleancli.perception.symbols import DIRT, symbolize
from cleancli.perception.tracking import track
from cleancli.planning.plan import Options, Plan
from cleancli.planning.table import PLANNERS
from cleancli.scene.model import Scene
from cleancli.world.robot import Robot, Status

FRAMES_PER_LOOK = 3
"""Frames whose dirty pixels must agree before they count (§3.1, "Noise removal")."""


@dataclass(frozen=True, slots=True)
class EpisodeOptions:
    """`commit`: actions of a plan carried out before the next one is made (§4.2.4)."""

    planner: str = "prada"
    samples: int = 10_000
    commit: int = 2
    max_actions: int = 60
    seed: int = 1


def within_reach(domain: Domain) -> Domain:
    """The domain without the actions that this robot has no skill for, and without their rules."""
    actions = tuple(a for a in domain.actions if can_execute(a.name, len(a.parameters)))
    names = {action.name for action in actions}
    return replace(domain, actions=actions, rules=tuple(r for r in domain.rules if r.action in names))


def clean(domain: Domain, scene: Scene, robot: Robot, options: EpisodeOptions) -> Iterator[Event]:
    """Clean the table: look, plan, carry out the first actions, look again, until no dirt is seen.

    Ends, always with `Ended`, when two looks in a row show no dirt, when the planner finds nothing worth doing,
    when the robot cannot follow a path, or after `max_actions`.
    """
    episode = _Episode(domain, scene, robot, options)
    yield from episode.withdraw()
    situation = yield from episode.look()
    while True:
        if not situation.areas:
            situation = yield from episode.look()
            if not situation.areas:
                yield episode.ended("no dirt is seen any more", clean=True)
                return
        if episode.actions >= options.max_actions:
            yield episode.ended(f"the limit of {options.max_actions} actions is reached")
            return
        plan = yield from episode.plan(situation)
        if not plan.actions:
            yield episode.ended("the planner finds nothing worth doing")
            return
        for action in plan.actions[: min(options.commit, options.max_actions - episode.actions)]:
            if not {area.name for area in situation.areas}.issuperset(action.objects):
                break
            after = yield from episode.act(action, situation)
            if after is None:
                yield episode.ended(f"the robot could not carry out {action}")
                return
            situation = after


def first_look(domain: Domain, scene: Scene, robot: Robot, seed: int) -> Situation:
    """Withdraw the tool, look at the table once and say what is there."""
    episode = _Episode(domain, scene, robot, EpisodeOptions(seed=seed))
    for _ in episode.withdraw():
        pass
    return next(event for event in episode.look() if isinstance(event, Looked)).situation


def problem_of(scene: Scene, domain: Domain, situation: Situation) -> Problem:
    """What the planner is asked: the areas seen now, with the default horizon (§4.2.2)."""
    return Problem(scene.name, domain.name, situation.objects, situation.state)


class _Episode:
    """The mutable part of a running episode: clocks, counters and names of areas given so far."""

    def __init__(self, domain: Domain, scene: Scene, robot: Robot, options: EpisodeOptions) -> None:
        self._domain, self._feasible = domain, within_reach(domain)
        self._scene, self._robot, self._options = scene, robot, options
        self._rng = np.random.default_rng(derived(options.seed, Purpose.PERCEPTION))
        self._seconds = Counter[str]()
        self._named = 0
        self.actions = 0

    def withdraw(self) -> Iterator[Event]:
        """Move the tool out of the camera's view; as Moved events."""
        started = self._robot.clock
        self._robot.withdraw()
        while self._robot.poll() is Status.RUNNING:
            yield Moved(self._robot.clock)
        self._seconds["withdrawing"] += self._robot.clock - started

    def look(
        self, before: tuple[Area, ...] = (), moved: tuple[str, ...] = (), path: ToolPath | None = None
    ) -> Iterator[Event]:
        """See the table and name its areas as a continuation of those `before`."""
        started = time.perf_counter()
        frames = [self._robot.observe() for _ in range(FRAMES_PER_LOOK)]
        observation = perceive(frames, self._scene, self._rng)
        areas = track(before, observation.areas, moved, path)
        objects, state = symbolize(areas, self._scene, self._domain)
        situation = Situation(frames[-1], areas, objects, state)
        seconds = time.perf_counter() - started
        self._seconds["perceiving"] += seconds
        yield Looked(situation, seconds)
        return situation
