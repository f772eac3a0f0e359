"""The fast stand-in for the table: what a stroke carries, how long it takes, and beside the real physics."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import path_along, tool_path
from cleancli.scene.model import Group, Ink, Scattered
from cleancli.world import constants as par
from cleancli.world.kinematic import KinematicTable
from cleancli.world.robot import finish
from cleancli.world.table import PybulletTable, Truth, stroke_error
from support.shipped import shipped_scene

SCENE = shipped_scene("scattered_40")
GROUP = replace(SCENE, dirt=(Group(12, (-0.1, 0.0), 0.025),))
PUSH = path_along(((-0.14, 0.0), (0.5, 0.0)), GROUP)


def pushed(seed: int) -> Truth:
    table = KinematicTable(GROUP, seed)
    table.start(PUSH)
    finish(table)
    return table.truth()


def test_particles_lie_where_the_engine_drops_them() -> None:
    """Within what a lentil slides when it lands."""
    ours = KinematicTable(SCENE, 5).truth().positions[:, :2]
    with closing(PybulletTable(SCENE, 5)) as table:
        theirs = table.truth().positions[:, :2]
    assert np.median(np.linalg.norm(ours - theirs, axis=1)) < 2e-3


def test_a_stroke_that_is_low_carries_all_and_one_that_is_high_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for noise in ("SIDE_NOISE", "YAW_NOISE"):
        monkeypatch.setattr(par, noise, 0.0)
    monkeypatch.setattr(par, "HEIGHT_NOISE", 0.0)
    assert pushed(1).in_container == 12
    monkeypatch.setattr(par, "HEIGHT_NOISE", 1.0)  # metres: half of all strokes go far above
    assert {pushed(seed).in_container for seed in range(8)} == {0, 12}


def test_a_cloth_that_slants_keeps_what_it_carries(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its friction is greater than the slant."""
    monkeypatch.setattr(par, "HEIGHT_NOISE", 0.0)
    monkeypatch.setattr(par, "YAW_NOISE", 0.15)
    assert {pushed(seed).in_container for seed in range(6)} == {12}


def test_what_is_beside_the_cloth_stays() -> None:
    table = KinematicTable(replace(GROUP, dirt=(Group(30, (0.0, 0.1), 0.02),)), 2)
    before = table.dirt.copy()
    table.start(PUSH)
    finish(table)
    assert (table.dirt == before).all()


def test_every_particle_is_accounted_for_and_the_same_seed_does_the_same() -> None:
    def after(seed: int) -> Truth:
        rng, table = np.random.default_rng(seed), KinematicTable(SCENE, seed)
        for _ in range(12):
            places = rng.uniform((-0.42, -0.32), (0.42, 0.32), (3, 2)).tolist()
            ellipses = tuple(Ellipse((x, y), (0.03, 0.02), 0.0) for x, y in places)
            table.start(tool_path("sweep3" if rng.random() < 0.5 else "join3", ellipses, SCENE))
            finish(table)
        return table.truth()

    one, again, other = after(3), after(3), after(4)
    assert one.on_table + one.in_container + one.on_floor == one.total == 40
    assert (one.positions == again.positions).all()
    assert (one.positions != other.positions).any()
    assert (np.abs(one.left[:, :2]) <= (0.45, 0.35)).all()


def test_motions_take_as_long_as_the_gantry_needs() -> None:
    for seed in range(3):
        rng = np.random.default_rng(seed)
        x, y = rng.uniform((-0.35, -0.25), (0.35, 0.25)).tolist()
        path = tool_path("moveToContainerFast", (Ellipse((x, y), (0.03, 0.02), 0.0),), SCENE)
        stand_in = KinematicTable(SCENE, seed)
        stand_in.start(path)
        finish(stand_in)
        stand_in.withdraw()
        finish(stand_in)
        with closing(PybulletTable(replace(SCENE, dirt=(Scattered(1, (0, 0), (0.1, 0.1)),)), seed)) as table:
            table.start(path)
            finish(table)
            table.withdraw()
            finish(table)
            assert stand_in.clock == pytest.approx(table.clock, rel=0.04)


def test_it_stands_in_for_no_other_robot_and_no_ink() -> None:
    for scene in (shipped_scene("wam_groups"), replace(SCENE, dirt=(Ink(((0, 0), (0.1, 0)), 0.01),))):
        with pytest.raises(ValueError, match="only tables with a gantry and without ink"):
            KinematicTable(scene, 1)


def test_a_scene_may_say_how_exactly_the_tool_keeps_its_height() -> None:
    usual, exact, rough = (
        np.array([stroke_error(PUSH, np.random.default_rng(seed), noise) for seed in range(200)])
        for noise in (None, 0.0, 3e-3)
    )
    assert np.ptp(exact[:, 2]) == 0
    assert rough[:, 2].std() == pytest.approx(3e-3, rel=0.15)
    assert usual[:, 2].std() == pytest.approx(par.HEIGHT_NOISE, rel=0.15)
    assert (usual[:, [0, 1, 3]] == rough[:, [0, 1, 3]]).all()
