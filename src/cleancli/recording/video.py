"""A video of the room, as long as a run goes on."""

from __future__ import annotations

from pathlib import Path

import av

from cleancli.array_types import Image
from cleancli.recording.caption import captioned

VIDEO_INTERVAL = 0.2
"""Seconds of robot time between two pictures of the video."""

VIDEO_RATE = 20
"""Pictures per second when it is played: four times as fast as the robot moves."""

ENCODING = {"tune": "zerolatency", "preset": "veryfast", "crf": "26"}
"""Of H.264. Chosen: about half of the time that the encoder's defaults take, and files that are no larger."""


class Video:
    """An H.264 file of pictures at even steps of robot time; cut short by a crash, it can still be read."""

    def __init__(self, path: Path) -> None:
        # Each second of the video is a fragment of its own, written as soon as it is over.
        options = {"movflags": "frag_keyframe+empty_moov", "flush_packets": "1"}
        self._container = av.open(str(path), "w", options=options)
        self._stream = self._container.add_stream("libx264", rate=VIDEO_RATE, options=ENCODING)
        self._stream.gop_size = VIDEO_RATE
        self._stream.pix_fmt = "yuv420p"  # the one colour layout that every player knows
        self._empty = True
        self._due = 0.0

    def wants(self, clock: float) -> bool:
        """Whether the next picture is due."""
        return clock >= self._due

    def add(self, picture: Image, clock: float, action: str, account: str) -> None:
        """Append an RGB picture of even size, with texts above it; all must have one size. Raises OSError
        where writing fails."""
        self._due = max(self._due + VIDEO_INTERVAL, clock)
        picture = captioned(picture, (action, f"{clock:.1f} s of robot time"), (account, ""))
        if self._empty:
            self._stream.height, self._stream.width = picture.shape[:2]
            self._empty = False
        self._container.mux(self._stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))

    def close(self) -> None:
        """Finish the file."""
        self._container.mux(self._stream.encode())
        self._container.close()
