"""The folder of a run that begins. It gets its name when all is in it that the run needs to go on, so that a
process which is killed before leaves none that looks like a run; what it leaves, the next run removes.
"""

from __future__ import annotations

import errno
import itertools
import os
import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from cleancli.files.exchange import sync_folder, took_free_name
from cleancli.files.lease import is_at, lock
from cleancli.recording.folder import FILES, RUN

ROOM = 64 << 20
"""Bytes that a long run takes: 60 actions with a picture of two thirds of a megabyte each, and a video."""

_BEGUN = re.compile(r"\.cleancli-[0-9a-f]{16}\.run")
_HELD = re.compile(rf"{re.escape(RUN)}|{re.escape(FILES)}|\.cleancli-[0-9a-f-]+\.part")
"""What a folder may hold that has no name yet."""


@contextmanager
def begun_folder(parent: Path) -> Iterator[Path]:
    """A new folder in `parent`, locked against other processes as long as this lasts, also under the name
    that `named` gives it; removed at the end if that has not been.

    Raises OSError where it cannot be made, or has less room than a long run takes.
    """
    parent.mkdir(parents=True, exist_ok=True)
    free = shutil.disk_usage(parent).free
    if free < ROOM:
        told = f"a run needs up to {ROOM >> 20} MB here, and {free >> 20} MB are free"
        raise OSError(errno.ENOSPC, told, str(parent))
    _remove_leftovers(parent)
    folder, handle = _made(parent)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if handle is not None:
            os.close(handle)


def named(begun: Path, stem: str) -> Path:
    """The folder under a name after `stem`, numbered so that nothing is overwritten."""
    numbered = (begun.parent / f"{stem}-{number:03d}" for number in itertools.count(1))
    folder = next(folder for folder in numbered if took_free_name(begun, folder))
    sync_folder(begun.parent)
    return folder


def _made(parent: Path) -> tuple[Path, int | None]:
    """A new folder and, where folders can be locked, the open file that locks it."""
    while True:
        folder = parent / f".cleancli-{secrets.token_hex(8)}.run"
        folder.mkdir()
        if os.name != "posix":
            return folder, None
        # Another process may have taken it for a leftover before it was locked.
        with suppress(FileNotFoundError):
            handle = _opened(folder)
            if lock(handle) is not False and is_at(folder, os.fstat(handle)):
                return folder, handle
            os.close(handle)


def _remove_leftovers(parent: Path) -> None:
    for entry in os.listdir(parent) if os.name == "posix" else ():
        if _BEGUN.fullmatch(entry):
            with suppress(OSError):
                _remove_leftover(parent / entry)


def _remove_leftover(folder: Path) -> None:
    handle = _opened(folder)
    try:
        if lock(handle) and all(map(_HELD.fullmatch, os.listdir(handle))):
            shutil.rmtree(folder)
    finally:
        os.close(handle)


def _opened(folder: Path) -> int:
    return os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
