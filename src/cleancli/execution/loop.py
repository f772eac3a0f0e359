"""The observe-plan-act loop (§4.2.3, §4.2.4) as a generator of events.

It knows the robot only through `Robot`, and the table only through what perception reports.
"""

from __future__ import annotations

import time
from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cleancli.compiler.ground import ground
from cleancli.compiler.task import GroundAction, by_time
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
from cleancli.language.model import Domain, Problem
from cleancli.learning.experience import Transition
from cleancli.motion.actions import can_execute, tool_path
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area
from cleancli.perception.perceive import perceive
from cleancli.perception.surface import NoSurface
from cleancli.perception.symbols import remembered, symbolize
from cleancli.perception.tracking import Stroke, track
from cleancli.planning.plan import Options, Plan
from cleancli.planning.prepared import prepare
from cleancli.planning.table import DEFAULT, PLANNERS
from cleancli.scene.model import Scene
from cleancli.world.robot import Robot, Status

CLEAN = "no dirt is seen any more"

FRAMES_PER_LOOK = 3
"""Frames whose dirty pixels must agree before they count (§3.1, "Noise removal")."""


@dataclass(frozen=True, slots=True)
class EpisodeOptions:
    """`commit`: actions of a plan carried out before the next one is made (§4.2.4). `by_time`: plans discount
    by how long actions take, not by their number."""

    planner: str = DEFAULT
    samples: int = 10_000
    commit: int = 2
    max_actions: int = 60
    seed: int = 1
    by_time: bool = False


def within_reach(domain: Domain, robot: str) -> Domain:
    """The domain without the actions that a robot of that name has no skill for, and without their rules."""
    actions = tuple(a for a in domain.actions if can_execute(a.name, len(a.parameters), robot))
    names = {action.name for action in actions}
    return replace(domain, actions=actions, rules=tuple(r for r in domain.rules if r.action in names))


def clean(domain: Domain, scene: Scene, robot: Robot, options: EpisodeOptions) -> Generator[Event]:
    """Clean the table: look, plan, carry out the first actions, look again, until no dirt is seen.

    Ends, always with `Ended`, when two looks in a row show no dirt, when the planner finds nothing worth
    doing, when the robot cannot follow a path, when the camera shows no table, or after `max_actions`.
    """
    episode = Episode(domain, scene, robot, options)
    try:
        reason = yield from _until_clean(episode, robot, options)
    except NoSurface as error:
        reason = str(error)
    yield episode.ended(reason, clean=reason == CLEAN)


def _until_clean(episode: Episode, robot: Robot, options: EpisodeOptions) -> Generator[Event, None, str]:
    """Returns why the episode is over."""
    yield from episode.withdraw()
    situation = yield from episode.look()
    while True:
        if not situation.areas:
            situation = yield from episode.look()
        if not situation.areas:
            return CLEAN
        if episode.actions >= options.max_actions:
            return f"the limit of {options.max_actions} actions is reached"
        plan = yield from episode.plan(situation)
        if not plan.actions:
            return "the planner finds nothing worth doing"
        for action in plan.actions[: min(options.commit, options.max_actions - episode.actions)]:
            if not {area.name for area in situation.areas}.issuperset(action.objects):
                break
            after = yield from episode.act(action, situation)
            if after is None:
                return f"the robot could not carry out {action}: {robot.failure}"
            situation = after


def look_once(domain: Domain, scene: Scene, robot: Robot, seed: int) -> Problem:
    """Withdraw the tool, look at the table once, and say what there is to plan for."""
    episode = Episode(domain, scene, robot, EpisodeOptions(seed=seed))
    for _ in episode.withdraw():
        pass
    situation = next(event.situation for event in episode.look() if isinstance(event, Looked))
    return problem_of(scene, domain, situation)


def problem_of(scene: Scene, domain: Domain, situation: Situation) -> Problem:
    """The areas seen now as a problem, with the default horizon (§4.2.2)."""
    return Problem(scene.name, domain.name, situation.objects, situation.state)


