"""The video of a run."""

from __future__ import annotations

import shutil
from pathlib import Path

import av
import numpy as np
import pytest

from cleancli.recording.video import VIDEO_RATE, Video


def test_a_video_that_was_never_finished_plays_up_to_its_last_whole_second(tmp_path: Path) -> None:
    video = Video(tmp_path / "whole.mp4")
    picture = np.full((120, 160, 3), 200, np.uint8)
    for number in range(3 * VIDEO_RATE + 5):
        picture[:, number : number + 20] = number
        video.add(picture, float(number), "pushing", "actions 1.0 s")
        if number == 2 * VIDEO_RATE + 5:
            shutil.copy(tmp_path / "whole.mp4", tmp_path / "cut.mp4")
    video.close()
    assert _frames(tmp_path / "whole.mp4") == 3 * VIDEO_RATE + 5
    assert _frames(tmp_path / "cut.mp4") == pytest.approx(2 * VIDEO_RATE, abs=1)


def _frames(path: Path) -> int:
    with av.open(str(path)) as container:
        return sum(1 for _ in container.decode(video=0))
