"""Pictures and lenses of ROS's messages: `Image`, `CompressedImage` and `CameraInfo` of its sensor_msgs.

Sizes are compared with the data, and read from the headers of what is compressed, before anything is decoded.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Depth, Floats, Image
from cleancli.files.untrusted import is_whole_jpeg, is_whole_png, jpeg_size, png_size
from cleancli.perception.frame_source import MOST_PIXELS
from cleancli.perception.lens import Lens, UnknownLens, lens
from cleancli.perception.recorded import MILLIMETRES

PICTURE, PACKED, INFO = (
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/CompressedImage",
    "sensor_msgs/msg/CameraInfo",
)
DEPTHS = {"16UC1": "u2", "mono16": "u2", "32FC1": "f4"}
"""Encodings of depth: millimetres in whole numbers, metres as floats."""
COLOURS = {"rgb8": 3, "bgr8": 3, "rgba8": 4, "bgra8": 4, "mono8": 1, "8UC1": 1}
"""Encodings of colour, and how many channels each has."""
GREYS = ("mono8", "8UC1")
HEADER = struct.Struct("<iff")
"""Before compressed depth: its form, and two numbers of how distances were made whole."""


class BadPicture(Exception):
    """A message that no picture or lens can be made of; the message is a sentence without a subject."""


@dataclass(frozen=True, slots=True)
class Kind:
    """What a message shows, without its pixels: `frame` is the coordinate frame that it was taken in."""

    encoding: str
    width: int
    height: int
    frame: str
    is_depth: bool
    is_packed: bool

    @property
    def is_grey(self) -> bool:
        """Whether it is neither depth nor colour: infrared, as a rule."""
        return self.encoding.split(";")[0].strip() in GREYS

    def __str__(self) -> str:
        return f"{self.encoding}, {self.width} x {self.height}, frame `{self.frame}`"


def stamp_of(message: Any) -> float:
    """Seconds."""
    stamp = message.header.stamp
    return float(stamp.sec + stamp.nanosec / 1e9)


def frame_of(name: str) -> str:
    """A coordinate frame's name as ROS 2 writes it; ROS 1 may begin it with a slash."""
    return name.removeprefix("/")


def kind_of(message: Any) -> Kind:
    """What an Image or a CompressedImage shows. Raises BadPicture."""
    frame = frame_of(message.header.frame_id)
    if hasattr(message, "encoding"):
        _check_size((message.width, message.height))
        is_depth = message.encoding in DEPTHS
        return Kind(message.encoding, message.width, message.height, frame, is_depth, False)
    is_depth, data = _packed(message)
    width, height = _size(data)
    return Kind(message.format, width, height, frame, is_depth, True)


def colour_of(message: Any) -> Image:
    """Red, green and blue (height, width, 3). Raises BadPicture."""
    if not hasattr(message, "encoding"):
        is_depth, data = _packed(message)
        if is_depth:
            raise BadPicture(f"`{message.format}` is depth and no colour")
        return _rgb(_decoded(data), "bgr8")
    channels = COLOURS.get(message.encoding)
    if channels is None:
        raise BadPicture(f"the encoding `{message.encoding}` is none of {', '.join(COLOURS)}")
    return _rgb(_pixels(message, "u1", channels), message.encoding)


def depth_of(message: Any) -> Depth | Floats:
    """Metres (height, width); what is no distance is unknown. Raises BadPicture."""
    if not hasattr(message, "encoding"):
        return _unpacked_depth(message)
    kind = DEPTHS.get(message.encoding)
    if kind is None:
        raise BadPicture(f"the encoding `{message.encoding}` is none of {', '.join(DEPTHS)}")
    steps = _pixels(message, kind, 1)[:, :, 0]
    return steps.astype("=f4") if kind == "f4" else steps / MILLIMETRES


