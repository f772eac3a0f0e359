"""What the command experiment says, and which exit codes it ends with."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from cleancli.cli.main import run
from cleancli.experiment.rows import CSV, PARQUET, read_rows
from cleancli.experiment.store import LINES
from cleancli.study.row import comparable
from support.studies import SYMBOLIC, opened, rows_here

SMALL = SYMBOLIC.replace("runs      = 2", "runs = 1").replace("plan_1, plan_2", "plan_1")
"""Four episodes."""


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.nid").write_text(SMALL, encoding="utf-8")
    return tmp_path


def told(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    assert run(["experiment", *words, "--json"]) == 0
    answer: dict[str, Any] = json.loads(capsys.readouterr().out)
    return answer


def test_it_leaves_rows_and_the_study_and_says_what_it_came_to(
    study: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["experiment", "small.nid", "--jobs", "1"]) == 0
    printed = capsys.readouterr().out
    folder = study / "experiments" / "small"
    assert sorted(path.name for path in folder.iterdir()) == [LINES, CSV, PARQUET, "symbolic.nid"]
    assert (folder / "symbolic.nid").read_text(encoding="utf-8") == SMALL
    assert tuple(map(comparable, read_rows(folder / PARQUET))) == rows_here(opened(SMALL))
    assert "estimator     episodes  finished" in printed
    assert printed.endswith("4 rows, 4 episodes carried out: experiments/small/\n")


def test_what_is_finished_is_not_carried_out_again(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("small.nid", "--jobs", "1", "--output", "out")
    assert told(capsys, *words) == {
        "studies": {"symbolic": {"episodes": 4, "clean": 4}},
        "carried_out": 4,
        "kept": 0,
        "given_up": [],
        "rows": f"out/{PARQUET}",
    }
    before = (study / "out" / LINES).read_bytes(), (study / "out" / PARQUET).read_bytes()
    assert run(["experiment", *words]) == 2
    assert "out holds 4 finished episodes: go on with --resume" in capsys.readouterr().err
    again = told(capsys, *words, "--resume")
    assert (again["carried_out"], again["kept"]) == (0, 4)
    assert ((study / "out" / LINES).read_bytes(), (study / "out" / PARQUET).read_bytes()) == before
    more = told(capsys, *words, "--resume", "--runs", "2")
    assert (more["carried_out"], more["kept"]) == (4, 4)
    other = told(capsys, *words, "--resume", "--seed", "9")
    assert (other["carried_out"], other["studies"]["symbolic"]["episodes"]) == (4, 4)


def test_until_stops_at_the_end_of_a_run(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (
        "study s { scene = three_areas strategy = plan_1, plan_2 samples = 50 measure = actions runs = 20 }"
    )
    (study / "s.nid").write_text(text, encoding="utf-8")
    answer = told(capsys, "s.nid", "--jobs", "1", "--until", "40%")
    assert answer["studies"]["s"]["episodes"] == answer["carried_out"] == 20
    all_runs = told(capsys, "s.nid", "--jobs", "1", "--until", "0.1%", "--resume", "--runs", "12")
    assert (all_runs["studies"]["s"]["episodes"], all_runs["kept"]) == (24, 20)


@pytest.mark.parametrize("share", ["10", "0%", "100%", "-3%", "ten", "1e1%", "10%%"])
def test_a_share_is_a_number_and_a_sign(study: Path, share: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["experiment", "small.nid", "--until", share]) == 2
    assert "write a share such as `10%`" in capsys.readouterr().err


def test_a_study_with_a_mistake_is_refused_before_anything_is_written(
    study: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (study / "bad.nid").write_text(SMALL.replace("three_areas", "three_area"), encoding="utf-8")
    assert run(["experiment", "bad.nid"]) == 1
    assert "bad.nid:3:15: error[E001]: no file `three_area`" in capsys.readouterr().err
    assert run(["experiment", "fig8"]) == 1
    assert "did you mean `fig8b` or `fig8a`" in capsys.readouterr().err
    assert not (study / "experiments").exists()


def test_a_folder_of_lines_that_are_none_is_refused(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (study / "out").mkdir()
    (study / "out" / LINES).write_text("{}\n", encoding="utf-8")
    assert run(["experiment", "small.nid", "--output", "out", "--resume"]) == 1
    assert f"out/{LINES}:1:1: error[E702]" in capsys.readouterr().err


def test_jobs_and_a_scheduler_are_not_for_one_study(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["experiment", "small.nid", "--jobs", "2", "--scheduler", "tcp://localhost:1"]) == 2
    assert "ask for one" in capsys.readouterr().err


def test_where_no_scheduler_answers_it_is_told(
    study: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from cleancli.experiment import cluster

    monkeypatch.setattr(cluster, "PATIENCE", 1.0)
    assert run(["experiment", "small.nid", "--scheduler", "tcp://127.0.0.1:9"]) == 5
    assert "no scheduler answers at tcp://127.0.0.1:9" in capsys.readouterr().err


def test_two_at_once_do_not_work_in_one_folder(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from cleancli.api.run_session import alone_in

    (study / "out").mkdir()
    with alone_in(study / "out"):
        assert run(["experiment", "small.nid", "--output", "out", "--jobs", "1"]) == 2
    assert "another process works on out" in capsys.readouterr().err


def test_interrupted_it_says_how_to_go_on(study: Path) -> None:
    (study / "long.nid").write_text(SMALL.replace("runs = 1", "runs = 1000"), encoding="utf-8")
    command = [sys.executable, "-m", "cleancli", "experiment", "long.nid", "--jobs", "1", "--output", "out"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    lines = study / "out" / LINES
    while not lines.exists() or lines.read_bytes().count(b"\n") < 2:
        assert process.poll() is None
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    finished = lines.read_bytes().count(b"\n")
    assert f"interrupted: {finished} episodes finished; go on with the same and --resume" in errors
