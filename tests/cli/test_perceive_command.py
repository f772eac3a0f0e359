"""`cleancli perceive`, as a user runs it, on a scene and on recorded frames."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from cleancli.cli.main import run
from support.pictures import picture

SMALL = """scene small {
  camera { image = 320 x 240  focal = 262 }
  dirt {
    group { count = 6  of = peas  at = (30 cm, 0 cm)  radius = 2 cm }
    group { count = 3  of = peas  at = (-20 cm, -20 cm)  radius = 1 cm }
  }
  symbols { most = 1 }
}
"""


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "small.nid"
    path.write_text(SMALL, encoding="utf-8")
    return str(path)


@pytest.fixture
def frames(scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    folder = tmp_path / "frames"
    assert run(["perceive", scene, "--save-frames", str(folder)]) == 0
    capsys.readouterr()
    return folder


def test_a_scene_is_seen_told_and_drawn(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sheet, drawn = tmp_path / "sheet.png", tmp_path / "drawn.png"
    assert run(["perceive", scene, "--out", str(sheet), "--drawn", str(drawn)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "small: 2 areas"
    assert said[2].startswith("  a2: at (")
    assert "  left out of plans: a1" in said
    assert picture(drawn).shape == (240, 320, 3)
    assert picture(sheet).shape == (2 * 270, 3 * 320, 3)


def test_recorded_frames_need_no_simulator(
    frames: Path, scene: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)
    assert run(["perceive", str(frames), "--scene", scene, "--json"]) == 0
    (look,) = json.loads(capsys.readouterr().out)["looks"]
    assert [area["area"] for area in look["areas"]] == ["a1", "a2"]
    assert look["areas"][1]["at"] == pytest.approx([0.3, 0.0], abs=0.02)
    assert look["areas"][1]["size"] == "small"
    assert look["left_out"] == ["a1"]
    assert look["unseen"]["share"] < 0.01


def test_names_go_from_look_to_look(
    frames: Path, scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In the second look the western area is gone, and something hides the eastern one."""
    series = tmp_path / "series"
    shutil.copytree(frames, series / "look-9")
    shutil.copytree(frames, series / "look-10")
    for number in range(3):
        for kind in ("colour", "depth"):
            path = series / "look-10" / f"{kind}-{number:03}.png"
            pixels = picture(path)
            pixels[165:190, 90:115] = np.median(pixels[165:190, 130:155], axis=(0, 1))
            pixels[80:160, 220:280] = 700 if kind == "depth" else 30
            cv2.imwrite(str(path), pixels)
    assert run(["perceive", str(series), "--scene", scene, "--json"]) == 0
    first, second = json.loads(capsys.readouterr().out)["looks"]
    assert [area["area"] for area in first["areas"]] == ["a1", "a2"]
    assert [(area["area"], area["hidden"]) for area in second["areas"]] == [("a2", 1.0)]
    assert 0.02 < second["unseen"]["share"] < 0.2
    assert len(second["unseen"]["outlines"]) >= 1


def test_a_folder_without_frames_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["perceive", str(tmp_path)]) == 5
    assert "neither camera.json nor a folder with one" in capsys.readouterr().err


def test_without_rerun_the_part_is_named(
    frames: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    assert run(["perceive", str(frames), "--rrd", str(tmp_path / "x.rrd")]) == 4
    assert "pip install 'rerun-sdk>=0.24'" in capsys.readouterr().err
    assert not (tmp_path / "x.rrd").exists()


def test_a_rerun_recording_holds_steps_ellipses_and_names(
    frames: Path, scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Read by Rerun's own reader."""
    chunk = pytest.importorskip("rerun.chunk", reason="170 MB, and so no part of the test extra")
    path = tmp_path / "x.rrd"
    assert run(["perceive", str(frames), "--scene", scene, "--json", "--rrd", str(path)]) == 0
    (look,) = json.loads(capsys.readouterr().out)["looks"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["frames", "small.nid", "x.rrd"]
    chunks = {c.entity_path.strip("/"): c for c in chunk.RrdReader(path).stream()}
    steps = {"surface", "without_edges", "dirty", "without_specks", "believed", "hidden"}
    pictures = {f"camera/{name}" for name in (*steps, "colour", "depth", "ellipses")}
    assert set(chunks) == {"camera", "areas", "state", *pictures}
    assert all({"look", "robot"} <= set(c.timeline_names) for name, c in chunks.items() if name != "camera")
    assert (chunks["camera/colour"].num_rows, chunks["camera/depth"].num_rows) == (3, 3)
    (blob,), *_ = column(chunks["camera/colour"], "EncodedImage:blob")
    decoded = cv2.imdecode(np.array(blob, np.uint8), cv2.IMREAD_COLOR)
    assert decoded is not None
    assert decoded.shape == (240, 320, 3)
    ((believed,),) = column(chunks["camera/believed"], "SegmentationImage:buffer")
    assert 20 < np.count_nonzero(believed) < 400
    (labels,), (strips,) = (
        column(chunks["camera/ellipses"], f"LineStrips2D:{n}") for n in ("labels", "strips")
    )
    assert [label.split()[0] for label in labels] == ["a1", "a2"]
    assert look["areas"][1]["size"] in labels[1].split()
    assert np.mean(strips[1], axis=0) == pytest.approx((160 + 0.307 * 262 / 0.9, 120), abs=4)
    assert column(chunks["areas"], "Scalars:scalars") == [[2.0]]
    ((told,),) = column(chunks["state"], "TextDocument:text")
    assert "dirt(a1) = True" in told.splitlines()


def column(chunk: Any, name: str) -> list[Any]:
    """What each row of a chunk holds in one column."""
    values = chunk.to_record_batch().column(name).to_pylist()
    assert isinstance(values, list)
    return values
