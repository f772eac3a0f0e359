"""`cleancli calibrate`: the file it writes is the one that scenes refer to."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run

SCENE = """scene wood {
  surface { colour = rgb(150, 110, 70)  texture = 0.02  grain = 2 cm }
  camera { at = (0 cm, -45 cm)  calibration = "wood.json" }
  light { gradient = 0.2 }
  dirt { group { count = 8  at = (-10 cm, 5 cm)  radius = 3 cm  colour = rgb(30, 40, 90) } }
}
"""


def test_a_scene_refers_to_its_calibration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wood.nid").write_text(SCENE)
    assert run(["check", "wood.nid"]) == ExitCode.REFUSED
    capsys.readouterr()
    assert run(["calibrate", "wood.nid", "--out", "wood.json", "--count", "2"]) == 0
    assert "gradient" in capsys.readouterr().out
    assert run(["check", "wood.nid"]) == 0
    capsys.readouterr()
    assert run(["perceive", "wood.nid", "--json"]) == 0
    (look,) = json.loads(capsys.readouterr().out)["looks"]
    assert len(look["areas"]) == 1
    assert look["doubts"] == []


def test_the_frames_have_the_noise_of_the_scene_unless_another_seed_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "wood.nid"
    scene.write_text(
        SCENE.replace("camera {", "seed = 7  camera {").replace('  calibration = "wood.json"', "")
    )

    def found(*words: str) -> object:
        out = tmp_path / f"{len(list(tmp_path.iterdir()))}.json"
        assert run(["calibrate", str(scene), "--out", str(out), "--count", "1", "--json", *words]) == 0
        return json.loads(out.read_text())

    own = found()
    capsys.readouterr()
    assert found("--seed", "7") == own
    assert found("--seed", "8") != own


def test_other_files_are_not_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "wood.nid"
    scene.write_text(SCENE)
    assert run(["calibrate", str(scene), "--out", str(scene)]) == ExitCode.USAGE
    assert "is no calibration" in capsys.readouterr().err
    assert scene.read_text() == SCENE
    assert run(["calibrate", str(scene), "--out", str(tmp_path / "no" / "x.json")]) == ExitCode.USAGE


def test_other_mistakes_of_the_scene_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "wood.nid"
    scene.write_text(SCENE.replace("0.02", "2"))
    assert run(["calibrate", str(scene), "--out", str(tmp_path / "x.json")]) == ExitCode.REFUSED
    said = capsys.readouterr().err
    assert "E505" in said
    assert "E516" not in said


def test_perceive_warns_where_the_calibration_fits_no_longer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wood.nid").write_text(SCENE)
    assert run(["calibrate", "wood.nid", "--out", "wood.json", "--count", "2"]) == 0
    assert run(["perceive", "wood.nid"]) == 0
    assert "warning" not in capsys.readouterr().err
    (tmp_path / "wood.nid").write_text(SCENE.replace("rgb(150, 110, 70)", "rgb(205, 198, 184)"))
    assert run(["perceive", "wood.nid"]) == 0
    assert "brighter than when calibrated" in capsys.readouterr().err