class Episode:
    """The mutable part of a run: time spent by kind, actions done, and how many areas have been named."""

    def __init__(self, domain: Domain, scene: Scene, robot: Robot, options: EpisodeOptions) -> None:
        self._domain, self._feasible = domain, within_reach(domain, scene.robot)
        self._scene, self._robot, self._options = scene, robot, options
        self._rng = np.random.default_rng(derived(options.seed, Purpose.PERCEPTION))
        self._planning_seed = derived(options.seed, Purpose.PLANNING)
        kinds = ("acting", "withdrawing", "planning", "compiling", "perceiving")
        self._seconds = dict.fromkeys(kinds, 0.0)
        self._named = 0
        self._rest: tuple[GroundAction, ...] = ()
        self.actions = 0

    def withdraw(self) -> Generator[Event]:
        """Move the tool out of the camera's view."""
        started = self._robot.clock
        self._robot.withdraw()
        while self._robot.poll() is Status.RUNNING:
            yield Moved(self._robot.clock)
        self._seconds["withdrawing"] += self._robot.clock - started

    def look(
        self, before: Sequence[Area] = (), stroke: Stroke | None = None
    ) -> Generator[Event, None, Situation]:
        """See the table, and name its areas as what has become of those `before`."""
        started = time.perf_counter()
        frames = [self._robot.observe() for _ in range(FRAMES_PER_LOOK)]
        observation = perceive(frames, self._scene, self._rng)
        areas = track(before, observation.areas, stroke, self._named + 1)
        self._named = max([self._named, *(int(area.name[1:]) for area in areas)])
        objects, state = symbolize(areas, self._scene, self._domain)
        seconds = time.perf_counter() - started
        self._seconds["perceiving"] += seconds
        situation = Situation(frames[-1], areas, objects, state)
        yield Looked(situation, seconds)
        return situation

    def plan(self, situation: Situation) -> Generator[Event, None, Plan]:
        """Ask the planner what to do about the areas seen now."""
        started = time.perf_counter()
        problem = problem_of(self._scene, self._domain, situation)
        # Every plan draws its own sequences: the seed of a run and the number of actions done name them.
        seed = self._planning_seed + self.actions
        options = Options(self._options.samples, seed, previous=self._rest)
        task = ground(self._feasible, problem)
        if self._options.by_time:
            task = by_time(task)
        plan = PLANNERS[self._options.planner](prepare(task), options)
        self._rest = plan.actions[self._options.commit :]
        # Loading the kernel is no planning: it happens once, and takes long on the very first run only.
        compiling = plan.seconds.get("compile", 0.0)
        seconds = time.perf_counter() - started - compiling
        self._seconds["compiling"] += compiling
        self._seconds["planning"] += seconds
        yield Planned(situation, plan, seconds)
        return plan

    def act(self, action: GroundAction, before: Situation) -> Generator[Event, None, Situation | None]:
        """Carry out an action and see what came of it; None if the robot failed to follow its path."""
        self.actions += 1
        ellipses = {area.name: area.ellipse for area in before.areas}
        path = tool_path(action.name, tuple(ellipses[name] for name in action.objects), self._scene)
        started = self._robot.clock
        yield Started(self.actions, action.name, action.objects, path)
        self._robot.start(path)
        while (status := self._robot.poll()) is Status.RUNNING:
            yield Moved(self._robot.clock)
        seconds = self._robot.clock - started
        self._seconds["acting"] += seconds
        if status is Status.FAILED:
            self._robot.stop()
            return None
        yield StrokeEnded(self.actions, self._robot.clock)
        yield from self.withdraw()
        after = yield from self.look(before.areas, _stroke(action, path, self._scene))
        yield Acted(self.actions, _transition(action, before, after), seconds, after)
        return after

    def ended(self, reason: str, clean: bool) -> Ended:
        """The closing event, with the account of time."""
        return Ended(reason, clean, self.actions, dict(self._seconds))


def _stroke(action: GroundAction, path: ToolPath, scene: Scene) -> Stroke:
    """Where the rag went and what it was meant to push, for naming what is left of it."""
    on_surface = tuple((w.x, w.y) for w in path.waypoints if w.z <= 0)
    return Stroke(action.objects, on_surface, scene.rag.width / 2)


def _transition(action: GroundAction, before: Situation, after: Situation) -> Transition:
    """What was seen before and after, over all objects of both; those gone are remembered as clean."""
    objects = tuple(sorted({*before.objects, *after.objects}))
    gone = {o.name for o in before.objects} - {o.name for o in after.objects}
    return Transition(
        action.name, action.objects, objects, before.state, after.state | remembered(before.state, gone)
    )
