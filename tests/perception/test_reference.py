"""A picture of the clean surface takes wood's grain away, and is dropped with a doubt if it does not fit."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from real_tables import compared

from cleancli.geometry.rgbd import Frame
from cleancli.perception.calibrate import Adjusted, calibrate
from cleancli.perception.perceive import BadFrame, Observation, perceive
from cleancli.perception.reference import flattened
from cleancli.scene.calibration import BadCalibration, as_text, read_calibration
from support import real_camera, synthetic
from support.real_camera import Light

GRAIN = real_camera.wood(7)
LIGHT = Light(1.0, 0.2, 1.0)
NONE = np.zeros((0, 2))
PLACES = synthetic.scattered(np.random.default_rng(3), 25)


def wood(seed: int, light: Light = LIGHT, kind: str | None = None, moved: int = 0) -> Frame:
    places, shade = (NONE, (1.0, 1.0, 1.0)) if kind is None else (PLACES, real_camera.SHADES[kind])
    grain = np.roll(GRAIN, moved, axis=0)
    return real_camera.taken(seed, real_camera.SURFACES["wood"], light, places, shade, texture=grain)


@pytest.fixture(scope="module")
def found() -> Adjusted:
    frames = [wood(seed) for seed in range(6)]
    return calibrate(frames, synthetic.scene(), "wood.json", np.random.default_rng(0), keeps_picture=True)


def see(frame: Frame, found: Adjusted, with_picture: bool = True) -> Observation:
    calibration = found.calibration if with_picture else replace(found.calibration, reference=None)
    return perceive([frame], replace(synthetic.scene(), calibration=calibration), np.random.default_rng(0))


def test_flattened_is_what_division_pixel_by_pixel_gives() -> None:
    frame, clean = wood(1), wood(2).colour.astype(np.float32)
    flat = flattened(frame, clean).colour
    usual = [float(np.median(clean[:, :, channel])) for channel in range(3)]
    for row, column in ((100, 100), (240, 320), (400, 500)):
        for channel in range(3):
            wanted = frame.colour[row, column, channel] * usual[channel] / clean[row, column, channel]
            assert flat[row, column, channel] == pytest.approx(min(255, wanted), abs=0.51)


@pytest.mark.parametrize("light", [LIGHT, replace(LIGHT, exposure=0.8), replace(LIGHT, exposure=1.2)])
@pytest.mark.parametrize(("kind", "least"), [("brown", 25), ("pale", 24), ("dim", 18)])
def test_faint_dirt_on_wood_is_found_and_no_grain(
    found: Adjusted, light: Light, kind: str, least: int
) -> None:
    particles, false = compared(see(wood(20, light, kind), found), PLACES)
    assert particles >= least
    assert false == 0


def test_without_the_picture_the_grain_hides_it(found: Adjusted) -> None:
    assert compared(see(wood(20, kind="dim"), found, with_picture=False), PLACES)[0] < 10
    assert compared(see(wood(20, kind="dim"), found), PLACES)[0] >= 22


def test_a_camera_that_moved_drops_it_with_a_doubt(found: Adjusted) -> None:
    """Then the other thresholds hold, and no grain is dirt."""
    seen = see(wood(20, moved=4), found)
    assert any("no longer fits, and is not used: did camera or light move?" in doubt for doubt in seen.doubts)
    assert seen.areas == ()
    assert not any("no longer fits" in doubt for doubt in see(wood(20), found).doubts)


def test_a_picture_of_another_size_is_dropped_with_a_doubt(found: Adjusted) -> None:
    whole = wood(20)
    camera = replace(whole.camera, height=470)
    frame = Frame(whole.colour[:470].copy(), whole.depth[:470].copy(), camera, 0.0)
    said = "the picture of the clean surface is not of 640 x 470 pixels, and is not used"
    assert said in see(frame, found).doubts


def test_it_is_written_and_read_with_the_calibration(found: Adjusted, tmp_path: Path) -> None:
    path = tmp_path / "wood.json"
    path.write_text(as_text(found.calibration), encoding="utf-8")
    assert read_calibration(path, "wood.json") == found.calibration
    described = json.loads(path.read_text(encoding="utf-8"))
    described["reference"]["picture"] = described["reference"]["picture"][:400]
    path.write_text(json.dumps(described), encoding="utf-8")
    with pytest.raises(BadCalibration, match="the `picture` of its `reference` is no PNG picture"):
        read_calibration(path, "wood.json")


def test_one_frame_is_not_enough() -> None:
    with pytest.raises(BadFrame, match="needs two frames or more"):
        calibrate([wood(1)], synthetic.scene(), "x", np.random.default_rng(0), keeps_picture=True)
