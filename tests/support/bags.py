"""Bags of ROS 1 and 2 with frames in them, written by rosbags; what is odd is asked for by name."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1 import Writer as FirstWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as SecondWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from scipy.spatial.transform import Rotation

from cleancli.geometry.rgbd import Camera, Frame

COLOUR, DEPTH = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw"
INFO = "/camera/color/camera_info"
OPTICAL, SCENE = "camera_color_optical_frame", "table"
IMAGE, PACKED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
CAMERA_INFO, TREE = "sensor_msgs/msg/CameraInfo", "tf2_msgs/msg/TFMessage"


@dataclass
class Ros:
    """Messages of one version of ROS."""

    is_first: bool
    types: Any = field(init=False)

    def __post_init__(self) -> None:
        self.types = get_typestore(Stores.ROS1_NOETIC if self.is_first else Stores.ROS2_HUMBLE)
        if self.is_first:
            self.types.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TREE))

    def make(self, kind: str, **fields: Any) -> Any:
        return self.types.types[kind](**fields)

    def header(self, clock: float, frame: str) -> Any:
        seconds, rest = divmod(round(clock * 1e9), 10**9)
        stamp = self.make("builtin_interfaces/msg/Time", sec=seconds, nanosec=rest)
        seq = {"seq": 0} if self.is_first else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **seq)

    def image(self, clock: float, pixels: NDArray[Any], encoding: str, frame: str = OPTICAL) -> Any:
        height, width = pixels.shape[:2]
        data = np.frombuffer(np.ascontiguousarray(pixels).tobytes(), np.uint8)
        return self.make(
            IMAGE,
            header=self.header(clock, frame),
            height=height,
            width=width,
            encoding=encoding,
            is_bigendian=int(pixels.dtype.byteorder == ">"),
            step=data.size // height,
            data=data,
        )

    def packed(self, clock: float, data: bytes, told: str, frame: str = OPTICAL) -> Any:
        header = self.header(clock, frame)
        return self.make(PACKED, header=header, format=told, data=np.frombuffer(data, np.uint8))

    def info(
        self,
        camera: Camera,
        model: str = "plumb_bob",
        distortion: Sequence[float] = (0.0,) * 5,
        frame: str = OPTICAL,
        **fields: Any,
    ) -> Any:
        roi = self.make(
            "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        focal, (column, row) = camera.focal, camera.centre
        k = np.array([focal, 0, column, 0, focal, row, 0, 0, 1], float)
        p = np.array([focal, 0, column, 0, 0, focal, row, 0, 0, 0, 1, 0], float)
        large = {"D": np.array(distortion, float), "K": k, "R": np.eye(3).ravel(), "P": p}
        told = large if self.is_first else {name.lower(): value for name, value in large.items()}
        whole: dict[str, Any] = {
            "header": self.header(0.0, frame),
            "height": camera.height,
            "width": camera.width,
            "distortion_model": model,
            "binning_x": 0,
            "binning_y": 0,
            "roi": roi,
        }
        return self.make(CAMERA_INFO, **{**whole, **told, **fields})

    def tree(self, clock: float, parent: str, child: str, pose: NDArray[np.float64]) -> Any:
        x, y, z, w = (float(number) for number in Rotation.from_matrix(pose[:3, :3]).as_quat())
        moved = [float(number) for number in pose[:3, 3]]
        where = self.make(
            "geometry_msgs/msg/Transform",
            translation=self.make("geometry_msgs/msg/Vector3", x=moved[0], y=moved[1], z=moved[2]),
            rotation=self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w),
        )
        header = self.header(clock, parent)
        one = self.make(
            "geometry_msgs/msg/TransformStamped", header=header, child_frame_id=child, transform=where
        )
        return self.make(TREE, transforms=[one])


def millimetres(frame: Frame) -> NDArray[np.uint16]:
    """As a camera gives them."""
    return np.rint(frame.depth * 1000).astype(np.uint16)


def told_messages(ros: Ros, frames: Sequence[Frame]) -> list[tuple[str, str, float, Any]]:
    """A plain recording of frames: topic, type, when it was received, message."""
    camera = frames[0].camera
    told = [
        (INFO, CAMERA_INFO, 0.0, ros.info(camera)),
        ("/tf_static", TREE, 0.0, ros.tree(0.0, SCENE, "camera_link", camera.pose)),
        ("/tf_static", TREE, 0.0, ros.tree(0.0, "camera_link", OPTICAL, np.eye(4))),
    ]
    for frame in frames:
        told += [
            (COLOUR, IMAGE, frame.clock, ros.image(frame.clock, frame.colour, "rgb8")),
            (DEPTH, IMAGE, frame.clock, ros.image(frame.clock, frame.depth.astype("<f4"), "32FC1")),
        ]
    return told


def write_bag(
    path: Path,
    messages: Iterable[tuple[str, str, float, Any]],
    ros: Ros,
    packed: CompressionMode = CompressionMode.NONE,
) -> Path:
    """A bag of the kind that the name says (.bag, .mcap, .db3); the path of its file. One of ROS 1 has chunks
    packed by LZ4; of ROS 2 `packed` says what is, by zstd."""
    if path.suffix == ".bag":
        writer: Any = FirstWriter(path)
        writer.set_compression(FirstWriter.CompressionFormat.LZ4)
        encode = ros.types.serialize_ros1
    else:
        plugin = StoragePlugin.MCAP if path.suffix == ".mcap" else StoragePlugin.SQLITE3
        writer = SecondWriter(path.with_suffix(""), version=9, storage_plugin=plugin)
        writer.set_compression(packed, CompressionFormat.ZSTD)
        encode = ros.types.serialize_cdr
    connections: dict[tuple[str, str], Any] = {}
    with writer:
        for topic, kind, clock, message in messages:
            if (topic, kind) not in connections:
                connections[topic, kind] = writer.add_connection(topic, kind, typestore=ros.types)
            # What some recorder has put there need not be a message of the type.
            data = message if isinstance(message, bytes) else encode(message, kind)
            writer.write(connections[topic, kind], round(clock * 1e9) + 1, data)
    return path if path.suffix == ".bag" else path.with_suffix("") / path.name


def packed_png(pixels: NDArray[Any]) -> bytes:
    """PNG of pixels as OpenCV has them (BGR)."""
    data: bytes = cv2.imencode(".png", pixels)[1].tobytes()
    return data


def packed_distances(depth: NDArray[np.float32]) -> bytes:
    """As compressed_depth_image_transport packs 32FC1, for distances up to 10 m in steps for 100 m."""
    a = 100.0 * (100.0 + 1)
    b = 1 - a / 10.0
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = np.where(np.isfinite(depth) & (depth > 0), a / depth + b, 0)
    return struct.pack("<iff", 1, a, b) + packed_png(np.rint(steps).astype(np.uint16))
