"""Bags of every kind give the frames that are in them, and what is odd in one is named, whatever it is."""

from __future__ import annotations

import bz2
import os
import struct
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

pytest.importorskip("rosbags", reason="an extra")

from rosbags.rosbag2 import CompressionMode

from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception import bag_file
from cleancli.perception.bags import open_bag
from cleancli.perception.frame_source import BadRecording, looks, spread
from cleancli.perception.perceive import perceive
from cleancli.perception.reading import Reading
from cleancli.perception.sources import recorded_frames, recorded_looks
from support.bags import (
    CAMERA_INFO,
    COLOUR,
    DEPTH,
    IMAGE,
    INFO,
    OPTICAL,
    PACKED,
    SCENE,
    TREE,
    Ros,
    millimetres,
    packed_distances,
    packed_png,
    told_messages,
    write_bag,
)
from support.synthetic import frame, grouped, scene

KINDS = ("table.bag", "table.mcap", "table.db3")
Messages = list[tuple[str, str, float, Any]]


@pytest.fixture(scope="module")
def frames() -> tuple[Frame, ...]:
    """Of a table with a group of lentils; depth in millimetres, as cameras tell it."""
    lentils = grouped(np.random.default_rng(1), 9, (0.1, 0.1), 0.03)
    seen = [replace(frame(lentils, seed), clock=5 + seed / 8) for seed in range(3)]
    return tuple(replace(one, depth=(millimetres(one) / 1000).astype(np.float32)) for one in seen)


@pytest.fixture(scope="module")
def small() -> tuple[Frame, ...]:
    """Four pictures that are quick to write, of noise on orange."""
    camera = Camera(32, 24, 26.0, (16.0, 12.0), np.diag([1.0, -1.0, -1.0, 1.0]))
    rng = np.random.default_rng(5)
    return tuple(
        Frame(
            (rng.integers(0, 96, (24, 32, 3)) + np.array([160, 80, 0])).astype(np.uint8),
            (rng.integers(500, 2000, (24, 32)) / 1000).astype(np.float32),
            camera,
            5 + number / 8,
        )
        for number in range(4)
    )


def _ros(name: str | Path) -> Ros:
    return Ros(str(name).endswith(".bag"))


def _plain(path: Path, frames: Sequence[Frame]) -> Path:
    ros = _ros(path)
    return write_bag(path, told_messages(ros, frames), ros)


def _read(path: Path, **reading: Any) -> tuple[Frame, ...]:
    return spread(open_bag(path, Reading(**reading)), 100)


@pytest.mark.parametrize("name", KINDS)
def test_a_bag_shows_the_same_areas_to_a_tenth_of_a_millimetre(
    frames: tuple[Frame, ...], tmp_path: Path, name: str
) -> None:
    path = _plain(tmp_path / name, frames)
    if name != "table.bag":  # then it is a folder, with a file of what it holds
        assert (path.parent / "metadata.yaml").exists()
        path = path.parent
    (look,) = looks(open_bag(path, Reading(frame=SCENE)), every=1.0)
    (before,), (after,) = (
        perceive(given, scene(), np.random.default_rng(1)).areas for given in (frames, look)
    )
    np.testing.assert_allclose(after.ellipse.centre, before.ellipse.centre, atol=1e-4)
    np.testing.assert_allclose(after.ellipse.axes, before.ellipse.axes, atol=1e-4)
    assert after.covered == pytest.approx(before.covered, abs=1e-8)


def _colours(ros: Ros, one: Frame, encoding: str) -> tuple[str, Any]:
    bgr = one.colour[:, :, ::-1]
    four = np.full((*one.depth.shape, 1), 9, np.uint8)
    if encoding in ("png", "jpeg"):
        kind = ".png" if encoding == "png" else ".jpg"
        data = cv2.imencode(kind, bgr, [cv2.IMWRITE_JPEG_QUALITY, 100])[1].tobytes()
        return PACKED, ros.packed(one.clock, data, f"rgb8; {encoding} compressed bgr8")
    pixels = {
        "rgb8": one.colour,
        "bgr8": bgr,
        "rgba8": np.concatenate([one.colour, four], axis=2),
        "bgra8": np.concatenate([bgr, four], axis=2),
    }[encoding]
    return IMAGE, ros.image(one.clock, pixels, encoding)


