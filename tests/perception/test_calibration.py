"""Calibration: the smallest thresholds that see a clean surface as clean, and whether they still fit."""

from __future__ import annotations

import json
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from cleancli.geometry.rgbd import Frame
from cleancli.perception.calibrate import MARGIN, NotClean, calibrate
from cleancli.perception.perceive import Observation, perceive
from cleancli.perception.surface import NoBackground
from cleancli.scene.calibration import BadCalibration, Calibration, Thresholds, as_text, read_calibration
from support import real_camera, synthetic

NONE = np.zeros((0, 2))
LENTILS = np.array([(x, y) for x in (-0.3, -0.1, 0.05, 0.2) for y in (-0.2, 0.1)])
WOOD = (120, 100, 80)


@pytest.fixture(scope="module")
def found() -> Calibration:
    clean = [synthetic.frame(NONE, seed, light=0.3, colour=WOOD) for seed in range(4)]
    return calibrate(clean, synthetic.scene(), "wood.json", np.random.default_rng(0)).calibration


def see(frame: Frame, calibration: Calibration) -> Observation:
    scene = replace(synthetic.scene(), calibration=calibration)
    return perceive([frame], scene, np.random.default_rng(1))


def test_what_is_clean_is_seen_so_and_dirt_is_still_found(found: Calibration) -> None:
    for seed in range(20, 26):
        assert see(synthetic.frame(NONE, seed, light=0.3, colour=WOOD), found).areas == ()
    assert len(see(synthetic.frame(LENTILS, 30, light=0.3, colour=WOOD), found).areas) == len(LENTILS)


def test_the_gradient_leaves_a_hundredth_of_the_most_uneven_frame(found: Calibration) -> None:
    """At what is stored without its margin, that is; what the contrast would hide does not count."""
    bare = replace(found.thresholds, gradient=found.thresholds.gradient / MARGIN["gradient"])
    shares = []
    for seed in range(4):
        seen = see(synthetic.frame(NONE, seed, light=0.3, colour=WOOD), replace(found, thresholds=bare))
        trusted = cv2.erode(seen.steps.without_edges.view(np.uint8), np.ones((13, 13), np.uint8)) > 0
        shares.append(1 - seen.steps.dirty[trusted].mean())
    assert min(shares) == pytest.approx(0.99, abs=0.003)


def test_noise_counts_by_the_brightness_of_the_surface(found: Calibration) -> None:
    assert found.thresholds.darkest == pytest.approx(np.mean(WOOD), rel=0.03)


def test_a_surface_that_nothing_makes_clean_is_refused_and_it_is_told_where() -> None:
    frame = synthetic.frame(NONE, 1)
    colour = frame.colour.copy()
    colour[200:212, 300:312] = 0
    with pytest.raises(NotClean, match=r"dirt is seen around column 306, row 206 even with a") as refused:
        calibrate([replace(frame, colour=colour)], synthetic.scene(), "x", np.random.default_rng(0))
    assert refused.value.where[206, 306]


@pytest.mark.parametrize(("height", "way"), [(0.05, "above"), (-0.05, "below")])
def test_what_is_off_the_plane_is_counted_and_placed(height: float, way: str) -> None:
    """Too small for an object, too large for noise."""
    frame = synthetic.frame(NONE, 1)
    depth = frame.depth.copy()
    depth[202:210, 304:312] -= np.float32(height)
    said = rf"of 0.04: in frame 1 64 pixels \(0.03%\) lie {way} it, most around column 308, row 206"
    with pytest.raises(NotClean, match=said) as refused:
        calibrate([replace(frame, depth=depth)], synthetic.scene(), "x", np.random.default_rng(0))
    assert refused.value.where.sum() == 64


def test_a_pattern_is_refused_and_never_one_large_area() -> None:
    rng = np.random.default_rng(0)
    frame = synthetic.frame(NONE, 1)
    stripes = rng.integers(20, 255, (*frame.depth.shape, 1), np.uint8)
    patterned = replace(frame, colour=np.repeat(stripes, 3, axis=2))
    with pytest.raises(NotClean, match=r"of the surface has no even colour"):
        calibrate([patterned], synthetic.scene(), "x", np.random.default_rng(0))
    with pytest.raises(NoBackground, match=r"only \d+% of the surface is of an even colour"):
        perceive([patterned], synthetic.scene(), np.random.default_rng(0))


def test_an_object_on_the_clean_surface_teaches_its_rim() -> None:
    """Its soft shadow, ten pixels wide, is learned, and so is none where none falls."""
    box = synthetic.Box((-0.1, -0.1), (0.0, 0.05), 0.06, (60, 60, 60))
    shaded = [real_camera.taken(seed, boxes=(box,)) for seed in range(2)]
    bare = [real_camera.taken(seed) for seed in range(2)]
    with_box, without = (
        calibrate(frames, synthetic.scene(), "x", np.random.default_rng(0)) for frames in (shaded, bare)
    )
    assert without.objects == 0
    assert with_box.objects == pytest.approx(0.1 * 0.15 / (0.9 * 0.7), rel=0.25)
    assert without.calibration.thresholds.object_edge == Thresholds().object_edge
    scene = replace(synthetic.scene(), calibration=with_box.calibration)
    for seed in range(10, 13):
        assert perceive([real_camera.taken(seed, boxes=(box,))], scene, np.random.default_rng(0)).areas == ()


def test_each_frame_is_judged_by_the_others() -> None:
    """A frame with three times the noise is what the others do not expect; alone, a frame expects nothing."""
    quiet = [synthetic.frame(NONE, seed, light=0.3, colour=WOOD) for seed in range(3)]
    colour = quiet[2].colour.astype(float) + np.random.default_rng(1).normal(0, 9, quiet[2].colour.shape)
    loud = replace(quiet[2], colour=np.clip(np.round(colour), 0, 255).astype(np.uint8))
    scene, rng = synthetic.scene(), np.random.default_rng(0)
    assert calibrate(quiet[:1], scene, "x", rng).left_out == ()
    expected = calibrate(quiet, scene, "x", rng).left_out
    assert all(each.false == 0 and each.background > 0.99 for each in expected)
    assert all(each.gradient > 1.2 for each in expected)
    surprised = calibrate([*quiet[:2], loud], scene, "x", rng).left_out
    assert surprised[2].gradient < 0.6
    assert surprised[2].background < 0.9
    assert surprised[0].gradient > 2


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
