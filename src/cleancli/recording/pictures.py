"""Pictures of a run for people: one a step, and a video of the room."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import av
import cv2
import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Image
from cleancli.execution.episode_state import Situation
from cleancli.execution.events import Started
from cleancli.files.replace import replace_file
from cleancli.geometry.rgbd import Frame
from cleancli.language.diagnostics.plural import plural
from cleancli.perception.pictures import draw, project

VIDEO_INTERVAL = 0.2
"""Seconds of robot time between two pictures of the video."""

VIDEO_RATE = 20
"""Pictures per second when it is played: four times as fast as the robot moves."""

STROKE_COLOUR = (30, 90, 220)
TIP_LENGTH = 10.0  # of the arrow at a stroke's end, pixels


def step_picture(frame: Frame, situation: Situation, started: Started | None, room: Image) -> Image:
    """What the camera saw, with areas and the coming stroke, beside the room at the stroke's end."""
    seen = draw(frame, situation.areas, situation.state)
    title = f"0. first look: {plural(len(situation.areas), 'area')}"
    if started is not None and started.path is not None:
        title = f"{started.number}. {started.move}"
        points = [(w.x, w.y) for w in started.path.waypoints if w.z <= 0]
        pixels = np.rint(project(frame.camera, np.array(points))).astype(int)
        for start, end in pairwise(pixels):
            tip = TIP_LENGTH / max(TIP_LENGTH, float(np.linalg.norm(end - start)))
            cv2.arrowedLine(seen, _pair(start), _pair(end), STROKE_COLOUR, 2, cv2.LINE_AA, tipLength=tip)
    height = seen.shape[0]
    width = round(room.shape[1] * height / room.shape[0])
    both = np.hstack([seen, cv2.resize(room, (width, height), interpolation=cv2.INTER_AREA)])
    return _captioned(both, title)


def write_png(path: Path, picture: Image) -> None:
    """Write an RGB picture; raises OSError where the file cannot be written."""
    replace_file(path, png_of(picture))


def png_of(picture: Image) -> bytes:
    """An RGB picture as a PNG file holds it."""
    _, data = cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
    return data.tobytes()


class Video:
    """An H.264 file of pictures at even steps of robot time; cut short by a crash, it can still be read."""

    def __init__(self, path: Path) -> None:
        # Each second of the video is a fragment of its own, written as soon as it is over.
        options = {"movflags": "frag_keyframe+empty_moov", "flush_packets": "1"}
        self._container = av.open(str(path), "w", options=options)
        self._stream = self._container.add_stream("libx264", rate=VIDEO_RATE, options={"tune": "zerolatency"})
        self._stream.gop_size = VIDEO_RATE
        self._stream.pix_fmt = "yuv420p"  # the one colour layout that every player knows
        self._empty = True
        self._due = 0.0

    def wants(self, clock: float) -> bool:
        """Whether the next picture is due."""
        return clock >= self._due

    def add(self, picture: Image, clock: float, caption: str) -> None:
        """Append an RGB picture of even size; all must have one size. Raises OSError where writing fails."""
        self._due = max(self._due + VIDEO_INTERVAL, clock)
        picture = _captioned(picture, f"{clock:6.1f} s  {caption}")
        if self._empty:
            self._stream.height, self._stream.width = picture.shape[:2]
            self._empty = False
        self._container.mux(self._stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))

    def close(self) -> None:
        """Finish the file."""
        self._container.mux(self._stream.encode())
        self._container.close()


def _captioned(picture: Image, caption: str) -> Image:
    """The picture under a strip with a line of text."""
    strip = np.full((28, picture.shape[1], 3), 255, np.uint8)
    cv2.putText(strip, caption, (8, 19), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (20, 20, 20), 1, cv2.LINE_AA)
    return np.vstack([strip, picture])


def _pair(point: NDArray[np.int_]) -> tuple[int, int]:
    return int(point[0]), int(point[1])