def _depths(ros: Ros, one: Frame, encoding: str) -> tuple[str, Any]:
    steps = millimetres(one)
    if encoding == "16UC1 big":
        return IMAGE, ros.image(one.clock, steps.astype(">u2"), "16UC1")
    if encoding == "16UC1 packed":
        data = struct.pack("<iff", 0, 0, 0) + packed_png(steps)
        return PACKED, ros.packed(one.clock, data, "16UC1; compressedDepth png")
    if encoding == "32FC1 packed":
        return PACKED, ros.packed(one.clock, packed_distances(one.depth), "32FC1; compressedDepth png")
    if encoding == "png":
        return PACKED, ros.packed(one.clock, packed_png(steps), "16UC1; png compressed ")
    return IMAGE, ros.image(one.clock, one.depth if encoding == "32FC1" else steps, encoding)


@pytest.mark.parametrize("name", KINDS[:2])
@pytest.mark.parametrize(
    ("colour", "depth"),
    [
        ("rgb8", "16UC1"),
        ("bgr8", "mono16"),
        ("rgba8", "16UC1 big"),
        ("bgra8", "32FC1"),
        ("png", "16UC1 packed"),
        ("png", "32FC1 packed"),
        ("jpeg", "png"),
    ],
)
def test_pictures_are_read_in_each_encoding(
    small: tuple[Frame, ...], tmp_path: Path, name: str, colour: str, depth: str
) -> None:
    ros = _ros(name)
    messages: Messages = [(INFO, CAMERA_INFO, 0.0, ros.info(small[0].camera))]
    for one in small:
        for topic, (kind, message) in (
            (COLOUR, _colours(ros, one, colour)),
            (DEPTH, _depths(ros, one, depth)),
        ):
            packed = "" if kind == IMAGE else "/compressedDepth" if topic == DEPTH else "/compressed"
            messages.append((topic + packed, kind, one.clock, message))
    read = _read(write_bag(tmp_path / name, messages, ros))
    assert len(read) == len(small)
    for before, after in zip(small, read, strict=True):
        assert after.clock == before.clock
        assert not after.camera.located
        rounded = 1e-4 + before.depth**2 / 10100 if depth == "32FC1 packed" else np.full((24, 32), 1e-6)
        assert (np.abs(after.depth - before.depth) <= rounded).all()
        if colour != "jpeg":
            np.testing.assert_array_equal(after.colour, before.colour)
        else:  # noise is what JPEG is worst at
            np.testing.assert_allclose(after.colour.mean((0, 1)), before.colour.mean((0, 1)), atol=4)


def test_depth_that_is_no_distance_is_unknown_and_rows_may_be_longer(
    small: tuple[Frame, ...], tmp_path: Path
) -> None:
    ros = Ros(False)
    depth = small[0].depth.copy()
    depth[0, :7] = (np.nan, np.inf, -np.inf, -1.0, 0.0, 66.0, 1e38)
    message = ros.image(5.0, np.pad(depth, ((0, 0), (0, 3)), constant_values=7.0), "32FC1")
    message = replace(message, width=32)
    messages = [each for each in told_messages(ros, small[:1]) if each[0] != DEPTH]
    (read,) = _read(write_bag(tmp_path / "table.mcap", [*messages, (DEPTH, IMAGE, 5.0, message)], ros))
    np.testing.assert_array_equal(read.depth[0, :7], 0)
    np.testing.assert_array_equal(read.depth[1:], depth[1:])


@pytest.mark.parametrize("name", KINDS)
def test_the_parts_of_a_bag_are_one_recording(small: tuple[Frame, ...], tmp_path: Path, name: str) -> None:
    folder = tmp_path / "split"
    folder.mkdir()
    ros = _ros(name)
    for number, some in ((9, small[:2]), (10, small[2:])):
        part = write_bag(tmp_path / f"table_{number}{Path(name).suffix}", told_messages(ros, some), ros)
        part.rename(folder / part.name)
    found, notes = recorded_looks(folder, Reading(every=0.2))
    assert [[one.clock for one in look] for _, look in found] == [[5.0, 5.125], [5.25, 5.375]]
    assert notes == ()


