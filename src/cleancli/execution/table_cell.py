"""The workcell with a robot, a table and a camera above it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import islice, product
from math import dist

import numpy as np

from cleancli.compiler.task import GroundAction
from cleancli.execution.episode_state import ActionKey, Move, Situation
from cleancli.execution.events import Moved, StrokeEnded
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.workcell import LookResult, Motion, Motions
from cleancli.geometry.rgbd import Frame
from cleancli.language.model import Domain, Problem, usual_discount, without_objects
from cleancli.motion.actions import TO_ZONE, WIPES, tool_paths
from cleancli.motion.duration import expected_seconds
from cleancli.motion.path import ToolPath, pressed
from cleancli.perception.look import FRAMES_PER_LOOK, understood
from cleancli.perception.occlusion import MOSTLY
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.tracking import Stroke
from cleancli.scene.model import Scene
from cleancli.world.robot import Mover, Robot, Status, polled

FURTHER = 1e-3
"""Metres by which the rag is pressed further after each try in vain. Chosen: about half the error of its
height (docs/world.md), from which most of such tries come."""

SURELY = (2.0, 1.0, 0.0)
"""Standard deviations of the robot's errors with which it can follow the way that is taken, if there is one:
the most that it can. Chosen."""

ARRIVED = 0.02
"""Metres from a path's first waypoint at which the transit to it is over; errors of the tool stay below."""


