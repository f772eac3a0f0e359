"""New contents for files that other programs may be writing at the same moment.

A new content is written beside its file, and then the two change places in one step (renameat2 of Linux).
What came out is looked at afterwards: if it is not what was meant to be replaced, it is put back, and the new
content is thrown away. So whoever replaces the file meanwhile keeps what he wrote. Who writes into the file
itself is kept out by a lease, for as long as the two change places: the kernel grants it only where nobody
has the file open for writing, and tells when somebody wants to.

Where a system or its disk has no such exchange, the file is looked at right before it is replaced; where
there is no lease (files of another user, some network disks), its content is looked at once more right after.
Then a save can be lost that falls into the microseconds between.
"""

from __future__ import annotations

import ctypes
import errno
import os
import re
import secrets
import stat
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from cleancli.files.interrupt import undisturbed
from cleancli.files.lease import Meanwhile, Original, content_of, is_at, is_still_leased, leased, lock
from cleancli.files.plain import naming, open_plain

SETTLED = 2e-3
"""Seconds to watch a file that was replaced for programs that had it half open."""

_NO_REPLACE, _EXCHANGE = 1, 2
_CANNOT = {errno.ENOSYS, errno.EINVAL, errno.ENOTSUP, errno.EPERM}
_LEFTOVER = re.compile(r"\.cleancli-(?:[0-9a-f]{16}|([0-9a-f]+)-([0-9a-f]+))\.part")


@dataclass(frozen=True, slots=True)
class New:
    """What a file shall hold; `original` is what it replaces, None for a file that is to be made."""

    path: Path
    content: bytes
    original: Original | None


def put_in_place(files: Sequence[New]) -> None:
    """Write all of some files or none. Raises Meanwhile, and OSError with the name of the file.

    Only where the power fails, or the process is killed (SIGKILL), between one replacement and the next, some
    are written and others not; each holds its old content or its new one.
    """
    folders = tuple(dict.fromkeys(new.path.parent for new in files))
    for folder in folders:
        remove_leftovers(folder)
    beside: list[Beside] = []
    with undisturbed():
        try:
            for new in files:
                with _about(new.path):
                    beside.append(Beside(new.path, new.original))
                    beside[-1].write(new.content)
            _put_all(beside)
        finally:
            for each in beside:
                each.discard()
    for folder in folders:
        sync_folder(folder)


def overwrite(path: Path, content: bytes, mode: int | None) -> None:
    """Write a file whatever it held before; without a `mode` that stays. Raises OSError with its name."""
    remove_leftovers(path.parent)
    with undisturbed(), _about(path):
        beside = Beside(path, None)
        try:
            beside.write(content)
            beside.replace(mode)
        finally:
            beside.discard()
        sync_folder(path.parent)


@contextmanager
def written_by_another(path: Path) -> Iterator[Path]:
    """As `overwrite`, for what a library writes, which wants a path: that of an empty file, which takes the
    place of the one at `path` once it is filled."""
    remove_leftovers(path.parent)
    with _about(path):
        beside = Beside(path, None)
        try:
            yield beside.name
            with undisturbed():
                beside.sync()
                beside.replace(None)
        finally:
            beside.discard()
        sync_folder(path.parent)


def _put_all(beside: Sequence[Beside]) -> None:
    try:
        for each in beside:
            with _about(each.path):
                each.put()
        if any(each.is_leased for each in beside):
            time.sleep(SETTLED)
        for each in beside:
            each.confirm()
    except BaseException:
        for each in reversed(beside):
            each.take_back()
        raise


@contextmanager
def _about(path: Path) -> Iterator[None]:
    """Let errors name the file that was to be written, and not the one beside it."""
    try:
        yield
    except OSError as error:
        reason = str(error.strerror)
        beside = error.filename not in (None, str(path))
        if beside and error.errno in (errno.EACCES, errno.EROFS, errno.ENOENT):
            reason += f", in `{path.parent}`, where the new file is written first"
        raise type(error)(error.errno, reason, str(path)) from error


