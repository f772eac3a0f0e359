"""Calibration: the smallest thresholds that see a clean surface as clean, and whether they still fit."""

from __future__ import annotations

import json
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cleancli.geometry.rgbd import Frame
from cleancli.perception.calibrate import MARGIN, NotClean, calibrate
from cleancli.perception.perceive import Observation, perceive
from cleancli.scene.calibration import BadCalibration, Calibration, Thresholds, as_text, read_calibration
from support import synthetic

NONE = np.zeros((0, 2))
LENTILS = np.array([(x, y) for x in (-0.3, -0.1, 0.05, 0.2) for y in (-0.2, 0.1)])
WOOD = (120, 100, 80)


@pytest.fixture(scope="module")
def found() -> Calibration:
    clean = [synthetic.frame(NONE, seed, light=0.3, colour=WOOD) for seed in range(4)]
    return calibrate(clean, synthetic.scene(), "wood.json", np.random.default_rng(0))


def see(frame: Frame, calibration: Calibration) -> Observation:
    scene = replace(synthetic.scene(), calibration=calibration)
    return perceive([frame], scene, np.random.default_rng(1))


def test_what_is_clean_is_seen_so_and_dirt_is_still_found(found: Calibration) -> None:
    for seed in range(20, 26):
        assert see(synthetic.frame(NONE, seed, light=0.3, colour=WOOD), found).areas == ()
    assert len(see(synthetic.frame(LENTILS, 30, light=0.3, colour=WOOD), found).areas) == len(LENTILS)


def test_the_gradient_is_the_smallest_that_suffices(found: Calibration) -> None:
    low = replace(found.thresholds, gradient=found.thresholds.gradient / MARGIN * 0.9)
    frames = [synthetic.frame(NONE, seed, light=0.3, colour=WOOD) for seed in range(4)]
    assert any(see(frame, replace(found, thresholds=low)).areas for frame in frames)


def test_a_surface_that_nothing_makes_clean_is_refused() -> None:
    frame = synthetic.frame(NONE, 1)
    colour = frame.colour.copy()
    colour[200:212, 300:312] = 0
    with pytest.raises(NotClean, match="whatever the thresholds"):
        calibrate([replace(frame, colour=colour)], synthetic.scene(), "x", np.random.default_rng(0))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"colour": WOOD, "light": 0.3}, None),
        ({"colour": (84, 70, 56), "light": 0.3}, "darker"),
        ({"colour": (160, 133, 107), "light": 0.3}, "brighter"),
        ({"colour": WOOD, "light": -0.4}, "light falls differently"),
        ({"colour": (80, 100, 120), "light": 0.3}, "another colour"),
    ],
)
def test_it_is_said_when_surface_or_light_fit_no_longer(
    found: Calibration, changes: dict[str, Any], said: str | None
) -> None:
    doubts = see(synthetic.frame(LENTILS, 3, **changes), found).doubts
    assert doubts == () if said is None else any(said in doubt for doubt in doubts), doubts


def test_it_is_said_when_the_surface_slants_otherwise(found: Calibration) -> None:
    doubts = see(synthetic.frame(NONE, 3, tilt=(0.3, 0), light=0.3, colour=WOOD), found).doubts
    assert any("17 degrees" in doubt for doubt in doubts), doubts


def test_without_a_calibration_the_defaults_are_used() -> None:
    observation = perceive([synthetic.frame(LENTILS, 1)], synthetic.scene(), np.random.default_rng(0))
    assert len(observation.areas) == len(LENTILS)
    assert observation.doubts == ()


def test_what_was_written_is_read(found: Calibration, tmp_path: Path) -> None:
    (tmp_path / "wood.json").write_text(as_text(found), encoding="utf-8")
    assert read_calibration(tmp_path / "wood.json", "wood.json") == found


@pytest.mark.parametrize(
    ("part", "key", "value"),
    [
        ("thresholds", "gradient", -1),
        ("thresholds", "contrast", "much"),
        ("thresholds", "surface_edge", 2.5),
        ("thresholds", "patch", None),
        ("appearance", "rows", 0),
        ("appearance", "tilt", True),
        ("appearance", "colours", [[1, 2, 3]]),
        ("appearance", "colours", [[1, 2]] * 24),
    ],
)
def test_a_wrong_value_is_refused_by_its_name(
    found: Calibration, tmp_path: Path, part: str, key: str, value: object
) -> None:
    described = json.loads(as_text(found))
    described[part][key] = value
    (tmp_path / "wrong.json").write_text(json.dumps(described), encoding="utf-8")
    with pytest.raises(BadCalibration, match=key):
        read_calibration(tmp_path / "wrong.json", "wrong.json")


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", "\xff", '{"format": "cleancli calibration 2"}', "[" * 100_000]
)
def test_what_is_no_calibration_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "wrong.json").write_text(text, encoding="latin-1")
    with pytest.raises(BadCalibration):
        read_calibration(tmp_path / "wrong.json", "wrong.json")


def test_every_threshold_is_in_the_file(found: Calibration) -> None:
    assert set(asdict(found.thresholds)) == {field.name for field in fields(Thresholds)}


@pytest.mark.parametrize("text", [b'{"format": "\xff"}', b"\xff", b'{"made by": "\xff"}'])
def test_bytes_that_are_no_text_are_no_calibration(tmp_path: Path, text: bytes) -> None:
    (tmp_path / "wrong.json").write_bytes(text)
    with pytest.raises(BadCalibration, match="no JSON"):
        read_calibration(tmp_path / "wrong.json", "wrong.json")
