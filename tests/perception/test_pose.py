"""The surface in any pose: slanting, shifted, and seen by a camera of which nobody knows where it stands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception import geometry
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.surface import NoSurface
from support import synthetic

LENTILS = np.array([(-0.25, -0.15), (-0.05, 0.2), (0.1, -0.1), (0.22, 0.17)])


def see(frame: Frame) -> Observation:
    return perceive([frame], synthetic.scene(), np.random.default_rng(0))


def centres(observation: Observation) -> np.ndarray:
    return np.array([area.ellipse.centre for area in observation.areas])


@pytest.mark.parametrize("slope", [(0.2, 0.0), (0.0, -0.3), (-0.25, 0.25), (0.0, 0.57)])
def test_areas_are_in_the_surfaces_own_metres(slope: tuple[float, float]) -> None:
    """The table's height is slope · (x, y). x on it runs as far east as it can."""
    observation = see(synthetic.frame(LENTILS, 1, tilt=slope))
    places = np.column_stack([LENTILS, LENTILS @ slope])
    normal = np.array([-slope[0], -slope[1], 1]) / np.sqrt(1 + slope[0] ** 2 + slope[1] ** 2)
    east = np.array([1.0, 0, 0]) - normal[0] * normal
    east /= np.linalg.norm(east)
    expected = np.column_stack([places @ east, places @ np.cross(normal, east)])
    assert len(observation.areas) == len(LENTILS)
    assert np.abs(centres(observation) - expected).max() < 0.003
    assert observation.plane.normal == pytest.approx(normal, abs=0.005)


def test_the_camera_is_given_in_the_surfaces_coordinates() -> None:
    observation = see(synthetic.frame(LENTILS, 1, tilt=(0.0, 0.3)))
    pixels = geometry.project(observation.camera, centres(observation))
    depth = synthetic.HEIGHT - 0.3 * LENTILS[:, 1]
    expected = np.column_stack(
        [320 + LENTILS[:, 0] / depth * synthetic.FOCAL, 239 - LENTILS[:, 1] / depth * synthetic.FOCAL]
    )
    assert np.abs(pixels - expected).max() < 1.5


def test_a_surface_ten_centimetres_too_high_is_found() -> None:
    frame = synthetic.frame(LENTILS, 1)
    higher = replace(frame.camera, pose=frame.camera.pose + np.outer([0, 0, 0.1, 0], [0, 0, 0, 1]))
    observation = see(replace(frame, camera=higher))
    assert observation.plane.origin == pytest.approx([0, 0, 0.1], abs=0.002)
    assert np.abs(centres(observation) - LENTILS).max() < 0.003


def unlocated(frame: Frame) -> Frame:
    return replace(frame, camera=replace(frame.camera, pose=np.eye(4), located=False))


@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.1, -0.1)])
def test_a_camera_that_stands_nobody_knows_where_finds_the_outline(slope: tuple[float, float]) -> None:
    observation = see(unlocated(synthetic.frame(LENTILS, 1, tilt=slope)))
    assert np.abs(centres(observation) - LENTILS).max() < 0.008
    assert observation.hidden < 0.03


def test_a_surface_that_fills_the_view_is_found_without_an_outline() -> None:
    frame = unlocated(synthetic.frame(np.array([(0.05, 0.02)]), 1))
    middle = np.s_[120:360, 160:480]
    camera = replace(frame.camera, width=320, height=240, centre=(160.0, 119.0))
    observation = see(Frame(frame.colour[middle].copy(), frame.depth[middle].copy(), camera, 0.0))
    assert centres(observation) == pytest.approx(np.array([(0.05, 0.02)]), abs=0.003)
    assert observation.hidden > 0.5, "most of the surface is outside the picture"


@pytest.mark.parametrize("window", [np.s_[:, :400], np.s_[100:, 200:]])
def test_a_table_that_leaves_the_image_is_placed_by_the_cameras_axis(window: tuple[slice, slice]) -> None:
    """Its middle, where the axis meets it, is what is measured from; it is said so."""
    frame = unlocated(synthetic.frame(LENTILS, 1))
    top, left = window[0].start or 0, window[1].start or 0
    colour, depth = np.ascontiguousarray(frame.colour[window]), np.ascontiguousarray(frame.depth[window])
    centre = (320.0 - left, 239.0 - top)
    camera = replace(frame.camera, width=depth.shape[1], height=depth.shape[0], centre=centre)
    observation = see(Frame(colour, depth, camera, 0.0))
    shown = np.array([place for place in LENTILS if _is_in(camera, place)])
    assert len(shown) > 1
    assert centres(observation) == pytest.approx(shown[np.argsort(shown[:, 0])], abs=0.003)
    assert any("places are measured from where the camera's axis meets it" in d for d in observation.doubts)


def _is_in(camera: Camera, place: np.ndarray) -> bool:
    column = camera.centre[0] + place[0] / synthetic.HEIGHT * camera.focal
    row = camera.centre[1] - place[1] / synthetic.HEIGHT * camera.focal
    return bool(6 < column < camera.width - 6 and 6 < row < camera.height - 6)


@pytest.mark.parametrize(
    ("factor", "unit"), [(5, "1/5000 of a metre"), (10, "tenths of a milli"), (1e-3, "metres")]
)
def test_an_outline_of_another_unit(factor: float, unit: str) -> None:
    frame = unlocated(synthetic.frame(LENTILS, 1))
    with pytest.raises(NoSurface, match=f"is the unit of depth {unit}"):
        see(replace(frame, depth=(frame.depth * factor).astype(np.float32)))


def test_a_located_surface_that_fills_the_view_is_placed_by_the_scene() -> None:
    frame = synthetic.frame(LENTILS[2:3], 1)
    middle = np.s_[120:360, 160:480]
    camera = replace(frame.camera, width=320, height=240, centre=(160.0, 119.0))
    observation = see(Frame(frame.colour[middle].copy(), frame.depth[middle].copy(), camera, 0.0))
    assert centres(observation) == pytest.approx(LENTILS[2:3], abs=0.003)


def test_a_plane_of_another_size_is_no_surface() -> None:
    frame = synthetic.frame(LENTILS, 1)
    depth = frame.depth.copy()
    depth[:, :320] = 1.6
    said = "no plane has an outline of about 90 x 70 cm, but .* give the camera's `pose`, or show all of"
    with pytest.raises(NoSurface, match=said):
        see(unlocated(replace(frame, depth=depth)))


def test_nothing_to_see_is_no_surface() -> None:
    frame = synthetic.frame(LENTILS, 1)
    with pytest.raises(NoSurface, match="no plane in what is seen"):
        see(unlocated(replace(frame, depth=np.full_like(frame.depth, np.nan))))
    steep = synthetic.frame(LENTILS, 1)
    turned = replace(steep.camera, pose=steep.camera.pose @ _turn(np.radians(60)))
    with pytest.raises(NoSurface):
        see(replace(steep, camera=turned))


def _turn(angle: float) -> np.ndarray:
    turn = np.eye(4)
    turn[1:3, 1:3] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return turn
