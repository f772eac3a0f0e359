"""Files that are held while they are replaced: locked against other processes of this program, and leased.

A lease is the kernel's word that nobody has a file open for writing, and that whoever wants to waits, which
can be asked. A lock binds only who asks for it, as this program does.
"""

from __future__ import annotations

import errno
import os
import signal
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from cleancli.files.plain import naming, open_plain

try:
    import fcntl
except ImportError:  # not on Windows: neither locks nor leases there
    fcntl = None  # type: ignore[assignment]

PATIENCE = 5.0
"""Seconds to wait for another process that writes a file."""

_MOST = 64 << 20
"""Bytes that are compared: far more than any text that is edited here."""


class Meanwhile(Exception):
    """Another program has changed, replaced or made a file that was to be written; `what` it did."""

    def __init__(self, path: Path, what: str) -> None:
        super().__init__(f"{path} {what}")
        self.path, self.what = path, what


@dataclass(frozen=True, slots=True)
class Original:
    """A file that is to be replaced: open and locked, with its content as it was read, and its status."""

    file: BinaryIO
    content: bytes
    status: os.stat_result


@contextmanager
def locked(paths: Iterable[Path]) -> Iterator[dict[Path, Original | None]]:
    """The files at some paths that lead through no link, read and locked against other processes of this
    program; None for those that do not exist. Raises OSError, also for what another process holds for
    long."""
    with ExitStack() as opened:
        # In one order everywhere: two processes never wait for each other.
        yield {path: _held(path, opened) for path in sorted(set(paths))}


def _held(path: Path, opened: ExitStack) -> Original | None:
    end = time.monotonic() + PATIENCE
    while True:
        try:
            file = open_plain(path)
        except FileNotFoundError:
            return None
        while lock(file.fileno()) is False:
            if time.monotonic() > end:
                file.close()
                raise OSError(errno.EAGAIN, "another process is writing it", str(path))
            time.sleep(0.01)
        if is_at(path, os.fstat(file.fileno())):
            opened.enter_context(file)
            return Original(file, content_of(file, path), os.fstat(file.fileno()))
        file.close()  # replaced while it was waited for


def lock(handle: int) -> bool | None:
    """Whether an open file is locked now, which waits for nobody: False where another process has locked it,
    None where there are no locks, as on some network disks."""
    if fcntl is None:
        return None
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return False if error.errno in (errno.EWOULDBLOCK, errno.EACCES) else None
    return True


def content_of(file: BinaryIO, path: Path) -> bytes:
    """What an open file holds now, as far as it is compared; `path` is for errors."""
    with naming(path):
        file.seek(0)
        return file.read(_MOST)


def is_at(path: Path, status: os.stat_result) -> bool:
    """Whether a path leads to the file of this status, and not to another one."""
    try:
        return os.path.samestat(os.stat(path, follow_symlinks=False), status)
    except FileNotFoundError:
        return False


def leased(handle: int, path: Path) -> bool:
    """Whether there is a lease on a file now: who opens it for writing has to wait, which can be asked.

    Raises Meanwhile where another program has the file open for writing and keeps it so.
    """
    if not hasattr(fcntl, "F_SETLEASE"):
        return False
    end = time.monotonic() + PATIENCE
    while True:
        try:
            # The signal that tells of who waits is one that does nothing; the usual one ends the process.
            fcntl.fcntl(handle, fcntl.F_SETSIG, signal.SIGURG)
            fcntl.fcntl(handle, fcntl.F_SETLEASE, fcntl.F_RDLCK)
        except OSError as error:
            if error.errno != errno.EAGAIN:
                return False
        else:
            return True
        if time.monotonic() > end:
            raise Meanwhile(path, "is being written by another program")
        time.sleep(0.01)


def is_still_leased(handle: int) -> bool:
    """Whether nobody waits to write into a file that is leased."""
    return fcntl.fcntl(handle, fcntl.F_GETLEASE) == fcntl.F_RDLCK
