"""A Rerun recording is written as all files of users are: whole or not at all, and nothing is left beside it.

Rerun itself is no part of the test extra: what writes the file here is a stand-in with its calls.
"""

from __future__ import annotations

import stat
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from cleancli.perception.rerun_file import write_recording

LEFTOVER = ".cleancli-0123456789abcdef.part"


class Stream:
    def __init__(self, *_: Any, **__: Any) -> None:
        self._path = Path()

    def save(self, path: Path) -> None:
        self._path = Path(path)
        self._path.write_bytes(b"begun")

    def disconnect(self) -> None:
        self._path.write_bytes(b"whole")


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setitem(sys.modules, "rerun", SimpleNamespace(RecordingStream=Stream))
    return tmp_path / "seen.rrd"


def test_a_new_recording_lies_alone(path: Path) -> None:
    (path.parent / LEFTOVER).write_bytes(b"of a process that was killed")
    write_recording(path, (), "x")
    assert path.read_bytes() == b"whole"
    assert list(path.parent.iterdir()) == [path]


def test_link_and_mode_of_an_old_one_stay(path: Path) -> None:
    real = path.with_name("real.rrd")
    real.write_bytes(b"old")
    real.chmod(0o640)
    path.symlink_to(real)
    write_recording(path, (), "x")
    assert path.is_symlink()
    assert real.read_bytes() == b"whole"
    assert stat.S_IMODE(real.stat().st_mode) == 0o640
    assert sorted(path.parent.iterdir()) == [real, path]


def test_what_is_cut_short_changes_nothing(path: Path) -> None:
    def looks() -> Iterator[Any]:
        raise KeyboardInterrupt
        yield

    path.write_bytes(b"old")
    with pytest.raises(KeyboardInterrupt):
        write_recording(path, looks(), "x")
    assert path.read_bytes() == b"old"
    assert list(path.parent.iterdir()) == [path]
