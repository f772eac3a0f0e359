"""Frames on disk: one folder a set, so that perception runs on what a camera has recorded.

A set is `camera.json` (size, focal length, optical centre, pose if it is known, the clock of each frame), and
for each frame `colour-000.png` (RGB) and `depth-000.png` (16 bits, millimetres, 0 where unknown).
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from cleancli.files.plain import read_plain
from cleancli.files.replace import replace_file
from cleancli.files.untrusted import is_whole_png, png_size
from cleancli.geometry.rgbd import Frame
from cleancli.perception.camera_file import CAMERA, CameraFile, lens_of, read_camera_file
from cleancli.perception.frame_source import MOST_IN_ALL, BadRecording
from cleancli.perception.lens import FARTHEST, pinhole_frame

MILLIMETRES = 1000
LARGEST_PICTURE = 64 << 20
"""Bytes of a file."""
JPEG = b"\xff\xd8"
JPEG_ENDS = (".jpg", ".jpeg")

_LOOK = re.compile(r"look-(\d{3,9})")


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


def free_look(folder: Path) -> Path:
    """The folder of a set that comes after all that there are in `folder`."""
    found = [int(name[1]) for path in folder.glob("look-*") if (name := _LOOK.fullmatch(path.name))]
    return folder / f"look-{max(found, default=0) + 1:03}"


def load_frames(folder: Path) -> tuple[Frame, ...]:
    """The frames of a set in their order, rectified. Raises OSError, and so BadRecording."""
    path = folder / CAMERA
    read = read_camera_file(path)
    clocks = read.clocks
    if not clocks:
        raise BadRecording(f"{path}: `clocks` lists no frame; it has the seconds at which each was taken")
    if read.depth_scale not in (None, MILLIMETRES):
        raise BadRecording(f"{path}: depth-000.png counts millimetres, so `depth_scale` can only be 1000")
    if read.width * read.height * len(clocks) > MOST_IN_ALL:
        most = MOST_IN_ALL // (read.width * read.height)
        raise BadRecording(f"{path}: of {read.size} pixels a look may have at most {most} frames")
    return tuple(_read_frame(folder, number, read, clock) for number, clock in enumerate(clocks))


def _read_frame(folder: Path, number: int, read: CameraFile, clock: float) -> Frame:
    colour = read_png(folder / _colour(number), (read.height, read.width, 3), np.uint8)
    depth = read_png(folder / _depth(number), (read.height, read.width), np.uint16)
    rgb = cv2.cvtColor(colour, cv2.COLOR_BGR2RGB).astype(np.uint8)
    pose = None if read.pose is None else np.array(read.pose)
    return pinhole_frame(rgb, depth / MILLIMETRES, lens_of(read, folder / CAMERA), pose, clock)


def read_png(
    path: Path, shape: tuple[int, ...], kind: type[np.uint8] | type[np.uint16]
) -> cv2.typing.MatLike:
    """A picture of a shape and kind, as OpenCV has it (BGR). Raises OSError, and so BadRecording."""
    if not path.exists():
        raise BadRecording(f"{path}: missing{_instead_of(path)}")
    data, wanted = read_plain(path, LARGEST_PICTURE), f"{CAMERA} asks for {np.dtype(kind)} {shape}"
    size = png_size(data)
    if size is not None and size != (shape[1], shape[0]):
        raise BadRecording(f"{path}: a picture of {size[0]} x {size[1]} pixels, but {wanted}")
    is_whole = size is not None and is_whole_png(data)
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if is_whole else None
    if image is None:
        what = "a JPEG picture: convert it to PNG" if data[:2] == JPEG else "no PNG picture"
        raise BadRecording(f"{path}: {what}")
    if image.shape != shape or image.dtype != kind:
        raise BadRecording(f"{path}: {image.dtype} {image.shape}, but {wanted}")
    return image


def _instead_of(path: Path) -> str:
    """What a picture may be called that is missing, if there is one."""
    stem = path.stem.replace("colour", "color")
    for name in (f"{stem}.png", *(f"{each}{kind}" for each in (path.stem, stem) for kind in JPEG_ENDS)):
        if name != path.name and (path.parent / name).exists():
            mend = "rename it" if name.endswith(".png") else "convert it to PNG"
            return f", but there is {name}: {mend}"
    return ", though a list names it"


def _colour(number: int) -> str:
    return f"colour-{number:03}.png"


def _depth(number: int) -> str:
    return f"depth-{number:03}.png"
