"""Only plain files are opened, and of those no more is read than was asked for."""

from __future__ import annotations

import os
import socket
import tracemalloc
from pathlib import Path

import pytest

from cleancli.files.plain import NotPlain, TooLarge, naming, open_plain, read_plain


def test_a_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"12345")
    assert read_plain(path, 5) == b"12345"
    assert read_plain(str(path), 6) == b"12345"
    with pytest.raises(TooLarge) as refused:
        read_plain(path, 4)
    assert (refused.value.filename, refused.value.strerror) == (str(path), "it is larger than 4 bytes")
    with open_plain(path) as file:
        assert file.readline() == b"12345"


def test_a_size_is_known_before_memory_is_used(tmp_path: Path) -> None:
    path = tmp_path / "a"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    tracemalloc.start()
    with pytest.raises(TooLarge, match="larger than 64 MiB"):
        read_plain(path, 64 << 20)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 1 << 20


def test_a_size_that_is_said_to_be_nothing_is_not_believed() -> None:
    """Files of /proc have no size until they are read."""
    path = "/proc/self/maps"
    if not os.path.exists(path):
        pytest.skip("no /proc here")
    assert os.stat(path).st_size == 0
    assert len(read_plain(path, 1 << 24)) > 10
    with pytest.raises(TooLarge):
        read_plain(path, 10)


def test_what_is_no_plain_file_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("pipe")
    with socket.socket(socket.AF_UNIX) as served:
        served.bind(str(tmp_path / "socket"))
    kinds = {"pipe": "named pipe", "link": "named pipe", "socket": "socket", "/dev/zero": "device"}
    for name, kind in kinds.items():
        with pytest.raises(NotPlain) as refused:
            open_plain(tmp_path / name)
        assert kind in str(refused.value.strerror)
        assert refused.value.filename == str(tmp_path / name)
    with pytest.raises(IsADirectoryError):
        read_plain(tmp_path, 10)
    with pytest.raises(FileNotFoundError):
        read_plain(tmp_path / "none", 10)
    with pytest.raises(ValueError, match="null"):
        read_plain("a\0b", 10)


def test_links_are_followed_where_that_is_allowed(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"text")
    (tmp_path / "link").symlink_to("file")
    assert read_plain(tmp_path / "link", 10) == b"text"
    assert read_plain(tmp_path / "file", 10, follow=False) == b"text"
    with pytest.raises(NotPlain, match="link"):
        read_plain(tmp_path / "link", 10, follow=False)


def test_a_file_that_becomes_a_pipe_meanwhile_is_refused_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a"
    path.write_text("")
    looked = os.stat

    def swapped(*arguments: object, **options: object) -> os.stat_result:
        result = looked(*arguments, **options)  # type: ignore[arg-type]
        path.unlink()
        os.mkfifo(path)
        return result

    monkeypatch.setattr(os, "stat", swapped)
    with pytest.raises(NotPlain, match="named pipe"):
        open_plain(path)


def _filled(path: Path) -> None:
    with naming(path), open("/dev/full", "w") as full:
        full.write("text")
        full.flush()


def test_an_error_of_the_disk_has_the_name_of_its_file(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No space") as raised:
        _filled(tmp_path / "a")
    assert raised.value.filename == str(tmp_path / "a")
    with pytest.raises(FileNotFoundError) as missing, naming("other"):
        os.stat(tmp_path / "none")
    assert str(missing.value.filename) == str(tmp_path / "none")
