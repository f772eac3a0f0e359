"""Colour and depth of a ROS 2 camera as pairs that were taken after they were asked for."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image

from cleancli.array_types import Floats
from cleancli.remote.messages import APART, FramePair

PATIENCE = 3.0
"""Real seconds that a camera may take for a pair."""
PICTURES = 8
"""Of colour and of depth, that are kept to find a pair among."""

_CHANNELS = {"rgb8": (3, (0, 1, 2)), "bgr8": (3, (2, 1, 0)), "rgba8": (4, (0, 1, 2)), "bgra8": (4, (2, 1, 0))}
"""By a colour's encoding: bytes to a pixel, and where its red, green and blue are."""
_DEPTHS = {"16UC1": (np.uint16, 0.001), "mono16": (np.uint16, 0.001), "32FC1": (np.float32, 1.0)}
"""By a depth's encoding: the type of a pixel, and its unit in metres."""

Stamped = tuple[float, Any]


class Camera:
    """Listens to three topics of a node. `seconds` makes a stamp of ROS a time on the driver's clock; `pose`
    (4, 4) is the camera's in the scene, which `cleancli cell camera` found."""

    def __init__(
        self, node: Any, colour: str, depth: str, info: str, pose: Floats, seconds: Callable[[Any], float]
    ) -> None:
        self._pose, self._seconds = pose, seconds
        self._colour, self._depth = deque[Stamped](maxlen=PICTURES), deque[Stamped](maxlen=PICTURES)
        self._info: Any = None
        self._came = threading.Condition()
        for kind, topic, kept in ((Image, colour, self._colour), (Image, depth, self._depth)):
            node.create_subscription(kind, topic, self._keeper(kept), qos_profile_sensor_data)
        node.create_subscription(CameraInfo, info, self._keep_info, qos_profile_sensor_data)

    def pair(self, after: float) -> FramePair:
        """The first pair of pictures that were both taken after a time of the driver's clock. Raises
        TimeoutError, and ValueError for pictures that cannot be read."""
        with self._came:
            if not self._came.wait_for(lambda: self._found(after) is not None, PATIENCE):
                raise TimeoutError(self._missing(after))
            found, info = self._found(after), self._info
        assert found is not None
        (colour_stamp, colour), (depth_stamp, depth) = found
        if (colour.width, colour.height) != (depth.width, depth.height):
            raise ValueError("colour and depth have different sizes: register depth to colour")
        return FramePair(
            colour_of(colour),
            depth_of(depth),
            colour_stamp,
            depth_stamp,
            (float(info.k[0]), float(info.k[4])),
            (float(info.k[2]), float(info.k[5])),
            self._pose,
            str(info.distortion_model) if any(info.d) else "",
            tuple(map(float, info.d)) if any(info.d) else (),
        )

    def _keeper(self, kept: deque[Stamped]) -> Callable[[Any], None]:
        def keep(picture: Any) -> None:
            with self._came:
                kept.append((self._seconds(picture.header.stamp), picture))
                self._came.notify_all()

        return keep

    def _keep_info(self, info: Any) -> None:
        with self._came:
            self._info = info
            self._came.notify_all()

    def _found(self, after: float) -> tuple[Stamped, Stamped] | None:
        if self._info is None:
            return None
        pairs = (
            (colour, depth)
            for colour in self._colour
            for depth in self._depth
            if min(colour[0], depth[0]) > after and abs(colour[0] - depth[0]) <= APART
        )
        return next(pairs, None)

    def _missing(self, after: float) -> str:
        """What of a pair did not come."""
        if self._info is None:
            return "no camera_info came"
        for name, kept in (("colour", self._colour), ("depth", self._depth)):
            if not kept:
                return f"no picture of {name} came"
            if kept[-1][0] <= after:
                return (
                    f"no new picture of {name} came; the last one's stamp is {after - kept[-1][0]:.2f} s old"
                )
        return f"colour and depth are more than {APART:g} s apart"


def colour_of(picture: Any) -> NDArray[np.uint8]:
    """(height, width, 3) of a sensor_msgs/Image: red, green, blue. Raises ValueError."""
    if picture.encoding not in _CHANNELS:
        raise ValueError(f"colour comes as `{picture.encoding}`, and only {', '.join(_CHANNELS)} are read")
    channels, order = _CHANNELS[picture.encoding]
    rows = np.frombuffer(picture.data, np.uint8).reshape(picture.height, picture.step)
    pixels = rows[:, : channels * picture.width].reshape(picture.height, picture.width, channels)
    return np.ascontiguousarray(pixels[:, :, order])


def depth_of(picture: Any) -> NDArray[np.float32]:
    """(height, width) of a sensor_msgs/Image in metres, 0 where nothing is known. Raises ValueError."""
    if picture.encoding not in _DEPTHS:
        raise ValueError(f"depth comes as `{picture.encoding}`, and only {', '.join(_DEPTHS)} are read")
    kind, unit = _DEPTHS[picture.encoding]
    stored = np.dtype(kind).newbyteorder(">" if picture.is_bigendian else "<")
    rows = np.frombuffer(picture.data, np.uint8).reshape(picture.height, picture.step)
    pixels = np.ascontiguousarray(rows[:, : stored.itemsize * picture.width]).view(stored)
    metres = pixels.astype(np.float32) * np.float32(unit)
    return np.where(np.isfinite(metres) & (metres > 0), metres, np.float32(0))