class Beside:
    """A new file beside the one that it is to replace, under a name that no other program uses."""

    def __init__(self, path: Path, original: Original | None) -> None:
        self.path, self._original = path, original
        self.is_leased = self._is_in = self._is_exchanged = False
        self._handle, self._name = _created(path.parent, 0o666 if original is None else 0o600)
        self._status = os.fstat(self._handle)

    @property
    def name(self) -> Path:
        """Where it is until it takes the place of the other."""
        return self._name

    def sync(self) -> None:
        """Have what others have written into it on the disk."""
        os.fsync(self._handle)

    def write(self, content: bytes) -> None:
        """Fill it, onto the disk, and make its owner, group and mode those of the file it replaces."""
        with naming(self.path), os.fdopen(os.dup(self._handle), "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if self._original is not None:
            _become_like(self._original, self._handle)
            # Both files are told by their numbers from what another program may put here.
            telling = f".cleancli-{self._status.st_ino:x}-{self._original.status.st_ino:x}.part"
            os.rename(self._name, self.path.parent / telling)
            self._name = self.path.parent / telling

    def put(self) -> None:
        """Change places with the file. Raises Meanwhile where that is not what it was, OSError."""
        if self._original is None:
            _make(self._name, self.path)
            self._is_in = True
            return
        self.is_leased = leased(self._original.file.fileno(), self.path)
        self._check(self.path)
        if self._exchange():
            self._is_in = self._is_exchanged = True
            self._check(self._name)
        else:
            self._name.replace(self.path)
            self._is_in = True

    def confirm(self) -> None:
        """Raise Meanwhile where somebody has begun to write into the file that came out."""
        if self._is_exchanged:
            self._check(self._name)

    def take_back(self) -> None:
        """Put what came out back in, if the new file is in; whatever is newer than it stays."""
        if self._is_exchanged:
            expected = self._status
            # Where another has replaced the new file, its successor comes out: that is put back in again.
            while (came := self._returned()) is not None and not os.path.samestat(came[1], expected):
                expected = came[0]
            self._is_exchanged = False
            self._name.unlink(missing_ok=True)
        elif self._is_in and self._original is None and is_at(self.path, self._status):
            self.path.unlink()
        self._is_in = False

    def _returned(self) -> tuple[os.stat_result, os.stat_result] | None:
        """What went in and what came out; None where there is no file any more to change places with."""
        went = os.stat(self._name, follow_symlinks=False)
        try:
            self._exchange()
        except Meanwhile:
            return None
        return went, os.stat(self._name, follow_symlinks=False)

    def replace(self, mode: int | None) -> None:
        """Take the place of whatever plain file is there, with its mode and, where that is possible,
        owner."""
        with suppress(FileNotFoundError):
            old = os.stat(self.path)
            if not stat.S_ISREG(old.st_mode):
                raise OSError(errno.EINVAL, "it is no plain file, and was not replaced", str(self.path))
            with suppress(OSError):
                os.fchown(self._handle, old.st_uid, old.st_gid)
            os.fchmod(self._handle, stat.S_IMODE(old.st_mode))
        if mode is not None:
            os.fchmod(self._handle, mode)
        self._name.replace(self.path)

    def discard(self) -> None:
        """Remove what is beside the file now: the old file, or the new one."""
        known = [self._status] if self._original is None else [self._status, self._original.status]
        if any(is_at(self._name, status) for status in known):
            self._name.unlink(missing_ok=True)
        if self._handle >= 0:
            os.close(self._handle)
            self._handle = -1

    def _check(self, path: Path) -> None:
        """Raise Meanwhile where the original is not at `path`, does not read as it did, or is about to be
        written."""
        assert self._original is not None
        handle = self._original.file.fileno()
        if not is_at(path, self._original.status):
            raise Meanwhile(self.path, "has changed on disk since it was read")
        if content_of(self._original.file, self.path) != self._original.content:
            raise Meanwhile(self.path, "has changed on disk since it was read")
        if self.is_leased and not is_still_leased(handle):
            raise Meanwhile(self.path, "is being written by another program")

    def _exchange(self) -> bool:
        """Whether the two could change places. Raises Meanwhile where the file is gone."""
        try:
            return _renamed(self._name, self.path, _EXCHANGE)
        except FileNotFoundError:
            raise Meanwhile(self.path, "has been removed since it was read") from None


def _created(folder: Path, mode: int) -> tuple[int, Path]:
    """A new file in a folder, open and locked, and its path."""
    while True:
        path = folder / f".cleancli-{secrets.token_hex(8)}.part"
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, mode)
        # Another process may have taken it for a leftover before it was locked.
        if lock(handle) is not False and is_at(path, os.fstat(handle)):
            return handle, path
        os.close(handle)


