"""What is no plain file, too large or nested too deeply is refused by every command, with a sentence."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from cleancli.cli.main import run

ROOT = Path(__file__).parents[2]
PICTURES = ("colour-000.png", "depth-000.png")
CAMERA = {"width": 64, "height": 48, "focal": 50.0, "centre": [32, 24], "pose": None, "clocks": [0.0]}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a pipe, and what commands need besides; who waits for the pipe is woken."""
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe")
    os.mkfifo("pipe.nid")
    shutil.copy(ROOT / "domains" / "cleaning.nid", "cleaning.nid")
    Path("includes.nid").write_text('domain cleaning { include "pipe" }')
    scene = (ROOT / "problems" / "two_groups.nid").read_text()
    Path("calibrated.nid").write_text(re.sub(r"camera\s*\{", 'camera { calibration = "pipe"', scene))
    Path("kitchen").mkdir()
    for name in ("rules.dat", "state.dat", "symbols.dat"):
        shutil.copy(ROOT / "tests" / "conversion" / "kitchen" / name, f"kitchen/{name}")
    os.mkfifo("kitchen/pipe")
    for name in ("frames", "looks"):
        Path(name).mkdir()
    os.mkfifo("frames/camera.json")
    Path("looks/camera.json").write_text(json.dumps(CAMERA))
    for name in PICTURES:
        os.mkfifo(f"looks/{name}")

    def woken(number: int, frame: object) -> None:
        raise TimeoutError("it waits for the pipe")

    before = signal.signal(signal.SIGALRM, woken)
    signal.alarm(60)
    yield tmp_path
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("check pipe", 1),
        ("check includes.nid", 1),
        ("check calibrated.nid", 1),
        ("fmt pipe", 1),
        ("show pipe", 1),
        ("show cleaning.nid pipe", 1),
        ("compile cleaning.nid pipe", 1),
        ("explain pipe three_areas wait()", 1),
        ("rename dirt dust --domain cleaning.nid pipe", 1),
        ("plan pipe three_areas", 1),
        ("plan cleaning.nid pipe", 1),
        ("simulate cleaning.nid pipe", 1),
        ("execute cleaning.nid pipe", 1),
        ("scene pipe", 1),
        ("act pipe push", 1),
        ("perceive pipe", 1),
        ("perceive frames", 5),
        ("perceive looks", 5),
        ("calibrate pipe --out new.json", 1),
        ("calibrate two_groups --frames frames --out new.json", 5),
        ("learn cleaning.nid pipe", 1),
        ("convert kitchen/rules.dat kitchen/state.dat kitchen/pipe --out made", 1),
    ],
)
def test_a_pipe_is_refused_and_nobody_waits_for_it(
    line: str, code: int, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(line.split()) == code
    told = capsys.readouterr()
    assert "it is a named pipe" in told.out + told.err
    assert "Errno" not in told.out + told.err


def test_a_folder_with_a_pipe_in_it_is_checked_without_it(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Only plain files of a folder are taken."""
    Path("part").mkdir()
    shutil.copy("cleaning.nid", "part/cleaning.nid")
    os.mkfifo("part/pipe.nid")
    assert run(["check", "part"]) == 0
    assert "in 1 file" in capsys.readouterr().out


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 100_000, "[" * 100_000 + "]" * 100_000])
def test_what_is_nested_too_deeply_is_a_sentence(
    text: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("pipe", "frames/camera.json"):
        Path(name).unlink()
        Path(name).write_text(text + "\n")
    for line, code in (("check calibrated.nid", 1), ("perceive frames", 5), ("learn cleaning.nid pipe", 1)):
        assert run(line.split()) == code
        told = capsys.readouterr()
        said = told.out + told.err
        assert "nested too deeply" in said or "xpected `object`, got `array`" in said


def test_what_is_too_large_is_told_before_it_is_read(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("pipe", "frames/camera.json"):
        Path(name).unlink()
        with Path(name).open("wb") as file:
            file.truncate(1 << 40)
    convert = "convert kitchen/rules.dat kitchen/state.dat pipe --out made"
    for line in ("check pipe", "check calibrated.nid", "perceive frames", convert):
        assert run(line.split()) in (1, 5)
        told = capsys.readouterr()
        assert "larger than" in told.out + told.err, line
