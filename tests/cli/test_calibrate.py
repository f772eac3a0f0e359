"""`cleancli calibrate`: the file it writes is the one that scenes refer to."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.files.untrusted import png_size
from cleancli.geometry.rgbd import Frame
from cleancli.perception.recorded import save_frames
from support import real_camera

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


def frames_of(folder: Path, *frames: Frame) -> Path:
    save_frames(frames, folder)
    return folder


TABLE = """scene table {
  surface { width = 90 cm  depth = 70 cm }
  dirt { group { count = 4  at = (0 cm, 0 cm)  radius = 2 cm } }
}
"""


@pytest.fixture
def table(tmp_path: Path) -> Path:
    (tmp_path / "table.nid").write_text(TABLE)
    return tmp_path / "table.nid"


def test_it_is_said_what_to_expect_and_a_picture_shows_the_margins(
    table: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    frames = frames_of(tmp_path / "clean", *(real_camera.taken(seed) for seed in range(3)))
    picture, out = tmp_path / "margins.png", tmp_path / "table.json"
    words = ["calibrate", str(table), "--frames", str(frames), "--out", str(out), "--drawn", str(picture)]
    assert run(words) == 0
    told = capsys.readouterr().out
    assert "(each judged by the 2 others): 0 false patches in 3 frames, at least 99" in told
    assert "what the worst needs" in told
    assert png_size(picture.read_bytes()) == (640, 510)
    assert run([*words, "--reference"]) == 0
    assert "its texture taken away" in capsys.readouterr().out
    assert "picture" in json.loads(out.read_text())["reference"]


def test_what_is_not_clean_is_shown(table: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frame = real_camera.taken(1)
    frame.depth[202:210, 304:312] -= np.float32(0.05)
    frames, picture = frames_of(tmp_path / "odd", frame), tmp_path / "odd.png"
    words = ["calibrate", str(table), "--frames", str(frames), "--out", str(tmp_path / "table.json")]
    assert run(words) == ExitCode.FILES
    assert "above it, most around column 308, row 205; --drawn PICTURE shows where" in capsys.readouterr().err
    assert run([*words, "--drawn", str(picture)]) == ExitCode.FILES
    assert f"{picture} shows where" in capsys.readouterr().err
    shown = cv2.imread(str(picture))
    assert shown is not None
    assert tuple(shown[206, 308]) == (40, 30, 230), "red, as OpenCV orders it"
    assert not (tmp_path / "table.json").exists()


def test_doubts_are_warnings_and_stand_in_json_and_below_pictures(
    table: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    frame = real_camera.taken(1)
    frames = frames_of(tmp_path / "black", replace(frame, colour=np.zeros_like(frame.colour)))
    sheet, drawn = tmp_path / "sheet.png", tmp_path / "drawn.png"
    words = ["--scene", str(table), "--json", "--out", str(sheet), "--drawn", str(drawn)]
    assert run(["perceive", str(frames), *words]) == 0
    told = capsys.readouterr()
    (look,) = json.loads(told.out)["looks"]
    assert "black all over" in look["doubts"][0]
    assert f"warning: {look['doubts'][0]}" in " ".join(told.err.split())
    assert [png_size(path.read_bytes()) for path in (sheet, drawn)] == [(1920, 1020 + 21), (640, 480 + 34)]
