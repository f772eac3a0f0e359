"""Ink: drawn where the scene says, seen, and rubbed away where the rag touches and nowhere else."""

from __future__ import annotations

from contextlib import closing

import numpy as np
import pytest

from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.perception.perceive import perceive
from cleancli.scene.model import Ink
from cleancli.world import camera
from cleancli.world import constants as par
from cleancli.world.ink import InkLayer, drawn
from cleancli.world.robot import Status, finish
from cleancli.world.table import PybulletTable
from support.tables import scene

LINE = Ink(((-0.02, -0.02), (0.04, -0.02), (0.04, 0.03)), 0.008)
OTHER = Ink(((0.0, 0.25), (0.05, 0.25)), 0.008)


def test_a_line_covers_its_length_times_its_width() -> None:
    covered = drawn(scene(LINE)).sum() * par.INK_CELL**2
    # Round ends; the corner's inner quarter is covered by both pieces.
    expected = 0.11 * 0.008 + np.pi * 0.004**2 - 0.004**2 * (1 - np.pi / 4)
    assert covered == pytest.approx(expected, rel=0.05)
    dot = drawn(scene(Ink(((0.1, 0.1),), 0.01))).sum() * par.INK_CELL**2
    assert dot == pytest.approx(np.pi * 0.005**2, rel=0.2)


def test_ink_is_found_where_it_is() -> None:
    layer = InkLayer(scene(LINE))
    x = np.array([[0.0, 0.04], [0.04, -0.1]])
    y = np.array([[-0.02, 0.02], [0.04, 3.0]])
    np.testing.assert_array_equal(layer.share_at(x, y), [[1, 1], [0, 0]])
    assert np.abs(layer.places()[:, :2].mean(axis=0) - (0.022, -0.009)).max() < 4e-3


def test_cameras_and_perception_see_it() -> None:
    setting = scene(LINE)
    with closing(PybulletTable(setting, 1)) as table:
        eye = camera.overhead(setting.camera)
        colour, _ = camera.render(table._engine, eye, setting.light, table._finish)
        (area,) = perceive([table.observe()], setting, np.random.default_rng(1)).areas
        onlooker = table.picture().astype(int)
    blue = np.argwhere(np.abs(colour.astype(int) - par.INK_COLOUR).max(axis=2) < 3)
    seen = (blue[:, ::-1] - np.array(eye.centre)) / eye.focal * eye.pose[2, 3] * (1, -1)
    assert np.abs(seen.min(axis=0) - (-0.024, -0.024)).max() < 2e-3
    assert np.abs(seen.max(axis=0) - (0.044, 0.034)).max() < 2e-3
    assert area.covered == pytest.approx(0.00093, rel=0.25)
    assert (np.abs(onlooker - par.INK_COLOUR).max(axis=2) < 3).sum() > 50


def wipe(table: PybulletTable, height: float) -> None:
    corners = ((-0.08, 0.05), (-0.08, height), (0.10, height), (0.10, 0.05))
    table.start(ToolPath(tuple(Waypoint(x, 0.0, z, 0.0, 0.15) for x, z in corners), Interpolation.STRAIGHT))
    assert finish(table) is Status.DONE


def test_the_rag_takes_ink_where_it_presses_and_none_where_it_does_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(par, "HEIGHT_NOISE", 0.0)
    setting = scene(LINE, OTHER)
    with closing(PybulletTable(setting, 3)) as table:
        wipe(table, 0.008)
        untouched = table.truth()
        left = []
        for _ in range(3):
            wipe(table, -0.002)
            left.append(table.truth().ink_left or 0.0)
        ink = table.truth().ink
    assert untouched.ink_left == 1
    assert untouched.ink[:, 2].min() == 1
    share = float(drawn(scene(OTHER)).sum() / drawn(setting).sum())
    assert 1 > left[0] > left[1] > left[2] >= share
    assert left[0] - share == pytest.approx((1 - par.INK_PASS) * (1 - share), abs=0.25 * (1 - share))
    assert left[2] - share < 0.15
    assert (ink[ink[:, 1] > 0.2][:, 2] == 1).all(), "what lies beside the rag's way stays"


def test_without_ink_no_share_of_it_is_told() -> None:
    with closing(PybulletTable(scene(), 1)) as table:
        truth = table.truth()
    assert truth.ink_left is None
    assert truth.ink.shape == (0, 3)
