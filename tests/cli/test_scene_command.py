"""`cleancli scene`, as a user runs it."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import pytest

from cleancli.cli.main import run

SMALL = """scene small {
  camera { image = 320 x 240  focal = 262 }
  dirt {
    group { count = 6  of = peas  at = (30 cm, 0 cm)  radius = 2 cm }
    scattered { count = 3  from = (-20 cm, -20 cm)  to = (-15 cm, -15 cm) }
  }
}
"""


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "small.nid"
    path.write_text(SMALL, encoding="utf-8")
    return str(path)


def test_a_scene_is_told_drawn_and_recorded(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, reach, frames = tmp_path / "out.png", tmp_path / "reach.png", tmp_path / "frames"
    assert run(["scene", scene, "--out", str(out), "--reach", str(reach), "--save-frames", str(frames)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("small: a surface of 90 x 70 cm, friction 0.45; a container 32 cm wide")
    assert said[1] == "robot: gantry, reaches 100% of the surface; rag: 12 cm wide, grasp wide"
    assert said[2] == "dirt: 6 peas, 3 lentils"
    assert said[3].startswith("seen: ")
    assert len(said) == 4 + int(said[3].split()[1])
    for path in (out, reach):
        assert cv2.imread(str(path)) is not None
    assert run(["scene", scene, "--frames", str(frames), "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert [dirt["of"] for dirt in again["dirt"]] == ["peas", "lentils"]
    assert len(again["seen"]) == len(said) - 4
    east = max(again["seen"], key=lambda area: area["at"][0])
    assert east["at"] == pytest.approx([0.3, 0.0], abs=0.02)


def test_frames_that_are_not_there_are_named(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["scene", scene, "--frames", str(tmp_path / "none")]) == 5
    assert "camera.json" in capsys.readouterr().err


def test_without_a_display_the_window_is_refused(
    scene: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    assert run(["scene", scene, "--gui"]) == 4
    assert "--gui needs a display" in capsys.readouterr().err
