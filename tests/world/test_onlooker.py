"""Pictures for people: all that matters is in them, shadows fall where light does not, and no run notices."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from cleancli.array_types import Bools, Floats
from cleancli.scene.model import Light
from cleancli.world import camera
from cleancli.world import constants as par
from cleancli.world.onlooker import NOTHING, Onlooker
from cleancli.world.robots.gantry import Gantry
from cleancli.world.table import PybulletTable
from cleancli.world.viewpoint import Viewpoint, around
from support.shipped import shipped_scene
from support.tables import scene

SIZE = 320, 240


def sides(view: Viewpoint, points: Floats, aspect: float) -> Floats:
    """(n, 2) where points are in the picture, from -1 to 1 each way, by the lines through the eye."""
    right = np.cross(view.up, view.back)
    found = []
    for point in points:
        away = np.array(point) - view.eye
        half = -(away @ view.back) * np.tan(view.field / 2)
        found.append((away @ right / (half * aspect), away @ view.up / half))
    return np.array(found)


@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_viewpoint_has_all_points_in_its_picture(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(12, 3)) * rng.uniform(0.1, 2, 3)
    aspect, field = rng.uniform(0.5, 2), rng.uniform(0.1, 1.2)
    view = around(points, rng.uniform(-4, 4), rng.uniform(-0.5, 1.5), field, aspect)
    seen = sides(view, points, aspect)
    assert np.abs(seen).max() <= 1 + 1e-9
    touched = np.isclose(seen.min(axis=0), -1) & np.isclose(seen.max(axis=0), 1)
    assert touched.any(), "it could be nearer"
    ahead = (view.eye - points) @ view.back
    assert ahead.min() == pytest.approx(view.near)
    assert ahead.max() == pytest.approx(view.far)


@pytest.mark.parametrize("name", ["two_groups", "wam_groups", "reem_pick_up"])
def test_the_robot_is_in_the_picture_and_not_cut_off(name: str) -> None:
    with closing(PybulletTable(shipped_scene(name), 1)) as table:
        table.picture(*SIZE)
        onlooker = table._onlookers[SIZE]
        _, buffer = camera.rasterise(onlooker._stage, onlooker._lens, onlooker._light)
    moving = buffer < NOTHING
    assert moving.sum() > 300
    borders = moving[0], moving[-1], moving[:, 0], moving[:, -1]
    assert not any(border.any() for border in borders)


def test_a_run_does_not_notice_that_pictures_are_taken() -> None:
    with closing(PybulletTable(scene(), 1)) as seen, closing(PybulletTable(scene(), 1)) as unseen:
        seen.picture(*SIZE)
        for table in (seen, unseen):
            table.withdraw()
        for _ in range(5):
            seen.poll()
            unseen.poll()
            seen.picture(*SIZE)
        np.testing.assert_array_equal(seen.observe().colour, unseen.observe().colour)
        one, other = seen.save().arrays(), unseen.save().arrays()
    for name, values in one.items():
        np.testing.assert_array_equal(values, other[name])


def test_a_table_that_goes_on_looks_as_it_did() -> None:
    with closing(PybulletTable(scene(), 1)) as table:
        table.withdraw()
        table.poll()
        before = table.picture(*SIZE)
        state = table.save()
        np.testing.assert_array_equal(table.picture(*SIZE), before)
        with closing(PybulletTable(scene(), 1, state=state)) as other:
            np.testing.assert_array_equal(other.picture(*SIZE), before)


def behind_post(places: Floats, light: Light, tool: Floats) -> Bools:
    """(n,) whether the line from each place to the light meets the gantry's post, in small steps."""
    towards = np.array(
        (
            np.cos(light.elevation) * np.cos(light.azimuth),
            np.cos(light.elevation) * np.sin(light.azimuth),
            np.sin(light.elevation),
        )
    )
    low = tool[2] + par.FLAP_HEIGHT + par.HOLDER_SIZE[1]
    met = np.zeros(len(places), np.bool_)
    for step in np.arange(0, 0.8, 2e-3):
        offset = places + step * towards - tool[:3]
        height = offset[:, 2] + tool[2]
        inside = (np.abs(offset[:, :2]) <= par.POST_RADIUS).all(axis=1)
        met |= inside & (height >= low) & (height <= low + par.POST_HEIGHT)
    return met


def test_shadows_fall_where_something_stands_before_the_light() -> None:
    light = replace(scene().light, elevation=0.6, azimuth=-0.4)
    tool = np.array((0.0, 0.0, 0.0, 0.0))
    with closing(PybulletTable(replace(scene(), light=light), 1)) as table:
        without = table.picture(640, 480).astype(int)
        assert isinstance(table._drive, Gantry)
        table._drive.stand(tool)
        colour = table.picture(640, 480).astype(int)
        onlooker: Onlooker = table._onlookers[640, 480]
        _, buffer = camera.rasterise(onlooker._stage, onlooker._lens, onlooker._light)
    still = onlooker._backdrop
    places = np.stack(still.places, axis=2)
    # The post's shadow, but not what the rag and its holder shade around it.
    surface = (np.abs(places[:, :, 2]) < 1e-3) & (buffer > NOTHING) & (places[:, :, 0] < -0.15)
    darker = (colour.sum(axis=2) < 0.9 * without.sum(axis=2))[surface]
    expected = behind_post(places[surface], light, tool)
    assert expected.sum() > 200
    # The light's pixels are 3 mm wide and the post is 30: edges may differ.
    assert (darker != expected).sum() < 0.2 * expected.sum()
    lit = light.ambient + (1 - light.ambient) * np.sin(light.elevation)
    share = colour[surface][darker & expected].sum() / without[surface][darker & expected].sum()
    assert share == pytest.approx(light.ambient / lit, abs=0.02)
