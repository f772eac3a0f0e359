"""The folder of a run that begins: none looks like a run that cannot go on, whoever is killed when."""

from __future__ import annotations

import itertools
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import pytest

from cleancli.cli.main import run
from cleancli.files import exchange as swap
from cleancli.recording import begun
from cleancli.recording.begun import begun_folder, named
from cleancli.recording.folder import FILES, RUN
from cleancli.recording.run_folder import write_run

TRACED = {begun.__file__, swap.__file__, __file__}


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "fsync", lambda _: None)


def begin(runs: Path) -> Path:
    with begun_folder(runs) as folder:
        (folder / FILES).mkdir()
        (folder / FILES / "a.nid").write_text("text", encoding="utf-8")
        write_run(folder, {"format": 1})
        return named(folder, "run")


def begin_and_die(runs: Path, number: int) -> None:
    """Die at the line of this number; of those of the code that begins a run, and of `begin`."""
    lines = itertools.count()

    def trace(frame: FrameType, event: str, _: object) -> object:
        if frame.f_code.co_filename not in TRACED:
            return None
        if event == "line" and next(lines) == number:
            os._exit(9)
        return trace

    sys.settrace(trace)  # type: ignore[arg-type]
    begin(runs)
    os._exit(0)


def hidden(runs: Path) -> list[str]:
    return [name for name in os.listdir(runs) if name.startswith(".")] if runs.exists() else []


@pytest.mark.parametrize("exchange", [True, False], ids=["exchange", "no exchange"])
def test_who_is_killed_leaves_a_whole_folder_or_what_the_next_run_removes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, exchange: bool
) -> None:
    if not exchange:
        monkeypatch.setattr(swap, "_renameat2", None)
    left = empty = 0
    for number in itertools.count():
        runs = tmp_path / f"runs{number}"
        child = os.fork()
        if child == 0:
            begin_and_die(runs, number)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        for folder in runs.glob("run-*"):
            empty += not os.listdir(folder)
            if os.listdir(folder):
                assert json.loads((folder / RUN).read_text(encoding="utf-8")) == {"format": 1}
                assert (folder / FILES / "a.nid").exists()
        left += bool(hidden(runs))
        assert begin(runs).exists()
        assert hidden(runs) == [], f"at line {number}"
        if code == 0:
            break
    assert number > 60
    assert left > 20
    # Without the system's help the name is taken in two steps.
    assert empty <= (0 if exchange else 2)


def test_folders_of_living_runs_and_of_others_stay(tmp_path: Path) -> None:
    others = [".hidden", ".cleancli-0123456789abcdef", ".cleancli-0123456789abcdef.runs"]
    for name in others:
        (tmp_path / name).mkdir()
    mine = tmp_path / ".cleancli-0123456789abcdee.run"
    mine.mkdir()
    (mine / "notes.txt").write_text("mine", encoding="utf-8")
    (tmp_path / ".cleancli-0123456789abcded.run").symlink_to(mine)
    (tmp_path / ".cleancli-0123456789abcdec.run").mkdir()
    with begun_folder(tmp_path) as living:
        folders = [begin(tmp_path) for _ in range(2)]
        assert living.exists()
    assert [folder.name for folder in folders] == ["run-001", "run-002"]
    assert not living.exists()
    kept = [*others, mine.name, ".cleancli-0123456789abcded.run"]
    assert sorted(hidden(tmp_path)) == sorted(kept)


def test_a_run_that_could_not_begin_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: object) -> Iterator[None]:
        raise OSError(28, "No space left on device", "somewhere")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cleancli.api.runs.write_run", full)
    assert run(["execute", "cleaning", "three_areas", "--quiet"]) == 5
    assert "No space left" in capsys.readouterr().err
    assert os.listdir(tmp_path / "runs") == []
