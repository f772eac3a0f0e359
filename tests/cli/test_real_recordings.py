"""What `execute` keeps of a real cell is read by perception, its benchmark and the learner (docs/cell.md)."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from cleancli.cli.main import run
from cleancli.resources import shipped
from support.remote_scripted import WIDE, ScriptedDriver
from support.shipped import shipped_scene
from support.toy_driver import served

ROOT = Path(__file__).parents[2]


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[str]:
    """The file of a scene whose robot, at the end of a socket, cleans an area by each stroke."""
    dirt = ((-0.2, 0.1), (0.1, -0.15))
    driver = ScriptedDriver(shipped_scene("two_groups"), lambda strokes: dirt[strokes:])
    with served(driver, WIDE) as server:
        file = tmp_path / "lab.nid"
        file.write_text(f'scene lab {{ robot {{ drive = remote  address = "{server.address}" }} }}')
        yield str(file)


def test_a_run_is_seen_again_measured_and_learned_from(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runs, looks, domain = tmp_path / "runs", tmp_path / "looks", tmp_path / "mine.nid"
    words = ["execute", "cleaning", scene, "--strategy", "reactive", "--runs", str(runs)]
    assert run([*words, "--save-frames", str(looks), "--quiet"]) == 0
    (folder,) = runs.iterdir()
    records = [json.loads(line) for line in (folder / "journal.jsonl").read_text().splitlines()]
    looked = [len(each["areas"]) for each in records if each["event"] == "looked"]
    assert len(looked) == len(list(looks.iterdir())) >= 3

    assert run(["perceive", str(looks), "--scene", scene, "--json"]) == 0
    seen = json.loads(capsys.readouterr().out)
    assert [len(each["areas"]) for each in seen["looks"]] == looked == [2, *looked[1:-1], 0]

    last = max(looks.iterdir())
    command = [sys.executable, "benchmarks/real_frames.py", str(last), "--scene", scene]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert "1 frames, of which 1 show the surface" in told

    domain.write_bytes((shipped("domains") / "cleaning.nid").read_bytes())
    assert run(["learn", str(domain), str(folder)]) == 0
    assert "2 transitions, 2 examples" in capsys.readouterr().out
    assert run(["learn", "--structure", str(domain), str(runs), "--output", str(tmp_path / "new.nid")]) == 0
    assert run(["check", str(tmp_path / "new.nid")]) == 0


def test_the_looks_of_the_next_run_come_after_those_of_the_last(scene: str, tmp_path: Path) -> None:
    looks = tmp_path / "looks"
    words = ["execute", "cleaning", scene, "--strategy", "reactive", "--runs", str(tmp_path / "runs")]
    words += ["--save-frames", str(looks), "--quiet", "--max-actions", "1"]
    assert run(words) == 3
    first = {path: (path / "colour-000.png").read_bytes() for path in looks.iterdir()}
    assert sorted(path.name for path in first)[:2] == ["look-001", "look-002"]
    assert run([*words[:-1], "0"]) == 3
    assert len(list(looks.iterdir())) > len(first)
    assert all((path / "colour-000.png").read_bytes() == before for path, before in first.items())