class DrivenCell:
    """What workcells with a table have in common: all but `look`. Knows the robot through `Mover` alone."""

    def __init__(self, domain: Domain, scene: Scene, robot: Mover) -> None:
        self._domain, self._scene, self._robot = domain, scene, robot

    @property
    def clock(self) -> float:
        """Seconds of robot time since the start."""
        return self._robot.clock

    @property
    def tool(self) -> tuple[float, float] | None:
        """Where the robot says that its tool is."""
        x, y, _ = self._robot.tool
        return x, y

    def _told(
        self,
        frames: tuple[Frame, ...],
        observation: Observation,
        before: Situation | None,
        stroke: Stroke | None,
        named: int,
        started: float,
    ) -> LookResult:
        """What an observation tells the loop; `started`: when the computing for it began."""
        areas = () if before is None else before.areas
        look = understood(frames, observation, self._scene, self._domain, areas, stroke, named + 1)
        known = look.known
        unseen = frozenset(name for name, hidden in known.hidden.items() if hidden >= MOSTLY)
        situation = Situation(
            known.areas, look.objects, look.state, unseen, known.unseen.share, look.left_out
        )
        seconds = time.perf_counter() - started
        return LookResult(situation, frames[-1] if frames else None, known.next_number - 1, seconds)

    def problem(self, situation: Situation) -> Problem:
        """The areas, up to the scene's limit, as a problem with the default horizon (§4.2.2)."""
        seen = Problem(
            self._scene.name,
            self._domain.name,
            situation.objects,
            situation.state,
            discount=usual_discount(self._domain),
        )
        return without_objects(seen, situation.left_out)

    def is_done(self, situation: Situation) -> bool:
        """Whether no dirt is believed to be there."""
        return not situation.areas

    def seconds(self, situation: Situation, actions: Iterable[GroundAction]) -> Mapping[ActionKey, float]:
        """By the paths that they would have now. Picking up is left out: most of it is the dustpan's way."""
        paths = ((action, next(self._paths(Move(*action.key), situation))) for action in actions)
        return {
            action.key: expected_seconds(path, self._start(action.name))
            for action, path in paths
            if path.dustpan is None
        }

    def _start(self, action: str) -> tuple[float, float]:
        """Where an action is expected to find the tool: above the container, where most actions end, or, as
        wiping ends anywhere, above the middle of the surface; pushes into a zone end there."""
        if action in WIPES:
            return 0.0, 0.0
        if action in TO_ZONE and self._scene.zone is not None:
            return self._scene.zone.centre
        (x0, y0), (x1, y1) = self._scene.mouth()
        return (x0 + x1) / 2, (y0 + y1) / 2

    def path(self, move: Move, situation: Situation, vain: int = 0) -> ToolPath | None:
        """The move's own path, or that of its action upon the areas where they are seen now: the best of
        several that the robot can follow. What was in vain is not repeated unchanged: another way is taken,
        or else the rag is pressed further each time."""
        if move.path is not None:
            return pressed(move.path, vain * FURTHER)
        best, *others = self._paths(move, situation)
        if not others:
            return pressed(best, vain * FURTHER)
        return next(islice(self._followed((best, *others)), vain, None), best)

    def _followed(self, paths: Iterable[ToolPath]) -> Iterator[ToolPath]:
        """Those that the robot can follow, the most surely first; each once."""
        told: set[ToolPath] = set()
        for errors, path in product(SURELY, tuple(paths)):
            if path not in told and self._robot.can_follow(path, errors):
                told.add(path)
                yield path

    def _paths(self, move: Move, situation: Situation) -> Iterator[ToolPath]:
        """Paths of an action upon the areas where they are seen now, the best first."""
        ellipses = {area.name: area.ellipse for area in situation.areas}
        others = [ellipse for name, ellipse in ellipses.items() if name not in move.objects]
        areas = tuple(ellipses[name] for name in move.objects)
        return tool_paths(move.action, areas, self._scene, others)

    def carry_out(self, number: int, move: Move, path: ToolPath | None) -> Motion:
        """Follow the path; its failure ends with the tool raised."""
        assert path is not None, "a table's moves have paths"
        started = self._robot.clock
        first = path.waypoints[0]
        motions = yield from self._driven(lambda: self._robot.start(path), (first.x, first.y, first.z))
        if not motions.failure:
            yield StrokeEnded(number, self._robot.clock)
        seconds = self._robot.clock - started - motions.transit
        if motions.failure and not seconds:
            return motions
        on_surface = tuple((w.x, w.y) for w in path.waypoints if w.z <= 0)
        stroke = Stroke(move.objects, on_surface, self._scene.rag.width / 2)
        return Motions(motions.transit, seconds, motions.failure, stroke)

    def withdraw(self) -> Motion:
        """To the resting pose; all of it is transit."""
        motions = yield from self._driven(self._robot.withdraw, None)
        return motions

    def _driven(self, begin: Callable[[], None], first: tuple[float, float, float] | None) -> Motion:
        """Begin a motion and poll it to its end; `first` is where its stroke begins, if it has one."""
        started = self._robot.clock
        arrived = None
        begin()
        for status in polled(self._robot):
            if status is not Status.RUNNING:
                break
            if first is not None and arrived is None and dist(self._robot.tool, first) <= ARRIVED:
                arrived = self._robot.clock
            yield Moved(self._robot.clock)
        failure = "" if status is Status.DONE else self._robot.failure
        if status is Status.RUNNING:
            failure = "the motion does not end"
        if failure:
            self._robot.stop()
        ended = self._robot.clock
        arrived = ended if arrived is None else arrived
        return Motions(arrived - started, ended - arrived, failure)


class TableCell(DrivenCell):
    """A `Workcell` that knows the robot only through `Robot`, and the table only through what perception
    reports."""

    def __init__(self, domain: Domain, scene: Scene, robot: Robot, seed: int) -> None:
        super().__init__(domain, scene, robot)
        self._camera, self._seed = robot, derived(seed, Stream.PERCEPTION)

    def look(self, before: Situation | None, stroke: Stroke | None, number: int, named: int) -> LookResult:
        """Frames, areas, names, symbols."""
        frames = tuple(self._camera.observe() for _ in range(FRAMES_PER_LOOK))
        started = time.perf_counter()
        observation = perceive(frames, self._scene, np.random.default_rng((self._seed, number)))
        return self._told(frames, observation, before, stroke, named, started)


def look_once(domain: Domain, scene: Scene, robot: Robot, seed: int) -> tuple[Problem, tuple[str, ...]]:
    """Move the arm out of view, look at the table once, and say what there is to plan for, and which areas
    the scene leaves out of plans."""
    cell = TableCell(domain, scene, robot, seed)
    for _ in cell.withdraw():
        pass
    situation = cell.look(None, None, 0, 0).situation
    return cell.problem(situation), situation.left_out