def test_pairs_are_the_nearest_stamps_in_whatever_order_they_come(
    small: tuple[Frame, ...], tmp_path: Path
) -> None:
    """Colour is received in the wrong order, depth as a whole before it, and taken 15 ms later."""
    ros = Ros(False)
    later = [replace(one, clock=one.clock + 0.015) for one in small]
    depth = [each for each in told_messages(ros, later) if each[0] == DEPTH]
    colour = [each for each in told_messages(ros, small) if each[0] != DEPTH]
    turned = [
        (topic, kind, 20 - received, message) if topic == COLOUR else (topic, kind, received, message)
        for topic, kind, received, message in colour
    ]
    path = write_bag(tmp_path / "table.mcap", [*depth, *turned], ros)
    read = _read(path)
    assert [one.clock for one in read] == [one.clock for one in small]
    for before, after in zip(small, read, strict=True):
        np.testing.assert_array_equal(after.colour, before.colour)
        np.testing.assert_allclose(after.depth, before.depth, atol=1e-6)
    with pytest.raises(BadRecording, match=r"within 0\.01 s of any.* nearest is 0\.015 s off"):
        _read(path, max_difference=0.01)


def test_stamps_of_0_are_when_pictures_were_received(small: tuple[Frame, ...], tmp_path: Path) -> None:
    ros = Ros(True)
    unstamped = [
        (topic, kind, received, told)
        for one in small
        for topic, kind, received, told in [
            (topic, kind, one.clock, told)
            for topic, kind, _, told in told_messages(ros, [replace(one, clock=0.0)])
        ]
    ]
    read = _read(write_bag(tmp_path / "table.bag", unstamped, ros))
    assert [frame.clock for frame in read] == pytest.approx([frame.clock for frame in small])
    np.testing.assert_array_equal(read[2].colour, small[2].colour)


def test_pictures_without_partner_are_told(small: tuple[Frame, ...], tmp_path: Path) -> None:
    ros = Ros(True)
    messages = [each for each in told_messages(ros, small) if each[0] != DEPTH or each[2] != 5.125]
    source = open_bag(write_bag(tmp_path / "table.bag", messages, ros), Reading())
    assert len(source.clocks) == 3
    assert source.notes[0].endswith("1 of 4 colour pictures have no depth within 0.02 s")


def test_the_lens_is_that_of_camera_info_and_of_rectified_pictures_the_other_matrix(
    small: tuple[Frame, ...], tmp_path: Path
) -> None:
    ros = Ros(False)
    bent = ros.info(small[0].camera, distortion=(-0.3, 0.1, 0.0, 0.0, 0.0))
    bent = replace(bent, p=np.array([30.0, 0, 15.0, 0, 0, 30.0, 11.0, 0, 0, 0, 1, 0]))
    others = [each for each in told_messages(ros, small[:1]) if each[0] != INFO]
    raw = write_bag(tmp_path / "raw.mcap", [(INFO, CAMERA_INFO, 0.0, bent), *others], ros)
    (read,) = _read(raw)
    assert (read.camera.focal, read.camera.centre) == (26.0, (16.0, 12.0))
    assert np.abs(read.colour.astype(float) - small[0].colour).max() > 0
    renamed = [(name.replace("image_raw", "image_rect_color"), *rest) for name, *rest in others]
    flat = write_bag(tmp_path / "flat.mcap", [(INFO, CAMERA_INFO, 0.0, bent), *renamed], ros)
    (read,) = _read(flat)
    assert (read.camera.focal, read.camera.centre) == (30.0, (15.0, 11.0))
    np.testing.assert_array_equal(read.colour, small[0].colour)


def test_raw_pictures_stand_for_the_same_ones_compressed(small: tuple[Frame, ...], tmp_path: Path) -> None:
    ros = Ros(False)
    messages = told_messages(ros, small)
    messages += [(f"{COLOUR}/compressed", *_at(one, *_colours(ros, one, "jpeg"))) for one in small]
    messages += [
        (
            "/camera/infra1/image_rect_raw",
            IMAGE,
            one.clock,
            ros.image(one.clock, one.colour[:, :, 0], "mono8"),
        )
        for one in small
    ]
    path = write_bag(tmp_path / "table.mcap", messages, ros)
    np.testing.assert_array_equal(_read(path)[0].colour, small[0].colour)
    named = _read(path, colour_topic=f"{COLOUR}/compressed")[0].colour
    assert np.abs(named.astype(float) - small[0].colour).max() > 0


def _at(one: Frame, kind: str, message: Any) -> tuple[str, float, Any]:
    return kind, one.clock, message


