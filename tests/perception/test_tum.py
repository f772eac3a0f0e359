"""Folders in the TUM layout: what was written is read, and what is odd in them is named."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cleancli.geometry.rgbd import Frame
from cleancli.perception.frame_source import BadRecording, looks, spread
from cleancli.perception.perceive import perceive
from cleancli.perception.reading import Reading
from cleancli.perception.tum import is_tum, open_tum, save_tum
from support.synthetic import frame, grouped, scene


@pytest.fixture(scope="module")
def frames() -> tuple[Frame, ...]:
    lentils = grouped(np.random.default_rng(1), 9, (0.1, 0.1), 0.03)
    return tuple(replace(frame(lentils, seed), clock=5 + seed / 8) for seed in range(3))


@pytest.fixture
def folder(frames: tuple[Frame, ...], tmp_path: Path) -> Path:
    save_tum(frames, tmp_path / "a" / "set")
    return tmp_path / "a" / "set"


def test_a_round_trip_keeps_colour_and_clock_and_depth_to_a_fifth_of_a_millimetre(
    frames: tuple[Frame, ...], folder: Path
) -> None:
    assert is_tum(folder)
    (look,) = looks(open_tum(folder, Reading()), every=1.0)
    assert [each.clock for each in look] == [each.clock for each in frames]
    for before, after in zip(frames, look, strict=True):
        np.testing.assert_array_equal(after.colour, before.colour)
        np.testing.assert_allclose(after.depth, before.depth, atol=1.001e-4)
        np.testing.assert_allclose(after.camera.pose, before.camera.pose, atol=1e-8)
        assert (after.camera.focal, after.camera.centre) == (before.camera.focal, before.camera.centre)


def test_perception_sees_the_same_areas_to_a_tenth_of_a_millimetre(
    frames: tuple[Frame, ...], folder: Path
) -> None:
    (look,) = looks(open_tum(folder, Reading()), every=1.0)
    (before,), (after,) = (
        perceive(given, scene(), np.random.default_rng(1)).areas for given in (frames, look)
    )
    np.testing.assert_allclose(after.ellipse.centre, before.ellipse.centre, atol=1e-4)
    np.testing.assert_allclose(after.ellipse.axes, before.ellipse.axes, atol=1e-4)


def test_any_pose_is_read_as_it_was_written(frames: tuple[Frame, ...], tmp_path: Path) -> None:
    for number, turn in enumerate(Rotation.random(5, random_state=3)):
        pose = frames[0].camera.pose.copy()
        pose[:3, :3] = turn.as_matrix()
        turned = replace(frames[0], camera=replace(frames[0].camera, pose=pose))
        save_tum([turned], tmp_path / str(number))
        (read,) = spread(open_tum(tmp_path / str(number), Reading()), 1)
        np.testing.assert_allclose(read.camera.pose, pose, atol=1e-8)


def test_pairs_are_the_nearest_where_nothing_associates_them(folder: Path) -> None:
    (folder / "associations.txt").unlink()
    lines = (folder / "depth.txt").read_text().splitlines()
    late = [f"{float(line.split()[0]) + 0.015} {line.split()[1]}" for line in reversed(lines)]
    (folder / "depth.txt").write_text("# colour is earlier\n\n" + "\n".join(late))
    source = open_tum(folder, Reading())
    assert source.clocks == (5.0, 5.125, 5.25)
    assert source.notes == ()
    (folder / "depth.txt").write_text("\n".join(late[1:]))
    assert "1 of 3 colour pictures have no depth within 0.02 s" in open_tum(folder, Reading()).notes[0]
    with pytest.raises(BadRecording, match=r"nearest is 0\.015 s off: `--max-difference`"):
        open_tum(folder, Reading(max_difference=0.01))


def test_without_a_path_nobody_knows_where_the_camera_stands(folder: Path) -> None:
    (folder / "groundtruth.txt").unlink()
    (first, *_) = spread(open_tum(folder, Reading()), 2)
    assert not first.camera.located


def test_a_frame_of_a_camera_that_moves_is_a_look_of_its_own(folder: Path) -> None:
    """The pose between two stamps is between their poses; frames from other places are no part of a look."""
    (folder / "groundtruth.txt").write_text("5 0 0 0.9 1 0 0 0\n5.25 0.1 0 0.9 1 0 0 0\n")
    (look,) = looks(open_tum(folder, Reading()), every=1.0)
    assert len(look) == 1
    frames = list(open_tum(folder, Reading()).take([0, 1, 2]))
    assert [each.camera.pose[0, 3] for each in frames] == pytest.approx([0, 0.05, 0.1])


def test_looks_follow_each_other_by_their_clocks(folder: Path) -> None:
    assert [len(look) for look in looks(open_tum(folder, Reading()), every=0.2)] == [2, 1]


def test_the_depth_scale_is_what_the_camera_says(frames: tuple[Frame, ...], folder: Path) -> None:
    path = folder / "camera.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"depth_scale": 1000}))
    (first, *_) = spread(open_tum(folder, Reading()), 3)
    np.testing.assert_allclose(first.depth, 5 * frames[0].depth, atol=1e-3)


def _list(name: str, text: str) -> Callable[[Path], object]:
    def change(folder: Path) -> None:
        (folder / "associations.txt").unlink()
        (folder / name).write_text(text)

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda folder: (folder / "camera.json").unlink(), r'camera\.json: missing.*"focal": \[525'),
        (lambda folder: (folder / "rgb" / "001.png").unlink(), r"rgb/001\.png: missing"),
        (lambda folder: (folder / "rgb" / "001.png").write_bytes(b"x"), r"rgb/001\.png: no PNG"),
        (_list("rgb.txt", "5.0 ../a.png"), "line 1: `../a.png` lies outside"),
        (_list("rgb.txt", "5.0 /etc/passwd"), "line 1: `/etc/passwd` lies outside"),
        (_list("rgb.txt", "# stamp name\nfive a.png"), "line 2: could not convert"),
        (_list("rgb.txt", "nan a.png"), "line 1: all numbers must be finite"),
        (_list("rgb.txt", "5.0"), "line 1: 2 words are asked for, not 1"),
        (_list("rgb.txt", "# nothing"), r"rgb\.txt: no picture"),
        (_list("groundtruth.txt", "5 0 0 0.9 0 0 0 0"), "no place of the camera: stamp"),
        (_list("groundtruth.txt", "1 0 0 0.9 1 0 0 0"), r"no place of the camera for rgb/000\.png"),
        (_list("groundtruth.txt", "\n"), "no place of the camera"),
        (lambda folder: (folder / "associations.txt").write_text("1 a 2"), "4 words are asked for, not 3"),
        (lambda folder: (folder / "associations.txt").write_text(""), "no pair of pictures"),
        (lambda folder: (folder / "associations.txt").write_bytes(b"\xff"), "no text"),
    ],
)
def test_what_is_odd_is_named(folder: Path, change: Callable[[Path], object], said: str) -> None:
    change(folder)
    with pytest.raises(BadRecording, match=said):
        spread(open_tum(folder, Reading()), 3)


def test_depth_without_a_list_is_named(folder: Path) -> None:
    _list("rgb.txt", "5.0 rgb/000.png")(folder)
    (folder / "depth.txt").unlink()
    with pytest.raises(BadRecording, match=r"depth\.txt: missing, though there is rgb\.txt"):
        open_tum(folder, Reading())