def _become_like(original: Original, handle: int) -> None:
    """Owner, group, mode and what else is known about a file. Raises PermissionError where a file of another
    user could not be given back."""
    old, new = original.status, os.fstat(handle)
    if (old.st_uid, old.st_gid) != (new.st_uid, new.st_gid):
        try:
            os.fchown(handle, old.st_uid, old.st_gid)
        except PermissionError:
            told = "its owner and group would not stay, and so nothing was written"
            raise PermissionError(errno.EPERM, told) from None
    os.fchmod(handle, stat.S_IMODE(old.st_mode))
    if hasattr(os, "listxattr"):
        with suppress(OSError):
            for name in os.listxattr(original.file.fileno()):
                with suppress(OSError):
                    os.setxattr(handle, name, os.getxattr(original.file.fileno(), name))


def _make(name: Path, path: Path) -> None:
    """Give a file another name, which must be free. Raises Meanwhile."""
    try:
        if not _renamed(name, path, _NO_REPLACE):
            os.link(name, path)
            name.unlink()
    except FileExistsError:
        raise Meanwhile(path, "already exists") from None


def _renamed(name: Path, other: Path, how: int) -> bool:
    """Whether the system could do this; raises OSError where it tried and failed."""
    if _renameat2 is None:
        return False
    here = -100  # AT_FDCWD: paths that do not begin at the root begin at the working directory
    if _renameat2(here, os.fsencode(name), here, os.fsencode(other), how) == 0:
        return True
    number = ctypes.get_errno()
    if number in _CANNOT:
        return False
    raise OSError(number, os.strerror(number), str(name), None, str(other))


def took_free_name(name: Path, path: Path) -> bool:
    """Whether a folder got another name, which nothing had. Raises OSError."""
    try:
        if _renamed(name, path, _NO_REPLACE):
            return True
        path.mkdir()
    except FileExistsError:
        return False
    name.rename(path)  # in the place of an empty folder
    return True


_renameat2 = (
    getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None) if sys.platform == "linux" else None
)


def remove_leftovers(folder: Path) -> None:
    """Remove files that processes of this program left beside others when they were killed, and nothing else:
    neither what a living one uses nor what another program has put there."""
    with suppress(OSError):
        for entry in os.listdir(folder):
            found = _LEFTOVER.fullmatch(entry)
            if found is not None:
                with suppress(OSError):
                    _remove_leftover(folder / entry, found.groups())


def _remove_leftover(path: Path, numbers: tuple[str | None, ...]) -> None:
    with open_plain(path, follow=False) as file:
        status = os.fstat(file.fileno())
        is_ours = numbers[0] is None or f"{status.st_ino:x}" in numbers
        if is_ours and lock(file.fileno()) and is_at(path, status):
            path.unlink()


def sync_folder(folder: Path) -> None:
    """Make the names in a folder themselves durable where the system lets a folder be opened."""
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