def test_one_of_two_cameras_is_chosen_by_name(small: tuple[Frame, ...], tmp_path: Path) -> None:
    ros = Ros(False)
    messages = told_messages(ros, small)
    messages += [(f"/second{name}", *rest) for name, *rest in told_messages(ros, small[:2]) if name[1] != "t"]
    path = write_bag(tmp_path / "table.mcap", messages, ros)
    with pytest.raises(BadRecording, match=r"several cameras: choose with `--colour-topic`.*/second/camera"):
        _read(path)
    assert len(_read(path, colour_topic=f"/second{COLOUR}", depth_topic=f"/second{DEPTH}")) == 2
    with pytest.raises(
        BadRecording, match=r"no pictures in a topic `/camera/colour/image_raw`; did you mean"
    ):
        _read(path, colour_topic="/camera/colour/image_raw")
    with pytest.raises(BadRecording, match=r"no camera_info in a topic `/info`"):
        _read(path, colour_topic=COLOUR, depth_topic=DEPTH, info_topic="/info")


Change = Callable[[Ros, Messages], Messages]


def _without(topic: str) -> Change:
    return lambda ros, messages: [each for each in messages if each[0] != topic]


def _other(topic: str, make: Callable[[Ros, Any], Any]) -> Change:
    """Messages of a topic replaced."""
    return lambda ros, messages: [
        (name, kind, clock, make(ros, message) if name == topic else message)
        for name, kind, clock, message in messages
    ]


def _info_field(**fields: Any) -> Change:
    def change(ros: Ros, info: Any) -> Any:
        told = {name if hasattr(info, name) else name.upper(): value for name, value in fields.items()}
        return replace(info, **told)

    return _other(INFO, change)


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda ros, messages: [], "no topic has pictures of colour"),
        (_without(COLOUR), r"no topic has pictures of colour.*there are: /camera/aligned.*32FC1, 32 x 24"),
        (_without(DEPTH), r"no topic has pictures of depth \(`--depth-topic`\)"),
        (_without(INFO), r"no camera_info of .*neither /camera/color/camera_info nor another; record it too"),
        (_info_field(width=640), r"camera_info is of 640 x 24 pixels, and .* of 32 x 24"),
        (_info_field(k=np.zeros(9)), r"`K` is 0: the camera is not calibrated"),
        (_info_field(distortion_model="equidistant"), r"`equidistant` is not known, only `plumb_bob`"),
        (_info_field(binning_x=2), r"a part of the picture, or of one that is binned"),
        (
            _other(DEPTH, lambda ros, m: ros.image(5.0, np.ones((24, 32), "<f4"), "32FC1", "depth")),
            "registered",
        ),
        (_other(DEPTH, lambda ros, m: ros.image(5.0, np.ones((12, 16), "<f4"), "32FC1")), "is registered to"),
        (_other(DEPTH, lambda ros, m: replace(m, encoding="64FC1")), "no topic has pictures of depth"),
        (
            _other(COLOUR, lambda ros, m: replace(m, encoding="bayer_rggb8")),
            r"encoding `bayer_rggb8` is none",
        ),
        (_other(COLOUR, lambda ros, m: replace(m, step=2)), "2304 bytes are too few for 32 x 24 of rgb8"),
        (_other(COLOUR, lambda ros, m: replace(m, data=m.data[:99])), "99 bytes are too few"),
        (_other(COLOUR, lambda ros, m: replace(m, width=1 << 31)), "no topic has pictures of colour"),
        (_other(COLOUR, lambda ros, m: b"\0\1\0\0nothing"), "the bag cannot be read"),
        (
            _other(COLOUR, lambda ros, m: b"\x28\xb5\x2f\xfd" + bytes(9)),
            "compressed by itself|cannot be read",
        ),
    ],
)
def test_what_is_odd_in_a_bag_is_named(
    small: tuple[Frame, ...], tmp_path: Path, name: str, change: Change, said: str
) -> None:
    ros = _ros(name)
    path = write_bag(tmp_path / name, change(ros, told_messages(ros, small)), ros)
    with pytest.raises(BadRecording, match=said) as told:
        _read(path)
    assert str(path) in str(told.value)


