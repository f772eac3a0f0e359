"""Opens an episode in this process, on the physics or on its fast stand-in, so that the truth may be asked
between any two moves."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from cleancli.execution.events import Event
from cleancli.execution.kinematic_cell import KinematicCell
from cleancli.execution.loop import clean, saving
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, discounts_time, usual_job, within_reach
from cleancli.execution.strategies import STRATEGIES
from cleancli.execution.table_cell import TableCell
from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain
from cleancli.planning.registry import PLANNERS
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
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
    """An episode as `execute` has it, before its first look; on the physics, if no stand-in is given. Raises
    ValueError for a scene for which there is none."""
    domain, scene, named, seed = job
    strategy, planner = planning(named)
    model = load_domain(read_source(find(domain, "domains")))
    place = load_scene(read_source(find(scene, "problems")))
    options = EpisodeOptions(strategy=strategy, planner=planner, seed=seed, by_time=discounts_time(model))
    return placed(model, place, options, stand_in)


def placed(
    model: Domain, place: Scene, options: EpisodeOptions, stand_in: type[KinematicTable] | None
) -> Opened:
    """The same of a domain and a scene that are read already."""
    way = usual_job(model, place.arms)
    setup = EpisodeSetup(model, within_reach(model, place.arms, way), place, way, options)
    drawn = derived(options.seed, Stream.WORLD)
    if stand_in is not None:
        table = stand_in(place, drawn)
        return setup, KinematicCell(model, place, table), table
    physics = PybulletTable(place, drawn)
    return setup, TableCell(model, place, physics, options.seed), physics


def carried_out(opened: Opened) -> Iterator[Event]:
    """What happens in an episode, bit for bit as in `execute`."""
    setup, cell, table = opened
    events = clean(setup, cell)
    return saving(events, table.save) if isinstance(table, PybulletTable) else events


@contextmanager
def on_table(model: Domain, place: Scene, options: EpisodeOptions, stand_in: bool) -> Iterator[Opened]:
    """The same, and the physics is let go of in the end."""
    setup, cell, table = placed(model, place, options, KinematicTable if stand_in else None)
    try:
        yield setup, cell, table
    finally:
        if isinstance(table, PybulletTable):
            table.close()
