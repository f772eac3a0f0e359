"""Lentils, rice, peas and blocks: they lie where they are dropped, and move as their kind does."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from math import radians

import numpy as np
import pytest
from numpy.typing import NDArray

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path
from cleancli.scene.model import Group, Scattered, Scene, Surface
from cleancli.world import constants as par
from cleancli.world.robot import Status, finish
from cleancli.world.table import PybulletTable
from support.tables import scene


def wait(table: PybulletTable, seconds: float) -> NDArray[np.float64]:
    """Where particles lie after so long."""
    for _ in range(round(seconds / par.STEP)):
        table._engine.stepSimulation()
    return table.truth().positions


def shove(table: PybulletTable, speed: float) -> None:
    """Let all particles go eastwards."""
    for body in table._particles:
        table._engine.changeDynamics(body, -1, activationState=table._engine.ACTIVATION_STATE_WAKE_UP)
        table._engine.resetBaseVelocity(body, [speed, 0, 0], [0, 0, 0])


def way(setting: Scene, speed: float, seconds: float) -> NDArray[np.float64]:
    """How far particles (n,) get eastwards after they were let go."""
    with closing(PybulletTable(setting, 3)) as table:
        before = table.truth().positions
        shove(table, speed)
        return wait(table, seconds)[:, 0] - before[:, 0]


@pytest.mark.parametrize("kind", sorted(par.PARTICLES))
def test_particles_lie_on_the_surface_and_stay(kind: str) -> None:
    setting = scene(Scattered(10, (-0.2, -0.2), (0.2, 0.2), kind))
    with closing(PybulletTable(setting, 3)) as table:
        before = table.truth().positions
        half = min(par.PARTICLES[kind].size) / 2
        np.testing.assert_allclose(before[:, 2], half, atol=2e-4)
        assert np.abs(wait(table, 1.0) - before).max() < 1e-4


def test_a_group_of_several_kinds_is_all_there() -> None:
    """Blocks, ten times as heavy, throw others about that they fall upon (docs/world.md)."""
    kinds = sorted(par.PARTICLES.keys() - {"blocks"})
    setting = scene(*(Group(6, (0.0, 0.0), 0.01, kind) for kind in kinds))
    with closing(PybulletTable(setting, 1)) as table:
        truth = table.truth()
    assert truth.on_table == truth.total == 18
    assert truth.positions[:, 2].min() > 0


def test_peas_roll_and_come_to_rest_where_lentils_and_rice_slide() -> None:
    ways = {
        kind: way(scene(Scattered(5, (-0.1, -0.2), (0.1, 0.2), kind)), 0.1, 4.0) for kind in par.PARTICLES
    }
    assert 0.02 < ways["peas"].min() <= ways["peas"].max() < 0.08
    assert ways["lentils"].max() < 0.005
    assert ways["rice"].max() < 0.005
    assert ways["blocks"].max() < 0.005
    longer = way(scene(Scattered(5, (-0.1, -0.2), (0.1, 0.2), "peas")), 0.1, 6.0)
    np.testing.assert_allclose(longer, ways["peas"], atol=5e-4)


def test_friction_of_the_surface_decides_how_far_a_lentil_slides() -> None:
    setting = scene(Scattered(5, (-0.1, -0.2), (0.1, 0.2)))
    slick, rough = (
        way(replace(setting, surface=Surface(0.9, 0.7, friction, (205, 198, 184))), 0.4, 1.5)
        for friction in (0.15, 0.9)
    )
    assert slick.min() > 2 * rough.max()


def test_on_a_tilted_surface_peas_roll_down_and_lentils_lie() -> None:
    surface = Surface(0.9, 0.7, 0.45, (205, 198, 184), (radians(4), 0.0))
    for kind, rolls in (("peas", True), ("lentils", False)):
        setting = replace(scene(Scattered(5, (-0.1, -0.2), (0.1, 0.2), kind)), surface=surface)
        with closing(PybulletTable(setting, 3)) as table:
            truth = table.truth()
            flat = PybulletTable(replace(setting, surface=replace(surface, tilt=(0.0, 0.0))), 3)
            with closing(flat):
                level = flat.truth().positions
        moved = truth.positions[:, 0] - level[:, 0]
        assert (moved < -0.2).all() == rolls
        assert (np.abs(moved) < 5e-3).all() != rolls


@pytest.mark.parametrize(
    "tilt", [(10.0, 0.0), (0.0, -10.0), (-7.0, 7.0)], ids=["west", "north", "south-east"]
)
def test_whatever_rolls_past_the_end_of_the_floor_lies_there(tilt: tuple[float, float]) -> None:
    slope = radians(tilt[0]), radians(tilt[1])
    surface = Surface(0.9, 0.7, 0.45, (205, 198, 184), slope)
    setting = replace(scene(Scattered(8, (-0.3, -0.2), (0.3, 0.2), "peas")), surface=surface)
    path = tool_path("groupScattered", (Ellipse((0, 0), (0.1, 0.05), 0),), setting)
    with closing(PybulletTable(setting, 2)) as table:
        while table.clock < 4:
            table.start(path)
            assert finish(table) is Status.DONE
        before = table.truth()
        assert before.on_floor > 5
        assert np.abs(before.positions[:, :2]).max() > par.FLOOR_HALF, "some are past its end"
        assert before.positions[:, 2].min() > -par.TABLE_HEIGHT - 0.02, "and have not fallen any farther"
        state = table.save()
        table.start(path)
        assert finish(table) is Status.DONE
        after = table.truth().positions
    gone = np.abs(before.positions[:, :2]).max(axis=1) > par.FLOOR_HALF
    np.testing.assert_array_equal(after[gone], before.positions[gone])
    with closing(PybulletTable(setting, 2, state=state)) as again:
        again.start(path)
        assert finish(again) is Status.DONE
        np.testing.assert_array_equal(again.truth().positions, after)