@pytest.mark.parametrize(
    ("told", "data", "said"),
    [
        ("jpeg", b"\xff\xd8nothing", "no pictures in a topic|neither PNG nor JPEG"),
        (
            "png",
            cv2.imencode(".png", np.zeros((24, 32, 3), np.uint8))[1].tobytes()[:-9],
            "cut off or damaged",
        ),
        (
            "jpeg",
            cv2.imencode(".jpg", np.zeros((24, 32, 3), np.uint8))[1].tobytes()[:-9],
            "cut off or damaged",
        ),
        ("png", b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sII", 13, b"IHDR", 1 << 30, 1 << 30), "1073741824 x"),
        ("jpeg", b"\xff\xd8\xff\xc0" + struct.pack(">HBHH", 8, 8, 65535, 65535), "65535 x 65535"),
    ],
)
def test_a_compressed_picture_that_is_none_is_named(
    small: tuple[Frame, ...], tmp_path: Path, told: str, data: bytes, said: str
) -> None:
    ros = Ros(False)
    messages = [each for each in told_messages(ros, small) if each[0] != COLOUR]
    messages += [(f"{COLOUR}/compressed", PACKED, 5.0, ros.packed(5.0, data, told))]
    path = write_bag(tmp_path / "table.mcap", messages, ros)
    with pytest.raises(BadRecording, match=said):
        _read(path, colour_topic=f"{COLOUR}/compressed")


def test_depth_as_rvl_is_refused_with_the_mend(small: tuple[Frame, ...], tmp_path: Path) -> None:
    ros = Ros(False)
    messages = [each for each in told_messages(ros, small) if each[0] != DEPTH]
    packed = ros.packed(5.0, bytes(40), "16UC1; compressedDepth rvl")
    path = write_bag(tmp_path / "table.mcap", [*messages, (f"{DEPTH}/c", PACKED, 5.0, packed)], ros)
    with pytest.raises(BadRecording, match="RVL is not read: record it as PNG"):
        _read(path, depth_topic=f"{DEPTH}/c")


@pytest.mark.parametrize("name", KINDS)
def test_a_bag_that_is_cut_off_or_damaged_is_told_wherever_it_is(
    small: tuple[Frame, ...], tmp_path: Path, name: str
) -> None:
    """Whatever the bytes are: frames, or one message that names the bag."""
    path = _plain(tmp_path / name, small)
    whole = path.read_bytes()
    rng = np.random.default_rng(7)
    refused = 0
    for trial in range(60):
        data = bytearray(whole)
        if trial % 3 == 0:
            del data[int(rng.integers(len(data))) :]
        else:
            for at in rng.integers(len(data), size=1 if trial % 3 == 1 else 40):
                data[at] = int(rng.integers(256))
        path.write_bytes(data)
        with suppress(BadRecording):
            _read(path, frame=SCENE)
            continue
        refused += 1
    assert refused > 15


def test_a_length_that_no_file_has_takes_no_memory(small: tuple[Frame, ...], tmp_path: Path) -> None:
    path = _plain(tmp_path / "table.mcap", small)
    data = bytearray(path.read_bytes())
    data[9:17] = struct.pack("<Q", 1 << 60)  # of the first record
    path.write_bytes(data)
    with pytest.raises(BadRecording, match="the bag cannot be read"):
        _read(path)


def test_an_index_beyond_all_files_is_told_of_the_bag(small: tuple[Frame, ...], tmp_path: Path) -> None:
    """Seeking there is an error of the system, which names no file."""
    path = _plain(tmp_path / "table.bag", small)
    data = path.read_bytes()
    at = data.index(b"index_pos=") + 10
    path.write_bytes(data[:at] + b"\xff" * 8 + data[at + 8 :])
    with pytest.raises(BadRecording, match="the bag cannot be read"):
        _read(path)


def test_a_chunk_that_unpacks_to_more_than_memory_is_refused(
    small: tuple[Frame, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A million zeros are a few bytes of bzip2, which take the place of a chunk's."""
    monkeypatch.setattr(bag_file, "LARGEST_CHUNK", 1 << 20)
    path = _plain(tmp_path / "table.bag", small)
    data = path.read_bytes()
    at = data.index(b"compression=lz4") - 4
    head = data.rindex(b"op=\x05", 0, at + 40) - 8
    length = struct.unpack("<I", data[head : head + 4])[0]
    size_at = head + 4 + length
    (size,) = struct.unpack("<I", data[size_at : size_at + 4])
    bomb = bz2.compress(bytes((1 << 20) + 1))
    header = data[head : head + 4 + length].replace(b"compression=lz4", b"compression=bz2")
    changed = data[:head] + header + data[size_at : size_at + 4] + bomb.ljust(size, b"\0")
    path.write_bytes(changed + data[size_at + 4 + size :])
    with pytest.raises(BadRecording, match="unpacks to more than 1 MiB"):
        _read(path)


def test_chunks_of_mcap_are_unpacked_up_to_their_limit(
    small: tuple[Frame, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ros = Ros(False)
    path = write_bag(tmp_path / "table.mcap", told_messages(ros, small), ros, CompressionMode.STORAGE)
    np.testing.assert_array_equal(_read(path)[3].colour, small[3].colour)
    monkeypatch.setattr(bag_file, "LARGEST_CHUNK", 1 << 10)
    with pytest.raises(BadRecording, match="a chunk of it is larger than 1 KiB"):
        _read(path)


@pytest.mark.parametrize("name", KINDS[1:])
def test_messages_that_are_compressed_by_themselves_are_refused_with_the_mend(
    small: tuple[Frame, ...], tmp_path: Path, name: str
) -> None:
    ros = Ros(False)
    path = write_bag(tmp_path / name, told_messages(ros, small), ros, CompressionMode.MESSAGE)
    with pytest.raises(BadRecording, match="compressed by itself: `ros2 bag convert` unpacks them"):
        _read(path)


def test_what_is_no_file_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "table.bag")
    with pytest.raises(OSError, match="named pipe"):
        _read(tmp_path / "table.bag")
    for name in KINDS:
        with pytest.raises(FileNotFoundError):
            _read(tmp_path / f"missing{name}")
        (tmp_path / f"empty{name}").touch()
        with pytest.raises(BadRecording, match="the bag cannot be read"):
            _read(tmp_path / f"empty{name}")


def _moved(x: float) -> Any:
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[0, 3] = x
    return pose


@pytest.mark.parametrize("name", KINDS[:2])
def test_tf_is_followed_up_and_down_and_between_its_stamps(
    small: tuple[Frame, ...], tmp_path: Path, name: str
) -> None:
    """The arm moves the camera by 8 cm a second in a room in which the table stands at x = 1."""
    ros = _ros(name)
    messages = [each for each in told_messages(ros, small) if "tf" not in each[0]]
    shifted = np.eye(4)
    shifted[0, 3] = 1.0
    messages += [("/tf_static", TREE, 0.0, ros.tree(0.0, "/room", SCENE, shifted))]
    messages += [
        ("/tf", TREE, clock, ros.tree(clock, "room", OPTICAL, _moved(1 + 0.08 * (clock - 5))))
        for clock in (5.5, 4.9, 5.3)
    ]
    path = write_bag(tmp_path / name, messages, ros)
    places = [one.camera.pose[0, 3] for one in _read(path, frame=SCENE)]
    assert places == pytest.approx([0.0, 0.01, 0.02, 0.03], abs=1e-9)
    with pytest.raises(
        BadRecording, match=r"no way from `camera_color_optical_frame` to `tabel`.*frames: cam"
    ):
        _read(path, frame="tabel")


def test_tf_that_says_nothing_is_told(small: tuple[Frame, ...], tmp_path: Path) -> None:
    ros = Ros(False)
    bare = [each for each in told_messages(ros, small) if "tf" not in each[0]]
    with pytest.raises(BadRecording, match=r"`--frame`\); no tf was recorded"):
        _read(write_bag(tmp_path / "bare.mcap", bare, ros), frame=SCENE)
    for number, (clock, parent, x, said) in enumerate(
        [
            (1.0, SCENE, 0.0, r"tf does not say where the camera was at 5\.000 s"),
            (5.0, SCENE, np.nan, "no possible place of `camera_color_optical_frame`"),
            (5.0, OPTICAL, 0.0, "in coordinates of its own"),
        ]
    ):
        told = ros.tree(clock, parent, OPTICAL, _moved(x))
        path = write_bag(tmp_path / f"{number}.mcap", [*bare, ("/tf", TREE, 5.0, told)], ros)
        with pytest.raises(BadRecording, match=said):
            _read(path, frame=SCENE)


def test_a_file_of_another_kind_is_no_recording(tmp_path: Path) -> None:
    (tmp_path / "table.png").touch()
    with pytest.raises(BadRecording, match=r"neither a folder nor a bag \(\.bag, \.mcap, \.db3\)"):
        recorded_frames(tmp_path / "table.png", Reading(), 3)


def test_options_of_bags_are_not_passed_over_elsewhere(tmp_path: Path) -> None:
    with pytest.raises(BadRecording, match="`--frame` is for bags of ROS, and this is none"):
        recorded_looks(tmp_path, Reading(frame="table"))
