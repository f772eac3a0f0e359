"""One action, tried on a table of which nobody knows the truth: what the camera sees of the dirt that it was
meant for (§3.3.2)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Points
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.trials import GATHERING, Trial, TrialResult, chosen_areas, ended
from cleancli.geometry.ellipse import boundary
from cleancli.geometry.rgbd import Frame
from cleancli.motion.actions import ARITIES, tool_path
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area
from cleancli.perception.look import FRAMES_PER_LOOK
from cleancli.perception.perceive import perceive
from cleancli.perception.surface import NoSurface
from cleancli.perception.tracking import Stroke, track
from cleancli.scene.model import Scene
from cleancli.world.constants import INK_CELL
from cleancli.world.robot import Robot, Status, finish

Asks = Callable[[str, ToolPath | None], None]
"""Is told of a motion before it begins, with its path if it has one, and raises where it may not."""


@dataclass(frozen=True, slots=True)
class Aim:
    """What a look finds to act on: the last frame, all named areas, those that the action is for, and its
    path; None where there are too few of them."""

    frame: Frame
    areas: tuple[Area, ...]
    chosen: tuple[Area, ...]
    path: ToolPath | None


def aimed(scene: Scene, action: str, names: Sequence[str], robot: Robot, rng: np.random.Generator) -> Aim:
    """Look from where the arm is: at the areas of these `names`, or the first ones seen if there are none.
    Raises NoSkill, NoSurface, and RobotError."""
    frames = [robot.observe() for _ in range(FRAMES_PER_LOOK)]
    areas = track((), perceive(frames, scene, rng).areas, None, 1).areas
    chosen = chosen_areas(areas, names, ARITIES[action])
    others = [area.ellipse for area in areas if area not in chosen]
    if len(chosen) < ARITIES[action]:
        return Aim(frames[-1], areas, chosen, None)
    path = tool_path(action, tuple(area.ellipse for area in chosen), scene, others)
    return Aim(frames[-1], areas, chosen, path)


def attempt_seen(
    scene: Scene,
    action: str,
    names: Sequence[str],
    seed: int,
    robot: Robot,
    asks: Asks = lambda what, path: None,
) -> Trial:
    """Look with the arm out of view, carry the action out, and look again.

    Sizes are those of the dirt seen, in cells of 2 mm as of ink; what fell on the floor is not known. Raises
    NoSkill, NoSurface at the first look, and RobotError.
    """
    rng = np.random.default_rng(derived(seed, Stream.PERCEPTION))
    if failure := _withdrawn(robot, asks):
        return _nothing(seed, TrialResult.FAILED, failure)
    aim = aimed(scene, action, names, robot, rng)
    if aim.path is None:
        return _nothing(seed, TrialResult.NOT_TRIED)
    called = tuple(area.name for area in aim.chosen)
    asks(f"{action}({', '.join(called)})", aim.path)
    began = robot.clock
    robot.start(aim.path)
    failure = _carried_out(robot)
    seconds = robot.clock - began
    failure = failure or _withdrawn(robot, asks)
    stroke = Stroke(called, tuple((w.x, w.y) for w in aim.path.waypoints if w.z <= 0), scene.rag.width / 2)
    frames = [robot.observe() for _ in range(FRAMES_PER_LOOK)]
    try:
        now = track(aim.areas, perceive(frames, scene, rng).areas, stroke, len(aim.areas) + 1).areas
    except NoSurface as error:
        now, failure = (), failure or f"no look afterwards: {error}"
    untouched = {area.name for area in aim.areas} - set(called)
    left = tuple(area for area in now if area.name not in untouched)
    outcome = TrialResult.FAILED if failure else _judged(aim.chosen, left, action)
    sizes = _cells(aim.chosen), _cells(left), None
    lay = _outlines(aim.areas), _outlines(now)
    return Trial(seed, outcome, *sizes, seconds, *lay, np.array(aim.path.stroke).reshape(-1, 2), failure)


def _withdrawn(robot: Robot, asks: Asks) -> str:
    """Why the arm is not out of the camera's view, or nothing."""
    asks("the arm leaves the camera's view", None)
    robot.withdraw()
    return _carried_out(robot)


def _carried_out(robot: Robot) -> str:
    """Let the motion under way end: why it failed, with the tool raised then, or nothing."""
    if finish(robot) is not Status.FAILED:
        return ""
    failure = robot.failure or "the motion does not end"
    robot.stop()
    return failure


def _judged(chosen: Sequence[Area], left: Sequence[Area], action: str) -> TrialResult:
    """By the areas that perception makes of what is left."""
    shrunk = len(left) == len(chosen) == 1 and left[0].ellipse.axes[0] < chosen[0].ellipse.axes[0]
    return ended(len(left), action in GATHERING, len(chosen), shrunk)


def _nothing(seed: int, outcome: TrialResult, failure: str = "") -> Trial:
    none = np.empty((0, 2))
    return Trial(seed, outcome, 0, 0, None, 0.0, none, none, none, failure)


def _cells(areas: Sequence[Area]) -> int:
    return round(sum(area.covered for area in areas) / INK_CELL**2)


def _outlines(areas: Sequence[Area]) -> Points:
    """Points along the ellipses, (n, 2)."""
    return np.concatenate([np.empty((0, 2)), *(boundary(area.ellipse)[::20] for area in areas)])
