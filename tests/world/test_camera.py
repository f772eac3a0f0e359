"""The RGB-D camera: distances, places and noise of what it sees."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from cleancli.scene.model import Scattered
from cleancli.world import camera
from cleancli.world import constants as par
from cleancli.world.robots.gantry import Gantry
from cleancli.world.table import PybulletTable
from support.tables import scene


def test_table_and_floor_are_at_their_distances() -> None:
    with closing(PybulletTable(scene(), 1)) as table:
        depth = table.observe().depth
    assert depth.shape == (480, 640)
    assert depth.dtype == np.float32
    middle = depth[200:280, 280:360]
    assert middle.mean() == pytest.approx(0.9, abs=1e-3)
    assert 1.0e-3 < middle.std() < 1.7e-3, "1.2 mm of noise and the steps of quantisation"
    assert np.median(depth[:20]) == pytest.approx(0.9 + par.TABLE_HEIGHT, abs=5e-3)


def test_depth_is_quantised() -> None:
    with closing(PybulletTable(scene(), 1)) as table:
        depth = table.observe().depth
    values = np.unique(np.round(depth[200:280, 280:360], 5))
    assert np.diff(values).min() == pytest.approx(par.DEPTH_STEP * 0.81, rel=0.05)


def test_lentils_are_seen_where_they_lie() -> None:
    with closing(PybulletTable(scene(Scattered(12, (-0.3, -0.25), (0.3, 0.25))), 4)) as table:
        eye = camera.overhead(scene().camera)
        colour, depth = camera.render(table._engine, eye, scene().light)
        truth = table.truth().positions
    dark = np.argwhere((colour.sum(axis=2) < 330) & (depth < 0.905))
    assert 7 <= len(dark) / 12 <= 13, "pixels per lentil"
    offsets = dark[:, ::-1] - np.array(eye.centre)
    seen = offsets / eye.focal * depth[dark[:, 0], dark[:, 1], None] * (1, -1)
    errors = []
    for lentil in truth[:, :2]:
        near = seen[np.linalg.norm(seen - lentil, axis=1) < 6e-3]
        errors.append(near.mean(axis=0) - lentil)
    assert np.abs(np.mean(errors, axis=0)).max() < 4e-4, "a quarter of a pixel"


def test_colours_are_the_scenes() -> None:
    with closing(PybulletTable(scene(), 1)) as table:
        colour = table.observe().colour
    assert colour.dtype == np.uint8
    patch = colour[200:280, 280:360].reshape(-1, 3)
    assert patch.mean(axis=0) == pytest.approx([205, 198, 184], abs=12)
    assert patch.std(axis=0).max() == pytest.approx(par.COLOUR_NOISE, abs=0.5)
    assert colour[:15].mean() > 215, "the floor is whiter"
    container = colour[200:280, 600:].reshape(-1, 3).mean(axis=0)
    assert container[2] > container[0] + 40, "the container is below the edge, and seen"


def test_colour_is_shifted_against_depth() -> None:
    image = np.zeros((4, 6, 3), dtype=np.uint8)
    image[:, 2] = 200
    shifted = camera.noisy_colour(image, np.random.default_rng(1))
    assert (shifted[:, 3] > 150).all()
    assert (shifted[:, 2] < 50).all()


def test_edges_are_jittered_and_partly_unknown() -> None:
    depth = np.full((60, 60), 0.9, dtype=np.float32)
    depth[:, 30:] = 1.6
    seen = camera.noisy_depth(depth, np.random.default_rng(1))
    assert (seen[:, 28:32] == 0).any()
    assert (np.abs(seen[:, 29] - 1.6) < 0.05).any()
    assert (seen[:, :28] > 0.88).all()
    assert (seen[:, 32:] > 1.5).all()


def test_the_tool_hides_what_it_stands_above() -> None:
    with closing(PybulletTable(scene(), 1)) as table:
        drive = table._drive
        assert isinstance(drive, Gantry)
        drive.stand(np.array((0.1, 0.05, 0.0, 0.3)))
        colour, depth = camera.render(table._engine, camera.overhead(scene().camera), scene().light)
    hidden = depth < 0.88
    assert hidden.sum() > 1000
    assert colour[hidden].mean() < 140


def test_the_onlooker_sees_without_noise() -> None:
    with closing(PybulletTable(scene(), 1)) as table:
        first, second = table.picture(), table.picture()
        small = table.picture(160, 120)
    assert first.shape == (480, 640, 3)
    assert small.shape == (120, 160, 3)
    np.testing.assert_array_equal(first, second)


def test_light_falls_from_where_the_scene_says() -> None:
    setting = scene()
    brightness = []
    with closing(PybulletTable(setting, 1)) as table:
        for elevation in (90.0, 30.0):
            light = replace(setting.light, elevation=np.radians(elevation), ambient=0.2)
            colour, _ = camera.render(table._engine, camera.overhead(setting.camera), light)
            brightness.append(colour[200:280, 280:360].mean())
    high, low = brightness
    # The surface gets ambient + (1 - ambient) * sin(elevation) of its colour.
    assert low / high == pytest.approx(0.2 + 0.8 * 0.5, abs=0.02)
