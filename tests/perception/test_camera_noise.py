"""Frames as a real camera takes them have the noise that the measure finds on a real camera's pictures."""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from camera_noise import Spread, colour_noise, depth_noise

from support import real_camera

PICTURES = Path(
    os.environ.get("CLEANCLI_REAL_FRAMES", Path(__file__).parents[3] / "shared" / "peers" / "frames")
)
"""Ten pictures of a RealSense, which are not part of the project."""

MEASURED = (3.0, 2.5, 3.7), 0.54, 0.0012
"""What `python benchmarks/camera_noise.py` prints: colours' noise at 95 to 145, neighbours' correlation, and
depth's noise at one metre."""


def check(colour: Spread, depth: Spread) -> None:
    spread, neighbours, at_one = MEASURED
    _, found, alike, shared = colour.quiet(95, 145)
    assert found == pytest.approx(np.array(spread), rel=0.2)
    assert alike[0] == pytest.approx(neighbours, abs=0.12)
    assert 0.1 < shared < 0.5
    _, metres, alike, _ = depth.quiet(0.75, 1.0)
    assert metres[0] / 0.9**2 == pytest.approx(at_one, rel=0.25)
    assert alike[0] == pytest.approx(0.6, abs=0.1)


def test_generated_frames_have_the_noise_of_the_pictures() -> None:
    frame = real_camera.taken(1, real_camera.SURFACES["grey"])
    check(colour_noise([frame.colour.astype(float)]), depth_noise([frame.depth.astype(float)]))


@pytest.mark.skipif(not PICTURES.exists(), reason="the pictures are not here")
def test_the_pictures_have_it() -> None:
    names = [f"{number:03}.png" for number in range(10)]
    colours = [cv2.imread(str(PICTURES / f"colour-{name}")) for name in names]
    depths = [cv2.imread(str(PICTURES / f"depth-{name}"), cv2.IMREAD_UNCHANGED) for name in names]
    check(
        colour_noise([np.asarray(each, np.float64)[:, :, ::-1] for each in colours]),
        depth_noise([np.asarray(each, np.float64) / 1000 for each in depths]),
    )
