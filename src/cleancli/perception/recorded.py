"""Frames on disk: one folder a set, so that perception runs on what a camera has recorded.

A set is `camera.json` (size, focal length, optical centre, pose if it is known, the clock of each frame), and
for each frame `colour-000.png` (RGB) and `depth-000.png` (16 bits, millimetres, 0 where unknown).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import cv2
import msgspec
import numpy as np

from cleancli.array_types import Floats
from cleancli.files.plain import read_plain
from cleancli.files.replace import replace_file
from cleancli.files.untrusted import is_whole_png, png_size
from cleancli.geometry.rgbd import Camera, Frame

CAMERA = "camera.json"
MILLIMETRES = 1000
ROUNDED = 0.01
"""How far a rotation written by hand may be from one."""
LARGEST_CAMERA = 8 << 20
LARGEST_PICTURE = 64 << 20
"""Bytes of a file."""
MOST_PIXELS = 3840 * 2160
MOST_IN_ALL = 32 << 20
"""Pixels of a frame and of all frames of a look, for which perception takes some 0.9 GB of memory."""
FARTHEST = 65.535  # metres; what is farther away is written as unknown


class BadRecording(OSError):
    """A folder that holds no readable set of frames; the message names the file and what is wrong."""


def save_frames(frames: Sequence[Frame], folder: Path) -> None:
    """Write frames of one camera into `folder`, which is made if it is missing. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, frame in enumerate(frames):
        bgr = cv2.cvtColor(frame.colour, cv2.COLOR_RGB2BGR)
        known = np.isfinite(frame.depth) & (frame.depth > 0) & (frame.depth <= FARTHEST)
        depth = np.rint(np.where(known, frame.depth, 0) * MILLIMETRES).astype(np.uint16)
        for name, image in ((_colour(number), bgr), (_depth(number), depth)):
            _, data = cv2.imencode(".png", image)
            replace_file(folder / name, data.tobytes())
    camera = frames[0].camera
    described = {
        "width": camera.width,
        "height": camera.height,
        "focal": camera.focal,
        "centre": list(camera.centre),
        "pose": camera.pose.tolist() if camera.located else None,
        "clocks": [frame.clock for frame in frames],
    }
    replace_file(folder / CAMERA, json.dumps(described, indent=2) + "\n")


def load_frames(folder: Path) -> tuple[Frame, ...]:
    """The frames of a set in their order. Raises OSError, and so BadRecording."""
    camera, clocks = _read_camera(folder / CAMERA)
    return tuple(_read_frame(folder, number, camera, clock) for number, clock in enumerate(clocks))


_Row = tuple[float, float, float, float]
_Above = msgspec.Meta(gt=0)


class _CameraFile(msgspec.Struct):
    """`camera.json`: sizes and focal length in pixels, the pose in metres, clocks in seconds."""

    width: Annotated[int, _Above]
    height: Annotated[int, _Above]
    focal: Annotated[float, _Above]
    centre: tuple[float, float]
    clocks: tuple[float, ...]
    pose: tuple[_Row, _Row, _Row, _Row] | None = None


def _read_camera(path: Path) -> tuple[Camera, tuple[float, ...]]:
    try:
        text = read_plain(path, LARGEST_CAMERA).decode("utf-8")
        read = msgspec.json.decode(text, type=_CameraFile)
    except RecursionError:
        raise BadRecording(f"{path}: no description of a camera (it is nested too deeply)") from None
    except (msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise BadRecording(f"{path}: no description of a camera ({error})") from error
    pose = np.eye(4) if read.pose is None else np.array(read.pose)
    if not _is_rigid(pose):
        raise BadRecording(f"{path}: `pose` must be a rotation and a place, its last row 0 0 0 1")
    camera = Camera(read.width, read.height, read.focal, read.centre, pose, read.pose is not None)
    pixels = read.width * read.height
    if pixels > MOST_PIXELS:
        raise BadRecording(f"{path}: a frame may have at most 3840 x 2160 pixels, not {_size(camera)}")
    if pixels * len(read.clocks) > MOST_IN_ALL:
        most = MOST_IN_ALL // pixels
        raise BadRecording(f"{path}: of {_size(camera)} pixels a look may have at most {most} frames")
    if not read.clocks:
        raise BadRecording(f"{path}: `clocks` lists no frame")
    return camera, read.clocks


def _size(camera: Camera) -> str:
    return f"{camera.width} x {camera.height}"


def _is_rigid(pose: Floats) -> bool:
    turn = pose[:3, :3]
    is_rotation = np.allclose(turn @ turn.T, np.eye(3), atol=ROUNDED) and np.linalg.det(turn) > 0
    return bool(is_rotation and np.allclose(pose[3], (0, 0, 0, 1), atol=ROUNDED))


def _read_frame(folder: Path, number: int, camera: Camera, clock: float) -> Frame:
    colour = _read_image(folder / _colour(number), (camera.height, camera.width, 3), np.uint8)
    depth = _read_image(folder / _depth(number), (camera.height, camera.width), np.uint16)
    rgb = cv2.cvtColor(colour, cv2.COLOR_BGR2RGB).astype(np.uint8)
    return Frame(rgb, (depth / MILLIMETRES).astype(np.float32), camera, clock)


def _read_image(
    path: Path, shape: tuple[int, ...], kind: type[np.uint8] | type[np.uint16]
) -> cv2.typing.MatLike:
    if not path.exists():
        raise BadRecording(f"{path}: missing, though {CAMERA} gives this frame a clock")
    data, wanted = read_plain(path, LARGEST_PICTURE), f"{CAMERA} asks for {np.dtype(kind)} {shape}"
    size = png_size(data)
    if size is not None and size != (shape[1], shape[0]):
        raise BadRecording(f"{path}: a picture of {size[0]} x {size[1]} pixels, but {wanted}")
    is_whole = size is not None and is_whole_png(data)
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if is_whole else None
    if image is None:
        raise BadRecording(f"{path}: no PNG picture")
    if image.shape != shape or image.dtype != kind:
        raise BadRecording(f"{path}: {image.dtype} {image.shape}, but {wanted}")
    return image


def _colour(number: int) -> str:
    return f"colour-{number:03}.png"


def _depth(number: int) -> str:
    return f"depth-{number:03}.png"
