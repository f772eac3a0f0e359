"""Frames that were read or described wrongly: what is said of each, and that nothing is said of good ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.surface import NoSurface
from support import real_camera, synthetic

LENTILS = np.array([(x, y) for x in (-0.3, -0.1, 0.05, 0.2) for y in (-0.2, 0.1)])
BOX = synthetic.Box((-0.1, -0.05), (0.0, 0.1), 0.06)


def see(frame: Frame) -> Observation:
    return perceive([frame], synthetic.scene(), np.random.default_rng(0))


def with_camera(frame: Frame, change: Callable[[Camera], Camera]) -> Frame:
    return replace(frame, camera=change(frame.camera))


def moved(frame: Frame, **places: float) -> Frame:
    pose = frame.camera.pose.copy()
    for axis, by in places.items():
        pose["xyz".index(axis), 3] += by
    return with_camera(frame, lambda camera: replace(camera, pose=pose))


@pytest.mark.parametrize(
    "frame",
    [
        synthetic.frame(LENTILS, 1),
        synthetic.frame(LENTILS, 1, boxes=(BOX,)),
        synthetic.frame(LENTILS, 1, light=0.5, colour=(74, 66, 60)),
        real_camera.taken(1, places=LENTILS),
        real_camera.taken(2, places=LENTILS, boxes=(BOX,), light=real_camera.Light(0.7, 0.45, 1.0, 0.4)),
    ],
)
def test_nothing_is_said_of_a_good_frame(frame: Frame) -> None:
    assert see(frame).doubts == ()


@pytest.mark.parametrize(("value", "said"), [(0, "black all over"), (255, "white all over")])
def test_colour_that_shows_nothing(value: int, said: str) -> None:
    frame = synthetic.frame(LENTILS, 1)
    (doubt,) = see(replace(frame, colour=np.full_like(frame.colour, value))).doubts
    assert said in doubt


@pytest.mark.parametrize(
    "change", [lambda c: replace(c, centre=(160.0, 119.5)), lambda c: replace(c, centre=(640.0, 478.0))]
)
def test_a_principal_point_of_another_resolution(change: Callable[[Camera], Camera]) -> None:
    try:
        told = "; ".join(see(with_camera(synthetic.frame(LENTILS, 1), change)).doubts)
    except NoSurface as error:
        told = str(error)
    assert "the principal point is at (" in told
    assert "in a picture of 640 x 480 pixels: are focal and centre those of another resolution?" in told


@pytest.mark.parametrize(
    ("factor", "said"),
    [
        (2.0, "of where the surface should be lies lower than it"),
        (0.6, "the plane goes on beyond all edges"),
        (4.0, "shows 17 degrees"),
    ],
)
def test_a_focal_length_of_another_resolution(factor: float, said: str) -> None:
    frame = with_camera(synthetic.frame(LENTILS, 1), lambda c: replace(c, focal=factor * c.focal))
    assert said in "; ".join(see(frame).doubts)
    assert "focal" in said or "focal" in "; ".join(see(frame).doubts)


def test_half_the_picture_with_the_intrinsics_of_the_whole() -> None:
    whole = synthetic.frame(LENTILS, 1)
    half = replace(whole.camera, width=320, height=240)
    frame = Frame(
        np.ascontiguousarray(whole.colour[::2, ::2]), np.ascontiguousarray(whole.depth[::2, ::2]), half, 0.0
    )
    assert "the principal point is at (320, 239) in a picture of 320 x 240 pixels" in "; ".join(
        see(frame).doubts
    )


@pytest.mark.parametrize(
    ("across", "down", "said"), [(16, 0, "16 pixels right"), (-12, 8, "12 pixels left and 8 pixels down")]
)
@pytest.mark.parametrize("real", [False, True])
def test_colour_shifted_against_depth(across: int, down: int, said: str, real: bool) -> None:
    frame = real_camera.taken(3, boxes=(BOX,)) if real else synthetic.frame(LENTILS, 1)
    colour = np.roll(frame.colour, (down, across), axis=(0, 1))
    doubts = see(replace(frame, colour=colour)).doubts
    assert (
        f"colour is shifted against depth by about {said}: are the two registered, of the same moment?"
        in doubts
    )


def test_a_pose_that_is_off() -> None:
    (doubt,) = see(moved(synthetic.frame(LENTILS, 1), z=0.1)).doubts
    assert doubt == (
        "the surface lies 10 cm above where the scene says, and slants 0 degrees against it: "
        "is the camera's pose right?"
    )
    (slanted,) = see(synthetic.frame(LENTILS, 1, tilt=(0.15, 0.0))).doubts
    assert "slants 9 degrees" in slanted
    (aside,) = see(moved(synthetic.frame(LENTILS, 1), x=0.1)).doubts
    assert "11% of where the surface should be lies lower than it" in aside


def refusal(frame: Frame) -> str:
    with pytest.raises(NoSurface) as refused:
        see(frame)
    return str(refused.value)


def test_a_pose_that_is_inverted() -> None:
    """The table slants by 27 degrees before a camera whose pose says so."""
    frame = synthetic.frame(LENTILS, 1, tilt=(0.0, 0.5))
    pose = _turned(-np.degrees(np.arctan(0.5))) @ frame.camera.pose
    right, wrong, off = (
        replace(frame, camera=replace(frame.camera, pose=np.asarray(other, np.float64)))
        for other in (pose, np.linalg.inv(pose), _turned(80) @ pose)
    )
    assert see(right).doubts == ()
    said = "with its pose inverted it is found: does `pose` lead from the scene to the camera?"
    assert said in refusal(wrong)
    assert "is the camera's pose right?" in refusal(off)


def _turned(angle: float) -> np.ndarray:
    turn = np.eye(4)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn[1:3, 1:3] = [[c, -s], [s, c]]
    return turn


def test_a_pose_in_millimetres() -> None:
    frame = synthetic.frame(LENTILS, 1)
    told = refusal(moved(frame, z=899.1))
    assert "the camera stands 900 m from the scene's origin: is its pose in millimetres?" in told


@pytest.mark.parametrize(
    ("factor", "unit"),
    [
        (1e-3, "metres"),
        (10, "tenths of a millimetre"),
        (5, "1/5000 of a metre, as in the TUM layout"),
        (1e3, "millimetres where metres are wanted"),
    ],
)
def test_depth_in_another_unit(factor: float, unit: str) -> None:
    frame = synthetic.frame(LENTILS, 1)
    told = refusal(replace(frame, depth=(frame.depth * factor).astype(np.float32)))
    assert f"is its unit {unit}?" in told
    assert "the depth's median is " in told
    assert "nine tenths of the points lie at x " in told


@pytest.mark.parametrize("outlier", [65.535, 2.047, 0.3, 0.001])
def test_outliers_of_depth_cost_no_more_than_holes(outlier: float) -> None:
    """At one pixel in a hundred, found anew by counting: what is dirty and what is hidden is the same."""
    frame = synthetic.frame(LENTILS, 1)
    wrong = np.random.default_rng(0).random(frame.depth.shape) < 0.01
    seen, holes = (
        see(replace(frame, depth=np.where(wrong, np.float32(value), frame.depth))) for value in (outlier, 0.0)
    )
    assert seen.doubts == ()
    assert len(seen.areas) == len(holes.areas) == len(LENTILS)
    assert seen.hidden == pytest.approx(holes.hidden, abs=0.002)


def test_a_small_table_beside_much_floor_is_the_surface() -> None:
    """A quarter of what lies within the extent the scene states is on the plane; the floor is far below."""
    frame = synthetic.frame(np.array([(0.1, 0.1)]), 1)
    table = np.zeros(frame.depth.shape, np.bool_)
    table[150:280, 330:560] = True
    observation = see(replace(frame, depth=np.where(table, frame.depth, np.float32(1.6))))
    assert len(observation.areas) == 1
    assert "lies lower" in "; ".join(observation.doubts)
