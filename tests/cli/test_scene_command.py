"""`cleancli scene`, as a user runs it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cleancli.cli.main import run
from support.pictures import picture

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


def test_a_scene_is_told_and_drawn(scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, reach = tmp_path / "out.png", tmp_path / "reach.png"
    assert run(["scene", scene, "--out", str(out), "--reach", str(reach)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("small: a surface of 90 x 70 cm, friction 0.45; a container 32 cm wide")
    assert said[1:] == [
        "robot: gantry, reaches 100% of the surface; rag: 12 cm wide, grasp wide",
        "dirt: 6 peas, 3 lentils",
    ]
    assert picture(out).shape == (240, 640, 3)
    assert picture(reach).size
    assert run(["scene", scene, "--json"]) == 0
    assert [dirt["of"] for dirt in json.loads(capsys.readouterr().out)["dirt"]] == ["peas", "lentils"]


def test_what_lies_out_of_reach_is_counted(scene: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["scene", scene, "--robot", "reem"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[1].startswith("robot: reem, reaches 3"), "a fifth to two fifths of a table so large"
    assert said[3] == "out of reach: 3 of 9 pieces of dirt"


def test_without_a_display_the_window_is_refused(
    scene: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    assert run(["scene", scene, "--gui"]) == 4
    assert "--gui needs a display" in capsys.readouterr().err
