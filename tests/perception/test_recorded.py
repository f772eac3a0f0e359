"""Frames that were saved are the frames that are loaded, and perception sees the same in them."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from cleancli.geometry.rgbd import Frame
from cleancli.perception.frame_source import BadRecording
from cleancli.perception.perceive import perceive
from cleancli.perception.recorded import load_frames, save_frames
from support.synthetic import frame, grouped, scene


@pytest.fixture(scope="module")
def frames() -> tuple[Frame, ...]:
    lentils = grouped(np.random.default_rng(1), 9, (0.1, 0.1), 0.03)
    return tuple(replace(frame(lentils, seed), clock=seed / 8) for seed in range(2))


def test_a_round_trip_keeps_colour_camera_and_clock_and_depth_to_a_millimetre(
    frames: tuple[Frame, ...], tmp_path: Path
) -> None:
    save_frames(frames, tmp_path / "a" / "set")
    loaded = load_frames(tmp_path / "a" / "set")
    assert len(loaded) == len(frames)
    for before, after in zip(frames, loaded, strict=True):
        np.testing.assert_array_equal(after.colour, before.colour)
        np.testing.assert_allclose(after.depth, before.depth, atol=0.5001e-3)
        assert after.depth.dtype == np.float32
        assert after.clock == before.clock
        np.testing.assert_array_equal(after.camera.pose, before.camera.pose)
        for field in fields(before.camera):
            if field.name != "pose":
                assert getattr(after.camera, field.name) == getattr(before.camera, field.name)


def test_perception_sees_the_same_in_loaded_frames(frames: tuple[Frame, ...], tmp_path: Path) -> None:
    save_frames(frames, tmp_path)
    seen, again = (
        perceive(given, scene(), np.random.default_rng(1)).areas for given in (frames, load_frames(tmp_path))
    )
    assert len(seen) == len(again) == 1
    np.testing.assert_allclose(again[0].ellipse.centre, seen[0].ellipse.centre, atol=5e-4)
    assert again[0].covered == pytest.approx(seen[0].covered, rel=0.05)


def test_unknown_depth_stays_unknown(frames: tuple[Frame, ...], tmp_path: Path) -> None:
    depth = frames[0].depth.copy()
    depth[0, :4] = (0.0, np.nan, np.inf, 70.0)
    save_frames([replace(frames[0], depth=depth)], tmp_path)
    np.testing.assert_array_equal(load_frames(tmp_path)[0].depth[0, :4], 0)


def _set(folder: Path, key: str, value: object) -> None:
    path = folder / "camera.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {key: value}))


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("pose", [[1, 0], [0, 1]], "no description of a camera .*length 4.*pose"),
        ("pose", "east", "no description of a camera"),
        ("focal", 0, "focal lengths must be above 0"),
        ("focal", [525.0], "no description of a camera .*length 2.*focal"),
        ("focal_length", 525.0, "no key `focal_length`; here it is `focal`"),
        ("D", [0.1, 0, 0, 0, 0], "no key `D`; here it is `distortion`"),
        ("clock", [0.0], "no key `clock`; did you mean `clocks`"),
        ("distortion", {"model": "equidistant", "coefficients": [0.1] * 4}, "`equidistant` is not known"),
        ("distortion", {"model": "plumb_bob", "coefficients": [0.1]}, "4 or 5 coefficients, not 1"),
        ("depth_scale", 5000, "can only be 1000"),
        ("focal", float("nan"), "no description of a camera"),
        ("pose", [[0] * 4] * 4, "a rotation and a place"),
        ("pose", [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]], "a rotation and a place"),
        ("width", 320, "asks for uint8"),
        ("width", 0, "no description of a camera .*>= 1.*width"),
        ("height", -480, "no description of a camera .*>= 1.*height"),
        ("height", float("inf"), "no description of a camera"),
        ("clocks", [], "lists no frame"),
        ("clocks", None, "lists no frame"),
        ("clocks", [0.0] * 110, r"of 640 x 480 pixels a look may have at most 109 frames"),
        ("centre", [1], "no description of a camera"),
    ],
)
def test_a_camera_that_does_not_fit_is_named(
    frames: tuple[Frame, ...], tmp_path: Path, key: str, value: object, said: str
) -> None:
    save_frames(frames[:1], tmp_path)
    _set(tmp_path, key, value)
    with pytest.raises(BadRecording, match=said):
        load_frames(tmp_path)


@pytest.mark.parametrize("key", ["width", "height", "focal", "centre"])
def test_a_key_that_is_missing_is_named_with_its_meaning(
    frames: tuple[Frame, ...], tmp_path: Path, key: str
) -> None:
    save_frames(frames[:1], tmp_path)
    path = tmp_path / "camera.json"
    path.write_text(json.dumps({name: v for name, v in json.loads(path.read_text()).items() if name != key}))
    with pytest.raises(BadRecording, match=f"`{key}` is missing, the .*pixels"):
        load_frames(tmp_path)


@pytest.mark.parametrize(
    ("name", "mend"),
    [("color-000.png", "rename it"), ("colour-000.jpg", "convert it to PNG"), ("color-000.jpeg", "convert")],
)
def test_a_picture_by_another_name_is_found(
    frames: tuple[Frame, ...], tmp_path: Path, name: str, mend: str
) -> None:
    save_frames(frames[:1], tmp_path)
    (tmp_path / "colour-000.png").rename(tmp_path / name)
    with pytest.raises(BadRecording, match=rf"colour-000\.png: missing, but there is {name}: {mend}"):
        load_frames(tmp_path)


def test_a_jpeg_picture_in_the_place_of_a_png_is_told(frames: tuple[Frame, ...], tmp_path: Path) -> None:
    save_frames(frames[:1], tmp_path)
    _, data = cv2.imencode(".jpg", frames[0].colour)
    (tmp_path / "colour-000.png").write_bytes(data.tobytes())
    with pytest.raises(BadRecording, match="a JPEG picture: convert it to PNG"):
        load_frames(tmp_path)


def test_a_picture_is_refused_wherever_it_is_cut(frames: tuple[Frame, ...], tmp_path: Path) -> None:
    """Between two parts as within one: the library that reads pictures would print lines of its own."""
    save_frames(frames[:1], tmp_path)
    whole = (tmp_path / "depth-000.png").read_bytes()
    last = whole.rindex(b"IEND") - 4
    for end in (last, last + 6, len(whole) - 1, len(whole) // 2):
        (tmp_path / "depth-000.png").write_bytes(whole[:end])
        with pytest.raises(BadRecording, match=r"depth-000\.png: no PNG"):
            load_frames(tmp_path)


def test_a_picture_that_is_none_and_one_that_is_missing_are_named(
    frames: tuple[Frame, ...], tmp_path: Path
) -> None:
    save_frames(frames[:1], tmp_path)
    for content in (b"", b"not a picture"):
        (tmp_path / "depth-000.png").write_bytes(content)
        with pytest.raises(BadRecording, match=r"depth-000\.png: no PNG"):
            load_frames(tmp_path)
    _, data = cv2.imencode(".png", np.zeros((480, 640), np.uint8))
    (tmp_path / "depth-000.png").write_bytes(data.tobytes())
    with pytest.raises(BadRecording, match=r"uint8 .480, 640., but camera\.json asks for uint16"):
        load_frames(tmp_path)
    (tmp_path / "colour-000.png").unlink()
    with pytest.raises(BadRecording, match=r"colour-000\.png: missing"):
        load_frames(tmp_path)


@pytest.mark.parametrize("missing", [True, False])
def test_a_camera_may_stand_nobody_knows_where(
    frames: tuple[Frame, ...], tmp_path: Path, missing: bool
) -> None:
    unlocated = replace(frames[0].camera, pose=np.eye(4), located=False)
    save_frames([replace(frames[0], camera=unlocated)], tmp_path)
    if missing:
        described = json.loads((tmp_path / "camera.json").read_text())
        del described["pose"]
        (tmp_path / "camera.json").write_text(json.dumps(described))
    (loaded,) = load_frames(tmp_path)
    assert not loaded.camera.located
    (area,) = perceive([loaded], scene(), np.random.default_rng(1)).areas
    assert area.ellipse.centre == pytest.approx((0.1, 0.1), abs=0.02)


@pytest.mark.parametrize("text", [b'{"width": 1, "made by": "\xff"}', b"\xff", b'{"format": "\xff"}'])
def test_bytes_that_are_no_text_are_no_camera(tmp_path: Path, text: bytes) -> None:
    (tmp_path / "camera.json").write_bytes(text)
    with pytest.raises(BadRecording, match="no description of a camera"):
        load_frames(tmp_path)
