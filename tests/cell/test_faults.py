"""What of a cell cannot be right is told, and what is right is not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from cleancli.cell.board import BOARDS
from cleancli.cell.camera import Laid
from cleancli.cell.faults import Seen, faults_felt, faults_seen, felt, seen
from cleancli.cell.touches import Touch
from cleancli.geometry.rgbd import Frame
from support import real_camera, synthetic

Array = NDArray[np.float64]

SURFACE = synthetic.scene().surface
FRAMES = [real_camera.taken(seed) for seed in range(3)]


def moved(x: float = 0.0, y: float = 0.0, z: float = 0.0, yaw: float = 0.0, slant: float = 0.0) -> Array:
    """From where something is to where it is believed to be, metres and degrees."""
    a, b = np.radians((yaw, slant))
    about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = about_z @ about_x, (x, y, z)
    return pose


def believed(wrong: Array, frames: Sequence[Frame] = FRAMES) -> list[Frame]:
    """Frames whose camera is believed to stand elsewhere than it does."""
    return [replace(f, camera=replace(f.camera, pose=wrong @ f.camera.pose)) for f in frames]


def found(frames: Sequence[Frame]) -> Seen:
    return seen(frames, SURFACE, np.random.default_rng(0))


def test_nothing_is_said_of_a_camera_that_stands_where_it_is_believed_to() -> None:
    for frames in (FRAMES, [synthetic.frame(np.array([(0.1, 0.1)]), 1)]):
        right = found(frames)
        assert faults_seen(right) == ()
        assert abs(right.higher) < 0.002
        assert right.slanted < 0.1
        assert right.shifted == pytest.approx((0, 0), abs=0.002)
        assert right.turned == pytest.approx(0, abs=0.2)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (moved(x=0.02), ["the table's middle is seen 20 mm east of its place"]),
        (moved(y=-0.04), ["the table's middle is seen 40 mm south of its place"]),
        (moved(x=-0.2, y=0.015), ["the table's middle is seen 200 mm west and 15 mm north"]),
        (moved(z=0.02), ["the table is seen 20 mm above its place: the camera stands lower"]),
        (moved(z=-0.2), ["the table is seen 200 mm below its place: the camera stands higher"]),
        (moved(yaw=3), ["the table is seen turned by 3.0 degrees counter-clockwise"]),
        (moved(yaw=-90), ["the table is seen turned by 90.0 degrees"]),
        (moved(slant=2), ["the table is seen to slant by 2.0 degrees"]),
        (moved(z=0.03, yaw=-2), ["the table is seen 30 mm above", "turned by 2.0 degrees clockwise"]),
    ],
)
def test_a_camera_that_stands_elsewhere_is_told(wrong: Array, told: list[str]) -> None:
    faults = faults_seen(found(believed(wrong)))
    assert len(faults) == len(told)
    for fault, words in zip(faults, told, strict=True):
        assert words in fault


@pytest.mark.parametrize("wrong", [moved(x=0.008), moved(z=-0.007), moved(yaw=0.6), moved(slant=0.6)])
def test_what_rulers_are_wrong_by_is_no_fault(wrong: Array) -> None:
    assert faults_seen(found(believed(wrong))) == ()


def test_a_rim_that_leaves_the_picture_tells_no_place() -> None:
    """A large table fills the view: its plane is judged, its middle is not."""
    frame = synthetic.frame(np.array([(0.1, 0.1)]), 1)
    near = replace(frame, depth=np.where(frame.depth > 1.2, np.float32(0.9), frame.depth))
    near_seen = found(believed(moved(x=0.1, z=0.02), [near]))
    assert near_seen.shifted is None
    assert near_seen.turned is None
    (fault,) = faults_seen(near_seen)
    assert "20 mm above" in fault


BOARD, LAID = BOARDS["a3"], Laid()
TABLE = moved(0.6, -0.1, 0.02, yaw=90)


def touches(wrong: Array, noise: float = 0.0, seed: int = 1) -> list[Touch]:
    """Two corners and four other places, as a robot tells them whose table lies `wrong` to what is believed,
    in coordinates of the scene."""
    names = ["a1", "g4", None, None, None, None]
    corners = LAID.places(BOARD, np.array([BOARD.corner_names.index(n) for n in ("a1", "g4")]))
    places = np.vstack([corners, [(-0.4, -0.3), (0.4, -0.3), (0.4, 0.3), (-0.4, 0.3)]])
    whole = np.column_stack([places, np.zeros(6), np.ones(6)])
    tools = (whole @ (TABLE @ wrong).T)[:, :3] + np.random.default_rng(seed).normal(0, noise, (6, 3))
    return [Touch((t[0], t[1], t[2]), name) for t, name in zip(tools, names, strict=True)]


def test_a_tool_that_is_too_high_is_told() -> None:
    """Its tip is where the robot believes it 4 mm lower: it touches the table when told to be below it."""
    high = felt(touches(moved(z=-0.004)), BOARD, LAID, TABLE)
    assert high.higher == pytest.approx(-0.004)
    (fault,) = faults_felt(high)
    assert fault == "the tool touches the table 4.0 mm lower than the cell says: strokes would pass above it"
    (fault,) = faults_felt(felt(touches(moved(z=0.002)), BOARD, LAID, TABLE))
    assert "2.0 mm higher than the cell says: strokes would press into it" in fault


def test_a_table_that_was_moved_is_told() -> None:
    (fault,) = faults_felt(felt(touches(moved(x=0.02)), BOARD, LAID, TABLE))
    assert "20 mm beside them" in fault
    without = [replace(each, corner=None) for each in touches(moved(x=0.02))]
    assert felt(without, BOARD, LAID, TABLE).beside is None
    assert faults_felt(felt(without, BOARD, LAID, TABLE)) == ()


def test_touches_with_a_millimetre_of_noise_are_no_fault() -> None:
    """Of six touches the mean is off by 0.4 mm: beyond 1.5 mm once in four thousand times."""
    faults = [faults_felt(felt(touches(moved(), 0.001, seed), BOARD, LAID, TABLE)) for seed in range(200)]
    assert sum(map(len, faults)) <= 1
