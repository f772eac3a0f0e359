"""`perceive` and `calibrate` on bags and folders of the TUM layout, as a user runs them."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="an extra")

import cleancli
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.geometry.rgbd import Frame
from cleancli.perception.recorded import load_frames
from support.bags import DEPTH, Ros, told_messages, write_bag
from support.synthetic import frame, grouped

SCENE = """scene bare {
  surface { width = 90 cm  depth = 70 cm }
  camera { height = 90 cm }
  dirt { group { count = 3  at = (0 cm, 0 cm)  radius = 1 cm } }
}
"""


@pytest.fixture(scope="module")
def frames() -> tuple[Frame, ...]:
    """Two looks, a second apart."""
    lentils = grouped(np.random.default_rng(1), 9, (0.1, 0.1), 0.03)
    return tuple(replace(frame(lentils, seed), clock=5 + seed * 0.6) for seed in range(3))


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "bare.nid"
    path.write_text(SCENE, encoding="utf-8")
    return str(path)


@pytest.fixture
def bag(frames: tuple[Frame, ...], tmp_path: Path) -> str:
    ros = Ros(False)
    return str(write_bag(tmp_path / "table.mcap", told_messages(ros, frames), ros))


def _seen(words: list[str], capsys: pytest.CaptureFixture[str]) -> Any:
    assert run(["perceive", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_bag_is_told_as_looks_and_written_as_a_tum_folder(
    bag: str, scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(tmp_path / "tum")
    words = [bag, "--scene", scene, "--frame", "table", "--save-frames", folder, "--layout", "tum"]
    seen = _seen(words, capsys)
    assert [look["clock"] for look in seen["looks"]] == [5.6, 6.2]
    assert [[area["area"] for area in look["areas"]] for look in seen["looks"]] == [["a1"], ["a1"]]
    assert seen["looks"][0]["source"] == bag
    assert seen["notes"] == []
    (again,) = _seen([folder, "--scene", scene], capsys)["looks"]
    assert again["clock"] == 6.2
    assert again["areas"][0]["at"] == pytest.approx(seen["looks"][1]["areas"][0]["at"], abs=1.001e-4)
    result = cleancli.perceive(bag, scene=scene, frame="table", every=10)
    assert len(result.looks) == 1
    assert result.to_dict()["notes"] == []


def test_simulated_frames_show_the_same_areas_from_a_bag(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """To a tenth of a millimetre, from a bag of each kind."""
    folder = tmp_path / "frames"
    assert run(["perceive", scene, "--save-frames", str(folder)]) == 0
    capsys.readouterr()
    (before,) = _seen([str(folder), "--scene", scene], capsys)["looks"]
    assert before["areas"]
    for kind in (".bag", ".mcap", ".db3"):
        ros = Ros(kind == ".bag")
        bag = write_bag(tmp_path / f"{kind[1:]}{kind}", told_messages(ros, load_frames(folder)), ros)
        (after,) = _seen([str(bag), "--scene", scene, "--frame", "table", "--every", "10"], capsys)["looks"]
        assert len(after["areas"]) == len(before["areas"])
        for one, other in zip(before["areas"], after["areas"], strict=True):
            for value in ("at", "diameters"):
                assert other[value] == pytest.approx(one[value], abs=1.001e-4)
        assert after["facts"] == before["facts"]


def test_what_is_left_out_is_a_warning_and_a_note(
    frames: tuple[Frame, ...], scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ros = Ros(True)
    messages = [each for each in told_messages(ros, frames) if (each[0], each[2]) != (DEPTH, 5.6)]
    bag = str(write_bag(tmp_path / "table.bag", messages, ros))
    assert run(["perceive", bag, "--scene", scene, "--json"]) == 0
    told = capsys.readouterr()
    note = f"{bag}: 1 of 3 colour pictures have no depth within 0.02 s"
    assert f"warning: {note}" in told.err
    assert json.loads(told.out)["notes"] == [note]


def test_a_calibration_takes_so_many_frames_of_a_recording(
    frames: tuple[Frame, ...], scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    clean = [replace(frame(np.zeros((0, 2)), seed), clock=5 + seed * 0.6) for seed in range(3)]
    ros = Ros(False)
    bag = str(write_bag(tmp_path / "clean.db3", told_messages(ros, clean), ros))
    out = str(tmp_path / "table.json")
    words = ["calibrate", scene, "--out", out, "--frames", bag, "--frame", "table", "--count", "2"]
    assert run(words) == 0
    assert "clean in 2 frames" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["perceive", "calibrate"])
def test_without_rosbags_the_part_that_is_missing_is_named(
    command: str,
    bag: str,
    scene: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, "rosbags", None)
    words = {"perceive": [bag], "calibrate": [scene, "--out", str(tmp_path / "x.json"), "--frames", bag]}
    assert run([command, *words[command]]) == ExitCode.MISSING_PART
    assert "pip install 'rosbags>=0.11.9,<0.12'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["{bag}", "--frame", "tabel"], "no way from `camera_color_optical_frame` to `tabel`"),
        (["{bag}", "--colour-topic", "/camera/colour"], "no pictures in a topic `/camera/colour`"),
        (["{bag}", "--color-topic", "/a"], "no pictures in a topic `/a`"),
        (["missing.mcap"], "missing.mcap: No such file"),
        (["{folder}"], "no recording: neither camera.json nor a folder with one, no rgb.txt"),
    ],
)
def test_what_cannot_be_read_ends_in_words(
    words: list[str], said: str, bag: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "empty"
    folder.mkdir()
    given = [word.format(bag=bag, folder=folder) for word in words]
    assert run(["perceive", *given]) == ExitCode.FILES
    told = capsys.readouterr()
    assert said in told.err
    assert told.out == ""
