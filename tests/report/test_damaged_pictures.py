"""Pictures that others may have written: those of a run always fit, and a damaged one prints nothing."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from cleancli.perception.frame_source import BadRecording
from cleancli.perception.recorded import read_png
from cleancli.recording.run_folder import STEP_SIZE
from cleancli.report.pictures import MOST_PIXELS, data_uri
from cleancli.scene.kinds import MOST_PIXELS as OF_A_SCENE


def test_the_largest_picture_that_a_run_writes_fits() -> None:
    room = STEP_SIZE[0] / STEP_SIZE[1]
    largest = max((min(4096, OF_A_SCENE // height) + room * height) * height for height in range(16, 4097))
    assert largest * 2 < MOST_PIXELS


def test_a_damaged_picture_is_left_out_and_nothing_is_printed(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(7)
    shape = (40, 50, 3)
    _, encoded = cv2.imencode(".png", rng.integers(0, 255, shape, np.uint8))
    whole, path = encoded.tobytes(), tmp_path / "step-001.png"
    path.write_bytes(whole)
    assert data_uri(path) is not None
    assert read_png(path, shape, np.uint8).shape == shape
    for number in range(60):
        content = bytearray(whole)
        if number % 3:
            content[rng.integers(24, len(whole))] ^= int(rng.integers(1, 256))
        else:
            del content[rng.integers(24, len(whole)) :]
        path.write_bytes(content)
        assert data_uri(path) is None
        with pytest.raises(BadRecording):
            read_png(path, shape, np.uint8)
    assert capfd.readouterr() == ("", "")
