"""Opens the place of an episode: the workcell for the loop, and beside it what only reports may ask."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Image
from cleancli.compiler.task import GroundState, Task, is_unreachable
from cleancli.execution.episode_state import World
from cleancli.execution.kinematic_cell import KinematicCell
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.setup import MOST, EpisodeOptions, EpisodeSetup, Job, usual_job, within_reach
from cleancli.execution.symbolic_cell import SymbolicCell
from cleancli.execution.table_cell import TableCell
from cleancli.execution.workcell import Workcell
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Domain, Problem
from cleancli.remote.messages import DUSTPAN
from cleancli.remote.robot import RemoteRobot
from cleancli.scene.model import Scene
from cleancli.simulation.symbolic_world import succeeded, world_of
from cleancli.world.errors import RobotError
from cleancli.world.kinematic import KinematicTable
from cleancli.world.robot import Robot, Status
from cleancli.world.state import from_arrays
from cleancli.world.table import PybulletTable, Truth


@dataclass(frozen=True, slots=True)
class Session:
    """`picture(width, height)` shows an onlooker's view, RGB; None where there is nothing to see. `truth()`
    tells how things truly are: for reports alone. `save()` gives what a session of the same kind goes on from
    as its `world`; `stop()` ends a motion with the tool raised. `close()` it."""

    setup: EpisodeSetup
    cell: Workcell
    picture: Callable[[int, int], Image] | None
    truth: Callable[[], Mapping[str, object]]
    save: Callable[[], World]
    stop: Callable[[], None]
    close: Callable[[], None]


def table_session(
    domain: Domain, scene: Scene, options: EpisodeOptions, job: Job | None = None, world: World | None = None
) -> Session:
    """A simulated table; without a `job` the robot does its usual one.

    Raises what `PybulletTable` does, what `from_arrays` does of `world`, and ValueError where that is in the
    middle of a motion: a run is saved between motions.
    """
    job = usual_job(domain, scene.arms) if job is None else job
    state = None if world is None else from_arrays(world)
    if state is not None and Status(state.status) is Status.RUNNING:
        raise ValueError("the saved state is of a motion under way")
    table = PybulletTable(scene, derived(options.seed, Stream.WORLD), state=state)
    return Session(
        EpisodeSetup(domain, within_reach(domain, scene.arms, job), scene, job, options),
        TableCell(domain, scene, table, options.seed),
        table.picture,
        lambda: truth_of(table.truth()),
        lambda: table.save().arrays(),
        table.stop,
        table.close,
    )


def remote_session(domain: Domain, scene: Scene, options: EpisodeOptions, job: Job | None = None) -> Session:
    """A table whose robot is at the end of a socket. It lies as it lies: nothing of it is saved. Raises
    RobotError, also where the robot lacks a skill that the scene says it has."""
    robot = RemoteRobot(scene.driver)
    if scene.arms > 1 and DUSTPAN not in robot.skills:
        robot.close()
        raise RobotError(
            f"the robot at {scene.driver} has no skill `{DUSTPAN}`, and its scene says `arms = {scene.arms}`"
        )
    return replace(robot_session(domain, scene, robot, options, job), close=robot.close)


def robot_session(
    domain: Domain, scene: Scene, robot: Robot, options: EpisodeOptions, job: Job | None = None
) -> Session:
    """A table with any robot and camera, of which nobody knows the truth, and which cannot be saved."""
    job = usual_job(domain, scene.arms) if job is None else job
    return Session(
        EpisodeSetup(domain, within_reach(domain, scene.arms, job), scene, job, options),
        TableCell(domain, scene, robot, options.seed),
        None,
        dict,
        dict,
        robot.stop,
        lambda: None,
    )


def stand_in_session(
    domain: Domain, scene: Scene, options: EpisodeOptions, job: Job | None = None
) -> Session:
    """The fast stand-in for a simulated table, which is neither seen nor saved.

    Raises ValueError for a scene that has none.
    """
    job = usual_job(domain, scene.arms) if job is None else job
    table = KinematicTable(scene, derived(options.seed, Stream.WORLD))
    return Session(
        EpisodeSetup(domain, within_reach(domain, scene.arms, job), scene, job, options),
        KinematicCell(domain, scene, table),
        None,
        lambda: truth_of(table.truth()),
        dict,
        table.stop,
        lambda: None,
    )


def symbolic_session(
    domain: Domain,
    problem: Problem,
    options: EpisodeOptions,
    world: World | None = None,
    acting: Domain | None = None,
) -> Session:
    """The symbolic world by the rules of `acting`, or else of the domain itself.

    Raises `Refused` (E6xx), `NoDurationError` where time is to discount, KeyError and ValueError where
    `world` is another one's.
    """
    rules = world_of(acting or domain, problem, options.by_time)
    cell = SymbolicCell(rules, problem, options.seed)
    if world is not None:
        cell.assignment, cell.clock = _assignment(world["assignment"], rules.task), _clock(world["clock"])
    setup = EpisodeSetup(domain, domain, None, Job.CONTAINER, options)
    return Session(
        setup,
        cell,
        None,
        lambda: {
            "facts": len(rules.facts(cell.assignment)),
            "goal": succeeded(rules, cell.assignment) if rules.has_goal else None,
        },
        lambda: {"assignment": np.array(cell.assignment), "clock": np.array(cell.clock)},
        lambda: None,
        lambda: None,
    )


def _assignment(saved: NDArray[Any], task: Task) -> GroundState:
    sizes = [len(variable.values) for variable in task.variables]
    # An array of no numbers has the type of others.
    if saved.shape != (len(sizes),) or (sizes and saved.dtype.kind != "i"):
        raise ValueError(f"it is not of {plural(len(sizes), 'fact')} that can change")
    values = tuple(map(int, saved.tolist()))
    if any(not 0 <= value < size for value, size in zip(values, sizes, strict=True)):
        raise ValueError("a fact has a value that it cannot have")
    if is_unreachable(task, values):
        raise ValueError("two facts have values that they cannot have together")
    return values


def _clock(saved: NDArray[Any]) -> float:
    if saved.shape != () or saved.dtype.kind not in "fi" or not 0 <= saved <= MOST:
        raise ValueError("its clock is none")
    return float(saved)


def truth_of(truth: Truth) -> Mapping[str, object]:
    """Where the dirt of a table truly is, and which share of its ink is left; None where there was none."""
    return {
        "particles": truth.total,
        "in_container": truth.in_container,
        "in_zone": truth.in_zone,
        "on_table": truth.on_table,
        "in_dustpan": truth.in_dustpan,
        "on_floor": truth.on_floor,
        "ink_left": None if truth.ink_left is None else round(truth.ink_left, 4),
        "left_on_table_at": [[round(float(x), 4), round(float(y), 4)] for x, y, _ in truth.left],
    }
