"""Opens an episode in this process, on the physics or on its fast stand-in, so that the truth may be asked
between any two moves."""

from __future__ import annotations

from cleancli.execution.kinematic_cell import KinematicCell
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, usual_job, within_reach
from cleancli.execution.strategies import STRATEGIES
from cleancli.execution.table_cell import TableCell
from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.planning.registry import PLANNERS
from cleancli.scene.check import load_scene
from cleancli.world.kinematic import KinematicTable
from cleancli.world.table import PybulletTable

Job = tuple[str, str, str, int]
"""Domain, scene, strategy (`planning` reads it), seed."""

Opened = tuple[EpisodeSetup, KinematicCell | TableCell, KinematicTable | PybulletTable]
"""What the loop takes, the workcell, and the table behind it."""


def planning(named: str) -> tuple[str, str | None]:
    """A strategy, and the planner that it is to use, if it was named as STRATEGY:PLANNER."""
    strategy, _, planner = named.partition(":")
    if strategy not in STRATEGIES or (planner and planner not in PLANNERS):
        raise ValueError(f"no strategy or planner is called `{named}`")
    return strategy, planner or None


def opened(job: Job, stand_in: type[KinematicTable] | None) -> Opened:
    """An episode that plans by time, before its first look; on the physics, if no stand-in is given. Raises
    ValueError for a scene for which there is none."""
    domain, scene, named, seed = job
    strategy, planner = planning(named)
    model = load_domain(read_source(find(domain, "domains")))
    place = load_scene(read_source(find(scene, "problems")))
    way = usual_job(model, place.robot)
    options = EpisodeOptions(strategy=strategy, planner=planner, seed=seed, by_time=True)
    setup = EpisodeSetup(model, within_reach(model, place.robot, way), place, way, options)
    drawn = derived(seed, Stream.WORLD)
    if stand_in is not None:
        table = stand_in(place, drawn)
        return setup, KinematicCell(model, place, table), table
    physics = PybulletTable(place, drawn)
    return setup, TableCell(model, place, physics, seed), physics
