"""Episodes on the fast stand-in: what looks find, beside those of perception, and that tables get clean."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from cleancli.execution.events import Ended, Looked
from cleancli.execution.kinematic_cell import KinematicCell, shaded, tool_corners
from cleancli.execution.loop import clean
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, Job, within_reach
from cleancli.execution.table_cell import TableCell
from cleancli.motion.actions import path_along
from cleancli.world.camera import render
from cleancli.world.kinematic import KinematicTable
from cleancli.world.robot import finish
from cleancli.world.table import PybulletTable
from support.shipped import shipped_domain, shipped_scene

SCENE = shipped_scene("scattered_40")


@pytest.mark.parametrize(
    ("domain", "strategy"), [("sweeping", "plan-2"), ("cleaning", "tsp"), ("cleaning", "wipe")]
)
def test_a_table_gets_clean(domain: str, strategy: str) -> None:
    model = shipped_domain(domain)
    options = EpisodeOptions(strategy=strategy, seed=7, samples=500, by_time=True)
    setup = EpisodeSetup(model, within_reach(model, SCENE.arms, Job.CONTAINER), SCENE, Job.CONTAINER, options)
    table = KinematicTable(SCENE, derived(7, Stream.WORLD))
    events = list(clean(setup, KinematicCell(model, SCENE, table)))
    ended = events[-1]
    assert isinstance(ended, Ended)
    assert ended.clean
    assert table.truth().on_table == 0
    assert ended.clock == table.clock > 30
    seen = [len(event.situation.areas) for event in events if isinstance(event, Looked)]
    assert seen[0] > 8 > seen[-1] == 0


def test_a_look_finds_the_areas_that_pictures_show() -> None:
    """The same groups as perception finds, a few millimetres apart (docs/measurements/perception.md)."""
    domain = shipped_domain("cleaning")
    ours = KinematicCell(domain, SCENE, KinematicTable(SCENE, 5)).look(None, None, 0, 0).situation.areas
    with closing(PybulletTable(SCENE, 5)) as table:
        theirs = TableCell(domain, SCENE, table, 5).look(None, None, 0, 0).situation.areas
    middles, others = (np.array([area.ellipse.centre for area in areas]) for areas in (ours, theirs))
    apart = np.linalg.norm(middles[:, None] - others[None], axis=2)
    assert abs(len(ours) - len(theirs)) <= 2
    assert np.median(apart.min(axis=1)) < 4e-3


def test_the_tool_hides_what_the_camera_does_not_see_of_it() -> None:
    """The pixels that the engine draws nearer than the surface, where the tool is over it."""
    scene = replace(SCENE, dirt=SCENE.dirt[:0])
    with closing(PybulletTable(scene, 3)) as table:
        table.start(path_along(((-0.2, 0.1), (0.1, -0.05)), scene))
        finish(table)
        depth = render(table._engine, table._camera, scene.light)[1]
        pose = table._drive.tool()
        drawn = shaded(table._camera, tool_corners(pose, scene.rag.width))
    nearer = depth < scene.camera.height - 0.02
    assert (drawn & nearer).sum() > 0.9 * nearer.sum()
    assert (drawn & ~nearer).sum() < 0.6 * drawn.sum()
