"""A problem as one look at a scene's table shows it."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cleancli.language.model import Domain, Problem

if TYPE_CHECKING:
    from cleancli.scene.model import Scene


@dataclass(frozen=True, slots=True)
class ObservedProblem:
    """What one look at a table says: the actions that its robot has skills for, what there is to plan for,
    and the areas that the scene's cap leaves out of it."""

    domain: Domain
    problem: Problem
    left_out: tuple[str, ...]


def look(domain: Domain, scene: Scene, seed: int) -> ObservedProblem:
    """What one look at the scene's table says.

    The world and its eyes are imported here: a written problem needs neither.
    """
    from cleancli.execution.seeds import Stream, derived
    from cleancli.execution.setup import within_reach
    from cleancli.execution.table_cell import look_once
    from cleancli.scene.robots import REMOTE

    if scene.robot == REMOTE:
        from cleancli.remote.robot import RemoteRobot

        with RemoteRobot(scene.driver) as robot:
            problem, left_out = look_once(domain, scene, robot, seed)
    else:
        from cleancli.world.table import PybulletTable

        with closing(PybulletTable(scene, derived(seed, Stream.WORLD))) as table:
            problem, left_out = look_once(domain, scene, table, seed)
    return ObservedProblem(within_reach(domain, scene.arms), problem, left_out)
