"""`camera.json`: what a folder of pictures says of the camera that took them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np

from cleancli.array_types import Floats
from cleancli.files.plain import read_plain
from cleancli.language.diagnostics.sink import meant
from cleancli.perception.frame_source import MOST_PIXELS, BadRecording
from cleancli.perception.lens import Lens, UnknownLens, lens

CAMERA = "camera.json"
LARGEST_CAMERA = 8 << 20
"""Bytes."""
ROUNDED = 0.01
"""How far a rotation written by hand may be from one."""

_Row = tuple[float, float, float, float]
_Above = msgspec.Meta(gt=0)


class Distortion(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A model by ROS's name for it, and its coefficients in OpenCV's order."""

    model: str
    coefficients: tuple[float, ...]


class CameraFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Sizes and focal lengths in pixels, the pose in metres, clocks in seconds, `depth_scale` in steps of a
    depth picture to a metre."""

    width: Annotated[int, _Above]
    height: Annotated[int, _Above]
    focal: float | tuple[float, float]  # above 0, which `lens` tells: msgspec crashes where this type does
    centre: tuple[float, float]
    distortion: Distortion | None = None
    pose: tuple[_Row, _Row, _Row, _Row] | None = None
    clocks: tuple[float, ...] | None = None
    depth_scale: Annotated[float, msgspec.Meta(ge=1)] | None = None

    @property
    def size(self) -> str:
        """For messages."""
        return f"{self.width} x {self.height}"


_MEANING = {
    "width": "the pictures' width in pixels",
    "height": "the pictures' height in pixels",
    "focal": "the focal length in pixels, or [fx, fy]",
    "centre": "the optical centre in pixels, [cx, cy]",
}
_ELSEWHERE = {
    "center": "centre",
    "principal_point": "centre",
    "cx": "centre",
    "fx": "focal",
    "focal_length": "focal",
    "K": "focal` and `centre",
    "intrinsics": "focal` and `centre",
    "D": "distortion",
    "dist_coeffs": "distortion",
    "extrinsics": "pose",
    "timestamps": "clocks",
    "scale": "depth_scale",
}
"""Keys of other programs' files, and what means the same here."""


def read_camera_file(path: Path) -> CameraFile:
    """A camera whose numbers are possible. Raises OSError, and so BadRecording."""
    try:
        text = read_plain(path, LARGEST_CAMERA).decode("utf-8")
        _refuse_other_keys(path, text)
        read = msgspec.json.decode(text, type=CameraFile)
    except RecursionError:
        raise BadRecording(f"{path}: no description of a camera (it is nested too deeply)") from None
    except (msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise BadRecording(f"{path}: no description of a camera ({error})") from error
    if read.pose is not None and not is_rigid(np.array(read.pose)):
        raise BadRecording(f"{path}: `pose` must be a rotation and a place, its last row 0 0 0 1")
    if read.width * read.height > MOST_PIXELS:
        raise BadRecording(f"{path}: a frame may have at most 3840 x 2160 pixels, not {read.size}")
    lens_of(read, path)
    return read


def lens_of(read: CameraFile, path: Path) -> Lens:
    """Raises BadRecording for a lens that no picture can be rectified with."""
    focal = read.focal if isinstance(read.focal, tuple) else (read.focal, read.focal)
    given = read.distortion
    try:
        return lens(focal, read.centre, given.model if given else "", given.coefficients if given else ())
    except UnknownLens as error:
        raise BadRecording(f"{path}: {error}") from None


def is_rigid(pose: Floats) -> bool:
    """Whether a matrix (4, 4) is a rotation and a place."""
    turn = pose[:3, :3]
    is_rotation = np.allclose(turn @ turn.T, np.eye(3), atol=ROUNDED) and np.linalg.det(turn) > 0
    return bool(is_rotation and np.allclose(pose[3], (0, 0, 0, 1), atol=ROUNDED))


def _refuse_other_keys(path: Path, text: str) -> None:
    """A key that is not understood may say how pictures are distorted: it is not passed over."""
    keys = msgspec.json.decode(text, type=dict[str, object])
    known = CameraFile.__struct_fields__
    for key in keys:
        if key not in known:
            same = _ELSEWHERE.get(key)
            help_ = f"here it is `{same}`" if same else meant(key, known, "key")
            raise BadRecording(f"{path}: no description of a camera: it has no key `{key}`; {help_}")
    for key, meaning in _MEANING.items():
        if key not in keys:
            raise BadRecording(f"{path}: no description of a camera: `{key}` is missing, {meaning}")
