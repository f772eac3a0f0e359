"""Pictures of a run for people: one a step, and a video of the room."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cleancli.execution.events import Situation, Started
from cleancli.perception.pictures import draw, project

Picture = NDArray[np.uint8]

VIDEO_INTERVAL = 0.2
"""Seconds of robot time between two pictures of the video."""

VIDEO_RATE = 20
"""Pictures per second when it is played: four times as fast as the robot moves."""

STROKE_COLOUR = (30, 90, 220)


def step_picture(situation: Situation, started: Started | None, room: Picture) -> Picture:
    """What the camera saw, with areas and the coming stroke, beside the room at the stroke's end."""
    seen = draw(situation.frame, situation.areas)
    title = f"0. first look: {len(situation.areas)} areas"
    if started is not None:
        title = f"{started.number}. {started.action}({', '.join(started.arguments)})"
        points = [(w.x, w.y) for w in started.path.waypoints if w.z <= 0]
        pixels = np.rint(project(situation.frame.camera, np.array(points))).astype(int)
        for start, end in zip(pixels[:-1], pixels[1:], strict=True):
            cv2.arrowedLine(seen, _pair(start), _pair(end), STROKE_COLOUR, 2, cv2.LINE_AA, tipLength=0.06)
    height = seen.shape[0]
    width = round(room.shape[1] * height / room.shape[0])
    both = np.hstack([seen, cv2.resize(room, (width, height), interpolation=cv2.INTER_AREA)])
    return _captioned(both, title)


def write_png(path: Path, picture: Picture) -> None:
    """Write an RGB picture; raises OSError where the file cannot be written."""
    _, data = cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
    path.write_bytes(data.tobytes())


class Video:
    """A WebM file (VP8, which every browser plays) of pictures taken at even steps of robot time."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._writer: cv2.VideoWriter | None = None
        self._due = 0.0

    def wants(self, clock: float) -> bool:
        """Whether the next picture is due."""
        return clock >= self._due

    def add(self, picture: Picture, clock: float, caption: str) -> None:
        """Append an RGB picture; all must have one size. Raises OSError where the file can't be opened."""
        self._due = max(self._due + VIDEO_INTERVAL, clock)
        frame = _captioned(picture, f"{clock:6.1f} s  {caption}")
        if self._writer is None:
            size = (frame.shape[1], frame.shape[0])
            self._writer = cv2.VideoWriter(str(self._path), cv2.VideoWriter.fourcc(*"VP80"), VIDEO_RATE, size)
            if not self._writer.isOpened():
                raise OSError(f"cannot write the video {self._path}")
        self._writer.write(cv2.cvtColor(frame, cv2.COLOR_RGB2BGR))

    def close(self) -> None:
        """Finish the file."""
        if self._writer is not None:
            self._writer.release()


def _captioned(picture: Picture, caption: str) -> Picture:
    """The picture under a strip with a line of text."""
    strip = np.full((28, picture.shape[1], 3), 255, np.uint8)
    cv2.putText(strip, caption, (8, 19), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (20, 20, 20), 1, cv2.LINE_AA)
    return np.vstack([strip, picture])


def _pair(point: NDArray[np.int_]) -> tuple[int, int]:
    return int(point[0]), int(point[1])
