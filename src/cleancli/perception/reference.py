"""A picture of the clean surface that takes its texture away, for cameras that stand still.

Each pixel is divided by what the clean surface shows there. What is left of grain and print is as even as a
plain surface, whatever the exposure. Light that changes smoothly is left, which background subtraction bears.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from cleancli.array_types import Image, Singles
from cleancli.files.untrusted import is_whole_png, png_size
from cleancli.geometry.rgbd import Frame

DARKEST = 4.0
"""Brightness of the clean surface, of 255, below which dividing by it would show noise alone."""


def mean_colour(frames: Sequence[Frame]) -> Singles:
    """The mean of some frames' colour, (height, width, 3)."""
    return np.asarray(np.mean([frame.colour for frame in frames], axis=0), np.float32)


def flattened(frame: Frame, clean: Singles) -> Frame:
    """The frame as if the surface had everywhere the median colour of `clean` (height, width, 3)."""
    usual = np.median(clean.reshape(-1, 3), axis=0).astype(np.float32)
    factors = usual / np.maximum(clean, np.float32(DARKEST))
    colour = np.clip(np.rint(frame.colour * factors), 0, 255).astype(np.uint8)
    return replace(frame, colour=colour)


def as_png(clean: Singles) -> bytes:
    """The picture as a calibration keeps it."""
    bgr = cv2.cvtColor(np.rint(clean).astype(np.uint8), cv2.COLOR_RGB2BGR)
    return cv2.imencode(".png", bgr)[1].tobytes()


def read_reference(data: bytes, frame: Frame) -> Image | None:
    """The picture of a calibration, None if it is none of this frame's size."""
    size = (frame.camera.width, frame.camera.height)
    if png_size(data) != size or not is_whole_png(data):
        return None
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    return None if picture is None else cv2.cvtColor(picture, cv2.COLOR_BGR2RGB).astype(np.uint8)