def lens_of(info: Any, is_rectified: bool) -> Lens:
    """The lens of a CameraInfo (K and D); of pictures that are rectified, what they were rectified to (P).
    Raises BadPicture."""
    k, d, p = (_either(info, name) for name in "KDP")
    if (
        info.binning_x > 1
        or info.binning_y > 1
        or info.roi.do_rectify
        or info.roi.x_offset
        or info.roi.y_offset
    ):
        raise BadPicture("it is of a part of the picture, or of one that is binned: record whole pictures")
    try:
        if is_rectified and p[0] > 0:
            return lens((p[0], p[5]), (p[2], p[6]))
        if not k[0] > 0:
            raise BadPicture("its `K` is 0: the camera is not calibrated")
        return lens((k[0], k[4]), (k[2], k[5]), info.distortion_model, d)
    except UnknownLens as error:
        raise BadPicture(str(error)) from None


def _either(info: Any, name: str) -> Sequence[float]:
    """A field that ROS 1 writes large and ROS 2 small."""
    values = getattr(info, name) if hasattr(info, name) else getattr(info, name.lower())
    return [float(value) for value in values]


def _check_size(size: tuple[int, int]) -> None:
    width, height = size
    if width < 1 or height < 1 or width * height > MOST_PIXELS:
        raise BadPicture(f"a picture of {width} x {height} pixels, and at most 3840 x 2160 are read")


def _pixels(message: Any, kind: str, channels: int) -> NDArray[Any]:
    """The values of an Image (height, width, channels); rows may be longer than they need be."""
    width, height, step = message.width, message.height, message.step
    _check_size((width, height))
    dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    row = width * channels * dtype.itemsize
    if step < row or step * height > len(message.data):
        raise BadPicture(
            f"{len(message.data)} bytes are too few for {width} x {height} of {message.encoding}"
        )
    data = np.ascontiguousarray(message.data, dtype=np.uint8)[: step * height].reshape(height, step)
    return np.ascontiguousarray(data[:, :row]).view(dtype).reshape(height, width, channels)


def _rgb(pixels: NDArray[Any], encoding: str) -> Image:
    if pixels.dtype != np.uint8:
        raise BadPicture(f"colour has 8 bits a channel, not {8 * pixels.dtype.itemsize}")
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    if channels == 1:
        return np.repeat(pixels.reshape(*pixels.shape[:2], 1), 3, axis=2)
    ordered = pixels[:, :, :3] if encoding.startswith("rgb") else pixels[:, :, 2::-1]
    return np.ascontiguousarray(ordered)


def _packed(message: Any) -> tuple[bool, bytes]:
    """Whether a CompressedImage is depth, and the PNG or JPEG in it. Raises BadPicture."""
    data, told = bytes(message.data), message.format
    if "compressedDepth" in told:
        if "rvl" in told.lower():
            raise BadPicture("depth compressed as RVL is not read: record it as PNG (`format: png`)")
        return True, data[HEADER.size :]
    size = png_size(data)
    is_deep = size is not None and len(data) > 25 and data[24:26] == b"\x10\x00"  # 16 bits, grey
    return is_deep, data


def _size(data: bytes) -> tuple[int, int]:
    size = png_size(data) or jpeg_size(data)
    if size is None:
        raise BadPicture("neither PNG nor JPEG where its format says so")
    _check_size(size)
    return size


def _decoded(data: bytes) -> NDArray[Any]:
    """Pixels as OpenCV has them (BGR). Raises BadPicture."""
    _size(data)
    is_whole = is_whole_png(data) if png_size(data) else is_whole_jpeg(data)
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if is_whole else None
    if image is None:
        raise BadPicture("a compressed picture that is cut off or damaged")
    return image


def _unpacked_depth(message: Any) -> Floats:
    """Millimetres as they are, or distances as compressed_depth_image_transport makes them whole: the
    distance is a / (step - b)."""
    is_depth, data = _packed(message)
    if not is_depth:
        raise BadPicture(f"`{message.format}` is colour and no depth")
    steps = _decoded(data)
    if steps.ndim != 2 or steps.dtype != np.uint16:
        raise BadPicture("compressed depth has 16 bits a pixel and one channel")
    if not message.format.startswith("32FC1"):
        return steps / MILLIMETRES
    _, a, b = HEADER.unpack(bytes(message.data[: HEADER.size]))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return np.where(steps > 0, a / (steps.astype(np.float64) - b), 0)
